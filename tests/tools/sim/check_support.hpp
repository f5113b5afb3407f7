// Shared by the tests of `sim-check`.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "config/loader/loader.hpp"
#include "tools/sim/check/requests.hpp"
#include "tools/sim/check/sim_check.hpp"

namespace fieldcast::sim {

inline std::string failures(const CheckRows& rows) {
  std::string text;
  for (const CheckRow& row : rows) {
    for (const CheckFailure& failure : row.failures)
      text += row.variant + ", " + row.check + ", " + row.where + ": " + failure.what + "\n";
  }
  return text;
}

inline constexpr std::initializer_list<const char*> kOfRequests{
    "read",         "notation",      "splits",  "truncations",  "flipped bits",
    "noise before", "device errors", "silence", "late response"};
inline constexpr std::initializer_list<const char*> kOfUnsolicited{
    "values", "notation", "splits", "truncations", "flipped bits", "noise before", "late response"};

inline void expect_all_pass(const std::vector<Subject>& subjects,
                            std::initializer_list<const char*> checks = kOfRequests) {
  ASSERT_FALSE(subjects.empty());
  for (const Subject& subject : subjects) {
    const CheckRows rows = sim_check(subject);
    EXPECT_EQ(failures(rows), "");
    for (const CheckRow& row : rows) {
      EXPECT_EQ(row.failed(), 0u) << row.check << ", " << row.where;
      EXPECT_TRUE(row.tried > 0 || !row.note.empty())
          << row.check << ", " << row.where << " was not tried, and nobody says why";
    }
    for (const char* check : checks) {
      EXPECT_TRUE(std::ranges::any_of(rows, [&](const CheckRow& row) {
        return row.check == check && row.tried > 0;
      })) << check;
    }
  }
}

inline Subject declared_as(const std::string& text) {
  auto declaration = config::load_declaration_text(text, "mine.yaml");
  if (!declaration) throw std::runtime_error(config::to_text(std::span(declaration.error())));
  return subjects_of(*declaration).front();
}

}  // namespace fieldcast::sim
