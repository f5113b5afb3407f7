#include <numeric>
#include <set>

#include "tests/tools/cli/scan_support.hpp"

namespace fieldcast::cli {
namespace {

TEST(ScanPlan, ReadsAddresses) {
  EXPECT_THAT(*addresses_from("1-4"), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(*addresses_from("7,1,10-12,11"), ElementsAre(1, 7, 10, 11, 12));
  EXPECT_THAT(*addresses_from("65535"), ElementsAre(65535));
  for (const char* bad : {"", "x", "1-", "-3", "4-2", "1,,2", "1,", "70000", "1 2"})
    EXPECT_FALSE(addresses_from(bad)) << bad;
}

TEST(ScanPlan, FactoryFormatIsFirstAndNoneComesTwice) {
  for (const ProtocolEntry& entry : protocols()) {
    const auto formats = usual_formats({&entry, {}}, {}, {});
    EXPECT_EQ(formats.front(), entry.factory_line) << entry.name;
    std::set<std::string> texts;
    for (const auto& format : formats) EXPECT_TRUE(texts.insert(to_text(format)).second);
  }
  EXPECT_EQ(usual_formats(rtu(), {}, {}).size(), 12u);
}

TEST(ScanPlan, WhatIsSaidHolds) {
  for (const auto& format : usual_formats(rtu(), 300, {})) EXPECT_EQ(format.baud, 300u);
  const auto one = usual_formats(rtu(), 9600, LineFormat{1, 8, Parity::kOdd, 1});
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(to_text(one.front()), "9600 8O1");
}

TEST(ScanPlan, EveryProtocolHasAQuestionThatItsNotationNames) {
  for (const ProtocolEntry& entry : protocols()) {
    const auto protocol = scan_protocol({&entry, {}});
    ASSERT_TRUE(protocol) << entry.name;
    const auto questions = questions_of({&entry, {}}, *protocol);
    EXPECT_FALSE(questions.empty()) << entry.name;
    for (const auto& question : questions) {
      const auto parsed = protocol->parse_address(question.at);
      ASSERT_TRUE(parsed) << entry.name << ' ' << question.at;
      EXPECT_EQ(parsed->area, question.range.area);
      EXPECT_EQ(parsed->first, question.range.first);
    }
  }
}

TEST(ScanPlan, AddressesThatTheProtocolHasNotAreLeftOut) {
  const auto lines = scan_lines(rtu(), {LineFormat{}}, {0, 1, 247, 248, 300});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(lines.front().addresses, ElementsAre(1, 247));
  EXPECT_THAT(scan_lines(rtu(), {LineFormat{}}, {300}), IsEmpty());
}

TEST(ScanPlan, AllUsualSettingsAreProbedWithinTheQuickScan) {
  std::vector<std::uint16_t> addresses(32);
  std::iota(addresses.begin(), addresses.end(), std::uint16_t{1});
  const auto lines = probed_lines(12, addresses);
  EXPECT_GT(silent_scan_time(lines, std::chrono::milliseconds{200}), std::chrono::seconds{150});
  Duration time{};
  for (const ScanLine& line : lines) {
    EXPECT_GE(line.probes.size(), 12u) << to_text(line.format);
    EXPECT_EQ(line.probes.back(), 1) << "the most probable address has the longest wait";
    EXPECT_GE(line.probe_wait, std::chrono::milliseconds{10});
    // Each request is 8 characters.
    time += static_cast<std::int64_t>(line.probes.size()) * line.format.characters(8) +
            static_cast<std::int64_t>(line.probes.size() - 1) * line.probe_wait +
            line.last_probe_wait;
  }
  EXPECT_LT(time, kQuickScan - std::chrono::seconds{1}) << "opening the port takes time, too";
}

TEST(ScanPlan, AKnownSettingIsProbedWithLongWaits) {
  const auto lines = probed_lines(1, {1, 2, 3, 4});
  EXPECT_THAT(lines.front().probes, ElementsAre(2, 3, 4, 1));
  EXPECT_GE(lines.front().probe_wait, std::chrono::milliseconds{150});
}

}  // namespace
}  // namespace fieldcast::cli
