// Tests the whole matrix of every protocol, built in and shipped as a declaration.
#include "core/protocol/families/registry.hpp"
#include "tests/tools/sim/check_support.hpp"

namespace fieldcast::sim {
namespace {

TEST(DeclaredDevice, RespondsAtAnAddressOfTwelveDigits) {
  const auto declaration = config::load_declaration("dlt645-2007");
  ASSERT_TRUE(declaration);
  Subject subject = subjects_of(*declaration).front();
  subject.device.link.long_address = "398192000337";
  const Requests requests(subject);
  LiveDevice live(subject);
  const NamedRequest example = requests.examples().front();
  const RunOutcome outcome = live.run(requests.protocol().begin(example.request, live.context(1)));
  EXPECT_TRUE(outcome.done) << outcome.text();
}

class BuiltIn : public testing::TestWithParam<std::string> {};

TEST_P(BuiltIn, PassesTheWholeMatrix) { expect_all_pass(subjects_of(GetParam())); }

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const ProtocolEntry& entry : protocols()) all.emplace_back(entry.name);
  return all;
}
INSTANTIATE_TEST_SUITE_P(SimCheck, BuiltIn, testing::ValuesIn(names()), [](const auto& chosen) {
  std::string name = chosen.param;
  std::ranges::replace(name, '-', '_');
  return name;
});

class Declared : public testing::TestWithParam<const char*> {};

TEST_P(Declared, PassesTheWholeMatrix) {
  const auto declaration = config::load_declaration(GetParam());
  ASSERT_TRUE(declaration) << config::to_text(std::span(declaration.error()));
  expect_all_pass(subjects_of(*declaration));
}
INSTANTIATE_TEST_SUITE_P(SimCheck, Declared,
                         testing::Values("instrument", "modbus-rtu-declared", "dlt645-2007",
                                         "adam-4000", "mt-sics", "iec62056-21",
                                         "iec62056-21-optical", "m-bus", "m-bus-secondary",
                                         "panasonic-mewtocol", "fatek-facon", "delta-dvp-ascii",
                                         "delta-dvp-rtu", "keyence-kv", "jk-bms", "kamstrup-kmp"),
                         [](const auto& chosen) {
                           std::string name = chosen.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(SimCheck, DevicesThatAreNeverRequestedPassTheirMatrix) {
  for (const char* name : {"nmea-0183", "scale-stream", "toledo-continuous", "dsmr-p1"}) {
    const auto declaration = config::load_declaration(name);
    ASSERT_TRUE(declaration) << config::to_text(std::span(declaration.error()));
    expect_all_pass(subjects_of(*declaration), kOfUnsolicited);
  }
}

TEST(SimCheck, WhatPassesUnseenIsAFailureWhereACheckWasPromised) {
  Subject subject = subjects_of("modbus-tcp")[0];
  subject.checked = true;
  CheckRows rows;
  check_responses(subject, rows);
  const auto flips = std::ranges::find(rows, "flipped bits", &CheckRow::check);
  ASSERT_NE(flips, rows.end());
  EXPECT_GT(flips->failed(), 0u);
  EXPECT_FALSE(flips->failures.empty());
  EXPECT_LE(flips->failures.size(), CheckRow::kMostFailures);
  EXPECT_FALSE(flips->failures[0].frame.empty());
}

TEST(SimCheck, AProtocolThatNobodyHasHasNoSubject) {
  EXPECT_TRUE(subjects_of("modbus-rtv").empty());
}

}  // namespace
}  // namespace fieldcast::sim
