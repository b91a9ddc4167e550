#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "collision_pairs/input_error.h"
#include "text_files.h"

namespace collision_pairs {
namespace {

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

TEST_F(TextFiles, ByteOrderMarkIsDropped) {
  std::ofstream(path("bom")) << "\xEF\xBB\xBFpan";
  EXPECT_EQ(readTextFile(path("bom")), "pan");
}

TEST_F(TextFiles, LongTextsAreReadWhole) {
  std::string text;
  for (int i = 0; i < 40000; ++i) text += std::to_string(i) + '\n';
  std::ofstream(path("long")) << text;
  EXPECT_EQ(readTextFile(path("long")), text);
}

TEST_F(TextFiles, WhatIsNoTextIsRefusedThoughItNeverEnds) {
  EXPECT_THROW(readTextFile("/dev/zero"), InputError);
  std::ofstream(path("binary")) << std::string(100000, 'x') << '\0' << "rest";
  EXPECT_THROW(readTextFile(path("binary")), InputError);
}

TEST_F(TextFiles, MissingFileAndFolderAreRefusedByName) {
  EXPECT_THROW(readTextFile(path("none")), InputError);
  EXPECT_THROW(readTextFile(folder_.string()), InputError);
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

TEST_F(TextFiles, FolderThatIsMissingIsRefused) {
  EXPECT_THROW(writeTextFile(path("no/out"), [](std::ostream&) {}), InputError);
}

}  // namespace
}  // namespace collision_pairs
