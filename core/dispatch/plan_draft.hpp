// A plan in the making, while the wire runs: (a copy of what is known) -> a plan, or none if the
// one in force shall stay. That takes milliseconds, for ten thousand points a tenth of a second, so
// it is made on another thread than the bus's. A draft is used by one thread at a time.
//
// A plan goes into force only when a rehearsal of it, the change included, keeps every refresh, or
// breaks fewer than the plan in force does. A stretched plan is not rehearsed: nobody is promised
// what it breaks.
#pragma once

#include <optional>
#include <vector>

#include "core/dispatch/plan_runner.hpp"

namespace fieldcast {

class PlanDraft {
 public:
  // `grouped_for`: what reads could bridge when the groups were made. `costs_changed`: since then.
  PlanDraft(PlanRunner runner, std::vector<std::uint32_t> grouped_for, bool costs_changed);

  // Makes the plan. Once.
  void make();

  // After make():
  struct Result {
    double load = 0;                         // of what is asked for
    std::vector<std::uint32_t> grouped_for;  // for the next draft
    std::optional<ReadPlan> plan;            // nothing: the plan in force stays
    Instant began{};                         // of its table
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
