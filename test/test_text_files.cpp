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
