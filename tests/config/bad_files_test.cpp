// Each case in tests/config/bad has one fault; its comments list the expected messages, one per
// line. {protocols} stands for the names of all protocols, so that a new protocol changes no case.
#include <gtest/gtest.h>

#include "config/document/suggest.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/config/support.hpp"

namespace fieldcast::config {
namespace {

std::string expected_of(const BadCase& bad) {
  auto expected = bad.expected();
  std::vector<std::string_view> names;
  for (const auto& entry : protocols()) names.push_back(entry.name);
  static constexpr std::string_view kProtocols = "{protocols}";
  for (auto at = expected.find(kProtocols); at != std::string::npos;
       at = expected.find(kProtocols)) {
    expected.replace(at, kProtocols.size(), joined(names));
  }
  return expected;
}

// Reads the files of the folder, and the case as the file that it names itself by.
FileReader reader_of(const BadCase& bad) {
  const auto folder = within(source_dir() / "tests/config/bad");
  return {[=](const std::string& path) {
            return path == bad.file() ? tl::expected<std::string, FileError>(bad.text)
                                      : folder.read(path);
          },
          folder.list};
}

class BadFile : public testing::TestWithParam<BadCase> {};

TEST_P(BadFile, IsRefusedWithExactlyTheFaultsAtItsHead) {
  const auto expected = expected_of(GetParam());
  ASSERT_NE(expected, "") << "the case has no expected message";
  const auto loaded = load_text(GetParam().text, GetParam().file(), reader_of(GetParam()));
  EXPECT_EQ(faults_of(loaded), expected);
}

INSTANTIATE_TEST_SUITE_P(Config, BadFile,
                         testing::ValuesIn(bad_cases(source_dir() / "tests/config/bad")),
                         [](const auto& bad) { return bad.param.identifier(); });

}  // namespace
}  // namespace fieldcast::config
