#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "csv.h"
#include "refusal.h"
#include "text_files.h"

namespace collision_pairs::test_text_files {

namespace fs = std::filesystem;

class TextFiles : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::size_t nbFiles() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), {}));
  }
  fs::path folder_ = fs::temp_directory_path() / ("text_files_" + std::to_string(::getpid()));
};

TEST_F(TextFiles, AByteOrderMarkIsDroppedAtTheBeginningOnly) {
  const std::string mark = "\xEF\xBB\xBF";
  const std::vector<std::pair<std::string, std::string>> cases = {{mark + "pan", "pan"},
                                                                  {mark, ""},
                                                                  {mark + mark, mark},
                                                                  {"pan" + mark, "pan" + mark},
                                                                  {"\xEF\xBB", "\xEF\xBB"},
                                                                  {"\xEF\xBBpan", "\xEF\xBBpan"},
                                                                  {"", ""}};
  for (const auto& [bytes, text] : cases) {
    std::ofstream(path("bom")) << bytes;
    EXPECT_EQ(readTextFile(path("bom")), text);
    EXPECT_EQ(readBinaryFile(path("bom")), bytes);
  }
}

TEST_F(TextFiles, LongTextsAreReadWhole) {
  std::string text;
  for (int i = 0; i < 40000; ++i) text += std::to_string(i) + '\n';
  std::ofstream(path("long")) << text;
  EXPECT_EQ(readTextFile(path("long")), text);
}

TEST_F(TextFiles, ABinaryFileIsReadWholeWithItsZeroBytes) {
  const std::string bytes = std::string(100000, 'x') + '\0' + "rest";
  std::ofstream(path("binary")) << bytes;
  EXPECT_EQ(readBinaryFile(path("binary")), bytes);
}

TEST_F(TextFiles, WhoseReadingFailsAreNotTakenForTheirBeginning) {
  const std::string never = "/proc/self/mem";  // opens; the first byte cannot be read
  const std::string why = never + ": cannot be read to its end: ";
  EXPECT_EQ(refusal([&] { readTextFile(never); }).substr(0, why.size()), why);
  EXPECT_EQ(refusal([&] { readBinaryFile(never); }).substr(0, why.size()), why);
}

TEST_F(TextFiles, WhatCannotBeReadIsRefusedByNameThoughItNeverEnds) {
  std::ofstream(path("binary")) << std::string(100000, 'x') << '\0' << "rest";
  const auto text = [&](const std::string& of) { return refusal([&] { readTextFile(of); }); };
  const auto binary = [&](const std::string& of) { return refusal([&] { readBinaryFile(of); }); };
  for (const std::string& missing : {path("none"), path("none/none"), std::string()}) {
    EXPECT_EQ(text(missing), missing + ": cannot be opened: No such file or directory");
    EXPECT_EQ(binary(missing), text(missing));
  }
  EXPECT_EQ(text(folder_), folder_.string() + ": is a directory, not a file");
  EXPECT_EQ(binary(folder_), text(folder_));
  for (const std::string& zeros : {path("binary"), std::string("/dev/zero")}) {
    EXPECT_EQ(text(zeros), zeros + ": contains a zero byte, so it is not text");
  }
  EXPECT_EQ(text("/dev/null"), "accepted");
  EXPECT_EQ(binary("/dev/zero"), "/dev/zero: is not a regular file");
}

TEST_F(TextFiles, FailureLeavesTheOldFileAndNoOther) {
  std::ofstream(path("out")) << "old";
  EXPECT_THROW(writeTextFile(path("out"),
                             [](std::ostream& out) {
                               out << "half";
                               throw InputError("stop");
                             }),
               InputError);
  EXPECT_EQ(readTextFile(path("out")), "old");
  EXPECT_EQ(nbFiles(), 1u);
  writeTextFile(path("out"), [](std::ostream& out) { out << "new"; });
  EXPECT_EQ(readTextFile(path("out")), "new");
  EXPECT_EQ(nbFiles(), 1u);
}

TEST_F(TextFiles, WhatCannotBeWrittenIsRefusedByName) {
  const auto writing = [&](const std::string& to) {
    return refusal([&] { writeTextFile(to, [](std::ostream& out) { out << "text"; }); });
  };
  EXPECT_EQ(writing(path("no/out")),
            path("no/out") + ": cannot be written: No such file or directory");
  EXPECT_EQ(writing(folder_), folder_.string() + ": cannot be written: Is a directory");
  fs::create_symlink("/dev/full", path("full"));
  EXPECT_EQ(writing(path("full")), path("full") + ": writing failed (disk full?)");
  EXPECT_TRUE(fs::is_symlink(path("full"))) << "a device is neither replaced nor removed";
  EXPECT_EQ(nbFiles(), 1u);
}

TEST_F(TextFiles, ADeviceIsWrittenInPlace) {
  fs::create_symlink("/dev/null", path("device"));
  writeTextFile(path("device"), [](std::ostream& out) { out << "text"; });
  EXPECT_TRUE(fs::is_symlink(path("device")));
  EXPECT_EQ(nbFiles(), 1u);
}

TEST_F(TextFiles, ALinkStaysAndWhatItLeadsToIsWritten) {
  std::ofstream(path("old")) << "old";
  fs::create_symlink("old", path("link"));
  fs::create_symlink("none", path("nowhere"));
  for (const char* link : {"link", "nowhere"}) {
    writeTextFile(path(link), [](std::ostream& out) { out << "new"; });
    EXPECT_TRUE(fs::is_symlink(path(link))) << link;
    EXPECT_EQ(readTextFile(path(link)), "new");
  }
  EXPECT_EQ(readTextFile(path("old")), "new");
  EXPECT_EQ(nbFiles(), 4u);
}

TEST_F(TextFiles, NoNameAndADashAreStandardOutput) {
  for (const char* name : {"", "-"}) {
    testing::internal::CaptureStdout();
    writeTextFile(name, [](std::ostream& out) { out << "text"; });
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "text");
  }
  EXPECT_FALSE(fs::exists("-"));
}

std::vector<std::string> fieldsOf(const std::string& line) {
  CsvRecord record;
  EXPECT_TRUE(record.addLine(line)) << line;
  return record.fields();
}

/// At the beginning, in the middle and at the end of a text.
TEST(Csv, AFieldIsQuotedWhereAnyByteNeedsItAndIsReadAsItWas) {
  for (int number = 1; number < 256; ++number) {
    const std::string byte(1, static_cast<char>(number));
    const bool anywhere = std::string(",\"\r\n").find(byte) != std::string::npos;
    const bool at_ends = std::string(" \t\r").find(byte) != std::string::npos;
    const std::string inside = byte == "\"" ? "\"\"" : byte;
    const std::pair<std::string, bool> cases[] = {{byte + "ab", anywhere || at_ends || byte == "#"},
                                                  {"a" + byte + "b", anywhere},
                                                  {"ab" + byte, anywhere || at_ends}};
    for (const auto& [text, is_quoted] : cases) {
      std::string quoted = text;
      quoted.replace(quoted.find(byte), 1, inside);
      EXPECT_EQ(csvField(text), is_quoted ? '"' + quoted + '"' : text) << number;
      if (byte == "\n") continue;  // a record of two lines
      EXPECT_EQ(fieldsOf(csvField(text) + ',' + csvField(text)),
                (std::vector<std::string>{text, text}));
    }
    const bool is_encoded =
        number < 32 || number == 127 || std::string("%|;=").find(byte) != std::string::npos;
    char encoded[4];
    std::snprintf(encoded, sizeof encoded, "%%%02X", static_cast<unsigned>(number));
    EXPECT_EQ(listedName("a" + byte + "b"), "a" + (is_encoded ? encoded : byte) + "b") << number;
  }
  EXPECT_EQ(csvField(""), "");
  EXPECT_EQ(listedName(""), "");
}

TEST(Csv, BlanksAroundAFieldAreDroppedUnlessTheyAreQuoted) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {"", {""}},
      {" \t", {""}},
      {"a,,b", {"a", "", "b"}},
      {",", {"", ""}},
      {" a b\t,\t c\r", {"a b", "c"}},
      {"\" a \" , \"\" ,\"\"\"\"", {" a ", "", "\""}},
      {"a\"b\"", {"a\"b\""}},
      {"\"a\"b,\"c\" d ", {"a\"b", "c\" d"}},
      {"\"0\"1,2", {"0\"1", "2"}},
      {"\" \" ,b", {" ", "b"}},
      {"\"a,b\",c", {"a,b", "c"}},
      {"\"a\"\"b\"\"\"", {"a\"b\""}},
  };
  for (const auto& [line, fields] : cases) EXPECT_EQ(fieldsOf(line), fields) << line;
}

TEST(Csv, AQuotationGoesOnInTheNextLine) {
  CsvRecord record;
  EXPECT_FALSE(record.addLine("a,\"b "));
  EXPECT_FALSE(record.addLine(""));
  EXPECT_TRUE(record.addLine(" c\" ,d"));
  EXPECT_EQ(record.fields(), (std::vector<std::string>{"a", "b \n\n c", "d"}));
}

}  // namespace collision_pairs::test_text_files
