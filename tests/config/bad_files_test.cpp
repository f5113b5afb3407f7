// Each file in tests/config/bad has one fault; its head comment lists the expected messages, one
// per line. {protocols} stands for the names of all protocols, so that a new protocol changes no
// file.
#include <gtest/gtest.h>

#include <sstream>

#include "config/document/suggest.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/config/support.hpp"

namespace fieldcast::config {
namespace {

constexpr std::string_view kExpect = "# expect: ";

std::string expected_of(const std::string& text) {
  std::string expected;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(kExpect)) expected += line.substr(kExpect.size()) + '\n';
  }
  std::vector<std::string_view> names;
  for (const auto& entry : protocols()) names.push_back(entry.name);
  static constexpr std::string_view kProtocols = "{protocols}";
  for (auto at = expected.find(kProtocols); at != std::string::npos;
       at = expected.find(kProtocols)) {
    expected.replace(at, kProtocols.size(), joined(names));
  }
  return expected;
}

class BadFile : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(BadFile, IsRefusedWithExactlyTheFaultsAtItsHead) {
  const auto text = slurp(GetParam());
  const auto expected = expected_of(text);
  ASSERT_NE(expected, "") << "the file says nothing that should be said of it";
  const auto loaded =
      load_text(text, GetParam().filename().string(), within(GetParam().parent_path()));
  EXPECT_EQ(faults_of(loaded), expected);
}

INSTANTIATE_TEST_SUITE_P(Config, BadFile,
                         testing::ValuesIn(files_of(source_dir() / "tests/config/bad", ".yaml")),
                         [](const auto& file) {
                           std::string name = file.param.stem().string();
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace fieldcast::config
