// Runs a plan in virtual time before it is adopted. Pure functions; any thread.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/dispatch/plan_runner.hpp"

namespace fieldcast {

inline constexpr std::uint64_t kAnyNumber = std::numeric_limits<std::uint64_t>::max();

// Late acquisitions, at most `enough`, until every point was read twice (at most 20 000 reads).
// `runner`: a copy, in the state at the start of the plan.
[[nodiscard]] std::uint64_t count_late(PlanRunner runner, Instant now,
                                       std::uint64_t enough = kAnyNumber);

// Computes a new plan from a copy of the present state, or none if the present plan should stay.
// This lasts milliseconds (a tenth of a second for ten thousand points), so it runs on another
// thread than the bus's, one at a time. A plan is adopted only if its rehearsal, including the
// change, keeps every refresh, or breaks fewer than the present plan. A stretched plan is not
// rehearsed, as its refreshes are not promised.
class PlanDraft {
 public:
  // `grouped_for`: bridgeable items when the groups were made.
  PlanDraft(PlanRunner runner, std::vector<std::uint32_t> grouped_for, bool costs_changed);

  // Makes the plan. Call once.
  void make();

  // After make():
  struct Result {
    double load = 0;                         // of the present requests
    std::vector<std::uint32_t> grouped_for;  // for the next draft
    std::optional<ReadPlan> plan;            // empty: the present plan stays
    Instant began{};                         // start of its table
  };
  [[nodiscard]] const Result& result() const { return result_; }
  [[nodiscard]] Result take_result() { return std::move(result_); }

 private:
  [[nodiscard]] std::vector<ReadPlan> plans_asked_for(PlanBasis& basis);
  [[nodiscard]] bool worth_planning(double load, Duration fastest) const;
  [[nodiscard]] bool worth_grouping();
  void prove(const std::vector<ReadPlan>& plans, std::uint64_t late_at_present);

  PlanRunner runner_;
  bool costs_changed_;
  Result result_;
};

}  // namespace fieldcast
