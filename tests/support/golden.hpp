// Golden texts: files of input lines, each followed by the lines that the code under test returns
// for it, which begin with a space. A file is both input and expectation, as a transcript is.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

namespace fieldcast::test {

// Names of the files in a folder, without ".txt", in order.
inline std::vector<std::string> golden_names(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

// Expects that the file equals its head and, for each input line, the line and `respond(line)`. If
// not, the actual text is written to a file that the failure names: check it, and copy it over the
// expected one. `begin(head)` is called first.
inline void expect_golden(const std::string& file, const std::function<void(std::string)>& begin,
                          const std::function<std::string(std::string)>& respond) {
  std::ifstream in(file);
  ASSERT_TRUE(in) << file;
  std::ostringstream whole;
  whole << in.rdbuf();
  const std::string text = whole.str(), rule = "---\n";
  const auto at = text.find(rule);
  ASSERT_NE(at, std::string::npos) << "no line of three hyphens";
  std::string actual = text.substr(0, at + rule.size());
  begin(text.substr(0, at));
  std::istringstream lines(text.substr(at + rule.size()));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(' ')) continue;
    actual += line + '\n';
    if (!line.empty() && !line.starts_with('#')) actual += respond(line);
  }
  if (actual == text) return;
  const std::string copy = testing::TempDir() + std::filesystem::path(file).filename().string();
  std::ofstream(copy) << actual;
  EXPECT_EQ(actual, text) << "to accept it: cp " << copy << ' ' << file;
}

// The name of a file as that of a parameterized test.
inline std::string golden_test_name(const testing::TestParamInfo<std::string>& file) {
  std::string name = file.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

}  // namespace fieldcast::test
