// Of a program of many test files: runs those of the files that are given, such as test_aabb, or
// all.
#include <iostream>
#include <string>

#include <gtest/gtest.h>

namespace {

std::string stemOf(const std::string& path) {
  const std::string name = path.substr(path.rfind('/') + 1);
  return name.substr(0, name.rfind('.'));
}

/// The pattern of gtest that matches all tests of this file; empty if there are none.
std::string testsOf(const std::string& file) {
  std::string pattern;
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  for (int i = 0; i < all.total_test_suite_count(); ++i) {
    const testing::TestSuite& suite = *all.GetTestSuite(i);
    for (int j = 0; j < suite.total_test_count(); ++j) {
      const testing::TestInfo& test = *suite.GetTestInfo(j);
      if (stemOf(test.file()) != file) continue;
      pattern += std::string(pattern.empty() ? "" : ":") + suite.name() + "." + test.name();
    }
  }
  return pattern;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string file = argc > 1 && argv[1][0] != '-' ? argv[1] : "";
  // Results in a folder are named after the program; of one that runs twice at a time, one would be
  // lost.
  std::string& output = testing::GTEST_FLAG(output);
  if (!file.empty() && !output.empty() && output.back() == '/') output += file + ".xml";
  testing::InitGoogleTest(&argc, argv);
  if (!file.empty() && testing::GTEST_FLAG(filter) == "*") {
    testing::GTEST_FLAG(filter) = testsOf(file);
    if (testing::GTEST_FLAG(filter).empty()) {
      std::cerr << "no test in a file " << file << ".cpp\n";
      return 1;
    }
  }
  return RUN_ALL_TESTS();
}
