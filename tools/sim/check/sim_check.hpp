#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tools/sim/check/exchange_run.hpp"

namespace fieldcast::sim {

struct CheckFailure {
  std::string what;   // "bit 3 of byte 12 flipped: taken: [00 05], undisturbed: taken: [00 04]"
  std::string frame;  // disturbed bytes, or the request, in hexadecimal
};

struct CheckRow {
  // stored failures; further ones are only counted
  static constexpr std::size_t kMostFailures = 20;

  std::string variant, check, where;
  std::uint64_t tried = 0, passed = 0;
  std::string note;  // why nothing was tried, or which failures are allowed
  std::vector<CheckFailure> failures;

  [[nodiscard]] std::uint64_t failed() const { return tried - passed; }
  void pass() { ++tried, ++passed; }
  void fail(std::string what, std::string frame) {
    ++tried;
    if (failures.size() < kMostFailures) failures.push_back({std::move(what), std::move(frame)});
  }
};
using CheckRows = std::vector<CheckRow>;

// Tests the master of a protocol against its simulated device in virtual time.
// Deterministic; lasts some seconds at most. `on_share` receives the finished share, 0..1.
[[nodiscard]] CheckRows sim_check(const Subject& subject,
                                  const std::function<void(double share)>& on_share = {});

void check_values(const Subject& subject, CheckRows& rows);
void check_notation(const Subject& subject, CheckRows& rows);
void check_responses(const Subject& subject, CheckRows& rows);
void check_faults(const Subject& subject, CheckRows& rows);
void check_late(const Subject& subject, CheckRows& rows);
void check_unsolicited(const Subject& subject, CheckRows& rows);

}  // namespace fieldcast::sim
