// The whole matrix of every protocol, built in and declared: nothing fails, nothing is left untried, and what is wrong is found.
#include <gtest/gtest.h>

#include <algorithm>

#include "config/loader.hpp"
#include "tools/sim/check/sim_check.hpp"

namespace fieldcast::sim {
namespace {

std::string failures(const CheckRows& rows) {
  std::string text;
  for (const CheckRow& row : rows) {
    for (const CheckFailure& failure : row.failures)
      text += row.variant + ", " + row.check + ", " + row.where + ": " + failure.what + "\n";
  }
  return text;
}

void expect_all_pass(const std::vector<Subject>& subjects) {
  ASSERT_FALSE(subjects.empty());
  for (const Subject& subject : subjects) {
    const CheckRows rows = sim_check(subject);
    EXPECT_EQ(failures(rows), "");
    for (const CheckRow& row : rows) {
      EXPECT_EQ(row.failed(), 0u) << row.check << ", " << row.where;
      EXPECT_TRUE(row.tried > 0 || !row.note.empty()) << row.check << ", " << row.where << " was not tried, and nobody says why";
    }
    for (const char* check :
         {"read", "splits", "truncations", "flipped bits", "noise before", "device errors", "silence", "late answer"}) {
      EXPECT_TRUE(std::ranges::any_of(rows, [&](const CheckRow& row) { return row.check == check && row.tried > 0; })) << check;
    }
  }
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
INSTANTIATE_TEST_SUITE_P(SimCheck, Declared, testing::Values("instrument", "modbus-rtu-declared"), [](const auto& chosen) {
  std::string name = chosen.param;
  std::ranges::replace(name, '-', '_');
  return name;
});

TEST(SimCheck, WhatPassesUnseenIsAFailureWhereACheckWasPromised) {
  Subject subject = subjects_of("modbus-tcp")[0];
  subject.checked = true;
  CheckRows rows;
  check_answers(subject, rows);
  const auto flips = std::ranges::find(rows, "flipped bits", &CheckRow::check);
  ASSERT_NE(flips, rows.end());
  EXPECT_GT(flips->failed(), 0u);
  EXPECT_FALSE(flips->failures.empty());
  EXPECT_LE(flips->failures.size(), CheckRow::kMostFailures);
  EXPECT_FALSE(flips->failures[0].frame.empty());
}

TEST(SimCheck, AProtocolThatNobodyHasHasNoSubject) { EXPECT_TRUE(subjects_of("modbus-rtv").empty()); }

}  // namespace
}  // namespace fieldcast::sim
