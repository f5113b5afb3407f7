// The dispatchers: (plan, state, now) -> a read or a rest. They are interchangeable; each is a
// small class with the five operations of the concept below, and copyable with what it decided
// ahead.
#pragma once

#include <concepts>
#include <variant>

#include "core/dispatch/cyclic_dispatcher.hpp"
#include "core/dispatch/dynamic_blocks_dispatcher.hpp"
#include "core/dispatch/earliest_due_dispatcher.hpp"
#include "core/dispatch/intensive_dispatcher.hpp"

namespace fieldcast {

template <typename D>
concept ReadDispatcher = std::copyable<D> &&
    requires(D dispatcher, const D& constant, const ReadPlan& plan, DispatchState& state,
             const GroupState& group, PointState& point, GroupIndex index, Instant at) {
  // What to do now. REQUIRES: the wire is free.
  { dispatcher.next(plan, state, at) } -> std::same_as<Decision>;
  // How long something else may take the wire without making a point late.
  { dispatcher.slack(plan, state, at) } -> std::same_as<Duration>;
  // A group has a new next read, due at the first instant; the second one is now.
  { dispatcher.enqueue(plan, state, index, at, at) } -> std::same_as<void>;
  // A point was acquired: when it is due again.
  { constant.renew(state, group, point, at) } -> std::same_as<void>;
  // What was decided ahead is void.
  { dispatcher.forget() } -> std::same_as<void>;
};

using Dispatcher = std::variant<CyclicDispatcher, IntensiveDispatcher, EarliestDueDispatcher,
                                DynamicBlocksDispatcher>;
static_assert(ReadDispatcher<CyclicDispatcher> && ReadDispatcher<IntensiveDispatcher> &&
              ReadDispatcher<EarliestDueDispatcher> && ReadDispatcher<DynamicBlocksDispatcher>);

// The one that follows this plan.
[[nodiscard]] inline Dispatcher make_dispatcher(Planner planner, const ReadPlan& plan) {
  if (plan.table && plan.table->empty()) return IntensiveDispatcher{};
  if (plan.table) return CyclicDispatcher{};
  if (planner == Planner::kDynamicBlocks) return DynamicBlocksDispatcher{};
  return EarliestDueDispatcher{};
}

}  // namespace fieldcast
