// The bus engine: all behaviour of one bus, as on_event(event, now) -> actions, without a thread, a
// clock or I/O. The shell (BusRunner) executes the actions on the bus's thread; tests execute them
// in virtual time. Owns the parts of the bus and selects the next request; README.md shows how they
// interact.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/bus/bus_parts.hpp"
#include "core/bus/exchange_flow.hpp"
#include "core/bus/health/overload_watch.hpp"
#include "core/bus/setup/bus_setup.hpp"
#include "core/bus/setup/event.hpp"
#include "core/bus/wire/response_forecast.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

class BusEngine {
 public:
  // REQUIRES: `spec` was validated by the loader. `codec` must outlive the engine.
  explicit BusEngine(const BusSpec& spec, TextCodec& codec = plain_text_codec());
  BusEngine(const BusEngine&) = delete;
  BusEngine& operator=(const BusEngine&) = delete;

  [[nodiscard]] const BusSpec& spec() const { return parts_.setup.spec(); }
  [[nodiscard]] Duration longest_timeout() const;  // of the configured devices

  // Continues another bridge's sample sequences and learned values. REQUIRES: no event yet.
  void inherit(const BusInheritance& inherited, Instant now);

  // Appends the actions to perform. `now` never decreases.
  void on_event(const BusEvent& event, Instant now, Actions& actions);

  // Covers the time since the previous report; call once a second. Does not affect the behaviour.
  [[nodiscard]] BusReport bus_report(Instant now);
  [[nodiscard]] DeviceReport device_report(DeviceIndex device, Instant now) const;
  [[nodiscard]] ChannelReport channel_report(ChannelIndex channel, Instant now) const {
    return parts_.channels.report(channel, now);
  }

  [[nodiscard]] std::uint64_t plan_number() const { return parts_.reads.plan_number(); }
  // Whether a device responded since the port was opened last.
  [[nodiscard]] bool responded_since_opened() const {
    return parts_.devices.responded_since_opened();
  }

  [[nodiscard]] PlanReport plan_report() const { return parts_.reads.plan_report(); }

  // Received bytes need no delivery before this time; kLongAgo: deliver them as they arrive.
  [[nodiscard]] Instant quiet_until() const;
  [[nodiscard]] bool exchanging() const { return parts_.exchanging() > 0; }
  // The received bytes are whole frames, or no response is awaited.
  [[nodiscard]] bool frame_ended() const {
    return parts_.wires.size() == 1 ? !exchanging() : stream_.empty();
  }

  // See wire_fence.hpp. Call before the first event.
  void set_fence_order(unsigned rank, std::uint64_t seed) { parts_.fence.set_order(rank, seed); }

  // A device may take a request for a repeated one if a restarted bridge numbers it as its last.
  // Call before the first event.
  void number_requests_from(std::uint16_t sequence) { parts_.late.number_from(sequence); }

  // After StopRequested: when pending responses may still arrive; kLongAgo if there are none.
  [[nodiscard]] Instant responses_until() const {
    return parts_.setup.plain_tcp() ? kLongAgo : parts_.late.owed_until();
  }

  // Of the exchange that sent these bytes last; empty if there is none.
  [[nodiscard]] std::string request_text(ByteView sent) const;
  [[nodiscard]] std::optional<DeviceIndex> asked_device(ByteView sent) const;

  void set_trace(bool on) { tracing_ = on; }

 private:
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
  void handle(const InputsArrived& event, Instant now, ActionSink& sink);
  // Appends the results to the last block behind actions[begin], so that they leave together.
  void calculate(std::size_t begin, Instant now, Actions& actions);
  void settle(Instant now, ActionSink& sink);
  void set_timer(ActionSink& sink);

  // Returns true if the response began before the end of its request.
  [[nodiscard]] bool is_too_early(DeviceIndex device);
  // Until then the received response may be a repetition of the last one. REQUIRES: exchanging().
  [[nodiscard]] Instant repetition_until(Instant now) const;
  bool another_asked(ExchangeDriver::Outcome outcome, Instant now, ActionSink& sink);
  void advance(ExchangeDriver::Outcome outcome, Bytes out, Instant now, ActionSink& sink);
  void take_frames(ByteView bytes, Instant now, ActionSink& sink);
  void take_frame(ByteView frame, Instant now, ActionSink& sink);
  std::optional<Flight> break_off();
  void break_all_off();
  void give_up(Cause cause, Instant now, ActionSink& sink);
  // Ends all exchanges. `cause`: of the loss of the connection, if a device may have caused it.
  void give_all_up(std::optional<Cause> cause, Instant now, ActionSink& sink);
  void reopen(Reopen action, std::optional<Cause> cause, Instant now, ActionSink& sink);
  // Selects the wire of the next request. Returns false if all are in use.
  [[nodiscard]] bool select_free();
  [[nodiscard]] bool any_free() const {
    return parts_.exchanging() < (parts_.commands.alone() ? 1 : parts_.in_flight.now());
  }
  // Returns false if nothing was sent.
  bool send_next(Instant now, ActionSink& sink);
  void take_stray(ByteView bytes, Instant now, ActionSink& sink);
  // Stops sending until the wire is silent, because another master uses it.
  void let_go(Instant now, ActionSink& sink);

  BusParts parts_;
  Arbiter arbiter_;
  OutcomeRouter outcomes_;
  ResponseForecast forecast_;
  OverloadWatch overload_;

  BusState state_ = BusState::kOpening;
  Cause closed_because_ = Cause::kNone;
  bool begun_ = false;
  Instant next_request_at_ = kNever;  // while the wire rests
  Instant timer_ = kNever;            // last value sent to the shell
  Bytes stream_;                      // with several requests in flight: part of a frame
  bool tracing_ = false;
  std::uint64_t samples_ = 0;
  std::uint64_t reopened_ = 0;  // number of times the port was lost
};

// For virtual time: executes each MakePlan action immediately and appends the resulting actions.
void make_plans(BusEngine& engine, Instant now, Actions& actions);

}  // namespace fieldcast
