// The bus engine: everything one bus does, as on_event(event, now) -> actions. No thread, no clock,
// no I/O.
//
// The shell (BusRunner) executes the actions on the bus's thread; tests execute them in virtual
// time. The engine owns the parts of the bus and decides what goes on the wire next. Each part owns
// its own state; README.md shows how they work together.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/bus/action_sink.hpp"
#include "core/bus/arbiter.hpp"
#include "core/bus/bus_parts.hpp"
#include "core/bus/event.hpp"
#include "core/bus/outcome_router.hpp"
#include "core/bus/overload_watch.hpp"
#include "core/model/inheritance.hpp"
#include "core/model/spec.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

class BusEngine {
 public:
  // REQUIRES: spec is as the loader makes it (every protocol known, every address inside its area);
  // codec outlives the engine.
  explicit BusEngine(const BusSpec& spec, TextCodec& codec = plain_text_codec());
  BusEngine(const BusEngine&) = delete;
  BusEngine& operator=(const BusEngine&) = delete;

  // Goes on where another bridge was: its samples count on, and what was learned of devices need
  // not be learned again. REQUIRES: no event yet.
  void inherit(const BusInheritance& inherited, Instant now);

  // Appends what is to be done. `now` never goes back.
  void on_event(const BusEvent& event, Instant now, Actions& actions);

  // Reports cover the time since the one before; the shell asks once a second. Does not change what
  // the engine does.
  [[nodiscard]] BusReport bus_report(Instant now);
  [[nodiscard]] DeviceReport device_report(DeviceIndex device, Instant now) const;
  [[nodiscard]] ChannelReport channel_report(ChannelIndex channel, Instant now) const {
    return parts_.channels.report(channel, now);
  }

  // Counts the plans that were in force, from 1; and the present one.
  [[nodiscard]] std::uint64_t plan_number() const { return parts_.reads.plan_number(); }
  [[nodiscard]] PlanReport plan_report() const { return parts_.reads.plan_report(); }

  // Characters that the answer under way lacks, at least; 0 when that is not known. The shell may
  // let them gather.
  [[nodiscard]] std::uint32_t missing() const { return parts_.wire.driver().missing(); }
  // An answer may be on its way.
  [[nodiscard]] bool exchanging() const { return parts_.wire.exchanging(); }

  // Of the bridges at one wire (`fence: listen`): wire_fence.hpp. Before the first event.
  void set_fence_order(unsigned rank, std::uint64_t seed) { parts_.fence.set_order(rank, seed); }

  // After StopRequested: until when answers to what was sent may come; kLongAgo: none will.
  [[nodiscard]] Instant answers_until() const {
    return parts_.setup.plain_tcp() ? kLongAgo : parts_.late.owed_until();
  }

  // What the request on the wire is for, and the device that it goes to; empty: none is.
  [[nodiscard]] std::string request_text() const;
  [[nodiscard]] std::optional<DeviceIndex> asked_device() const;

  // While set, exchanges are described in Traced actions.
  void set_trace(bool on) { tracing_ = on; }

 private:
  // Events.
  void handle(const Opened& event, Instant now, ActionSink& sink);
  void handle(const Closed& event, Instant now, ActionSink& sink);
  void handle(const Received& event, Instant now, ActionSink& sink);
  void handle(const TimerFired& event, Instant now, ActionSink& sink);
  void handle(const CommandArrived& event, Instant now, ActionSink& sink);
  void handle(const InterestChanged& event, Instant now, ActionSink& sink);
  void handle(const LeaseBegan& event, Instant now, ActionSink& sink);
  void handle(const LeaseEnded& event, Instant now, ActionSink& sink);
  void handle(const StopRequested& event, Instant now, ActionSink& sink);
  void handle(const CountAbove& event, Instant now, ActionSink& sink);
  void handle(const NotSent& event, Instant now, ActionSink& sink);
  void handle(const PlanMade& event, Instant now, ActionSink& sink);
  // After every event: what ran out by now, what goes on the wire next, and when to look again.
  void settle(Instant now, ActionSink& sink);
  void set_timer(ActionSink& sink);

  // The answer that came began before its request had ended.
  [[nodiscard]] bool is_too_early(DeviceIndex device);
  // An answer came, and before it the request of another master: the exchange is given up.
  bool another_asked(ExchangeDriver::Outcome outcome, Instant now, ActionSink& sink);
  // The exchange on the wire goes on, or ends.
  void advance(ExchangeDriver::Outcome outcome, Bytes out, Instant now, ActionSink& sink);
  std::optional<Flight> break_off();
  // Likewise; what waits for it is told the cause.
  void give_up(Cause cause, Instant now, ActionSink& sink);
  // The wire is free: the next request, if it may and need be sent.
  void send_next(Instant now, ActionSink& sink);
  // Bytes that nobody asked for.
  void take_stray(ByteView bytes, Instant now, ActionSink& sink);
  // Another master speaks on the wire: nothing is sent until it is silent.
  void let_go(Instant now, ActionSink& sink);

  BusParts parts_;
  Arbiter arbiter_;         // before an exchange
  OutcomeRouter outcomes_;  // after it
  OverloadWatch overload_;

  BusState state_ = BusState::kOpening;
  Cause closed_because_ = Cause::kNone;  // while it is closed
  bool begun_ = false;                   // the first event has come
  Instant next_request_at_ = kNever;     // when to look for one, while the wire rests
  Instant timer_ = kNever;               // as the shell was told last
  bool tracing_ = false;
  std::uint64_t samples_ = 0;   // published
  std::uint64_t reopened_ = 0;  // times that the port was lost
};

// For tests and simulations in virtual time: executes every MakePlan among the actions at once, and
// appends the actions that follow from it.
void make_plans(BusEngine& engine, Instant now, Actions& actions);

}  // namespace fieldcast
