// Golden texts: files of input lines, each followed by the lines that the code under test returns
// for it, which begin with a space. A file is both input and expectation, as a transcript is.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
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

// Expects that the file from `at` on equals its input lines, each followed by `respond(line)`. If
// not, the actual text is written to a file that the failure names: check it, and copy it over the
// expected one. Empty lines and those that begin with # are no input.
template <class Respond>
void expect_responses(const std::string& file, const std::string& text, std::size_t at,
                      Respond respond) {
  std::string actual = text.substr(0, at);
  std::istringstream lines(text.substr(at));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(' ')) continue;
    actual += line + '\n';
    if (!line.empty() && !line.starts_with('#')) actual += respond(line);
  }
  if (actual == text) return;
  const std::filesystem::path path(file);  // files of two folders may have one name
  const std::string copy =
      testing::TempDir() + path.parent_path().filename().string() + '-' + path.filename().string();
  std::ofstream(copy) << actual;
  EXPECT_EQ(actual, text) << "to accept it: cp " << copy << ' ' << file;
}

inline std::string golden_text(const std::string& file) {
  std::ifstream in(file);
  EXPECT_TRUE(in) << file;
  std::ostringstream whole;
  whole << in.rdbuf();
  return whole.str();
}

// The same for a file that begins with a configuration and a line of three hyphens: a `Bus` of this
// configuration responds.
template <class Bus>
void expect_bus_responses(const std::string& file) {
  const std::string text = golden_text(file), rule = "---\n";
  const auto at = text.find(rule);
  ASSERT_NE(at, std::string::npos) << "no line of three hyphens in " << file;
  Bus bus(text.substr(0, at));
  expect_responses(file, text, at + rule.size(),
                   [&](const std::string& line) { return bus.respond(line); });
}

// The name of a file as that of a parameterized test.
inline std::string golden_test_name(const testing::TestParamInfo<std::string>& file) {
  std::string name = file.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

}  // namespace fieldcast::test
