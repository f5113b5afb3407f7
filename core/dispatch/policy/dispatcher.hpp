// The dispatchers: (plan, state, now) -> a read or a rest. Interchangeable; a copy includes the
// decisions made ahead.
#pragma once

#include <concepts>
#include <variant>

#include "core/dispatch/policy/cyclic_dispatcher.hpp"
#include "core/dispatch/policy/dynamic_blocks_dispatcher.hpp"
#include "core/dispatch/policy/earliest_due_dispatcher.hpp"
#include "core/dispatch/policy/intensive_dispatcher.hpp"
#include "core/model/planner_choice.hpp"

namespace fieldcast {

template <typename D>
concept ReadDispatcher = std::copyable<D> &&
    requires(D dispatcher, const D& constant, const ReadPlan& plan, DispatchState& state,
             const GroupState& group, PointState& point, GroupIndex index, Instant at) {
  // REQUIRES: the wire is free.
  { dispatcher.next(plan, state, at) } -> std::same_as<Decision>;
  // How long the wire may be used otherwise without delaying a point.
  { dispatcher.slack(plan, state, at) } -> std::same_as<Duration>;
  // A group has a new next read, due at the first time; the second one is now.
  { dispatcher.enqueue(plan, state, index, at, at) } -> std::same_as<void>;
  { constant.renew(state, group, point, at) } -> std::same_as<void>;
  { dispatcher.forget() } -> std::same_as<void>;
};

using Dispatcher = std::variant<CyclicDispatcher, IntensiveDispatcher, EarliestDueDispatcher,
                                DynamicBlocksDispatcher>;
static_assert(ReadDispatcher<CyclicDispatcher> && ReadDispatcher<IntensiveDispatcher> &&
              ReadDispatcher<EarliestDueDispatcher> && ReadDispatcher<DynamicBlocksDispatcher>);

[[nodiscard]] inline Dispatcher make_dispatcher(Planner planner, const ReadPlan& plan) {
  if (plan.table && plan.table->empty()) return IntensiveDispatcher{};
  if (plan.table) return CyclicDispatcher{};
  if (planner == Planner::kDynamicBlocks) return DynamicBlocksDispatcher{};
  return EarliestDueDispatcher{};
}

}  // namespace fieldcast
