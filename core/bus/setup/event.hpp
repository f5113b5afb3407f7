// Interface of a bus engine and its shell: events and actions. Plain values.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/command.hpp"
#include "core/model/sample.hpp"

namespace fieldcast {

class PlanDraft;

// Events, in the order of their occurrence.

// No request is sent before `quiet_until`, as responses to another engine may arrive until then.
struct Opened {
  Instant quiet_until = kLongAgo;
};
struct Closed {
  std::string reason;
  Cause cause = Cause::kPortClosed;
};
// Valid during the call.
struct Received {
  ByteView bytes;
};
struct TimerFired {};
struct CommandArrived {
  Command command;
};
// The shortest refresh requested by stations; empty if all interest ended.
struct InterestChanged {
  ChannelIndex channel = 0;
  std::optional<Duration> refresh;
};
struct LeaseBegan {
  std::string who;
};
struct LeaseEnded {};
// Completes every pending command with kShutdown; nothing is sent afterwards.
struct StopRequested {};
// Samples continue above this number, as another bridge may have published up to it. Samples that
// are not good are published again.
struct CountAbove {
  std::uint64_t number = 0;
};
// Another master may have taken the wire, so no byte of this Send was sent. Reported before other
// events. Valid during the call.
struct NotSent {
  ByteView bytes;
};
struct PlanMade {
  std::shared_ptr<PlanDraft> draft;
};
// Inputs of calculated channels that belong to other buses.
struct InputsArrived {
  std::vector<InputSample> samples;
};
using BusEvent =
    std::variant<Opened, Closed, Received, TimerFired, CommandArrived, InterestChanged, LeaseBegan,
                 LeaseEnded, StopRequested, CountAbove, NotSent, PlanMade, InputsArrived>;

// Actions, executed in order.

// Sends one whole request; the wire is reserved until its response or timeout.
struct Send {
  Bytes bytes;
  // Other requests wait for their responses, so received bytes must not be dropped.
  bool others_wait = false;
  // The port receives at this rate behind these bytes, until the next ones; 0: that of the line.
  std::uint32_t response_baud = 0;
};
// Replaces the previous timer; kNever disables it.
struct SetTimer {
  Instant at;
};
struct Publish {
  std::vector<Sample> samples;
};
// Promises that the channel is published at least this often; empty for no promise.
struct Promise {
  ChannelIndex channel = 0;
  std::optional<Duration> gap;
};
struct Complete {
  CommandResult result;
};
struct Reopen {
  std::string reason;
};
// A message for the log; repetitions are counted.
struct Notice {
  enum class Kind : std::uint8_t {
    kDeviceLost,
    kDeviceBack,
    kDeviceErrors,
    kAddressRefused,
    kOverload,
    kOverloadEnded,
    kEchoFound,
    kGarbage,
    kGarbageEnded,
    kForeignMaster,
    kForeignMasterEnded
  };
  Kind kind;
  std::string device;  // empty for the whole bus
  Cause cause = Cause::kNone;
  std::string text;
};
struct Traced {
  std::string device;
  std::string text;  // "read holding 100..109: 10 items", or the failure
};
// Requests a call of make(), preferably on another thread, followed by PlanMade. At most one draft
// is pending; it may outlive the engine.
struct MakePlan {
  std::shared_ptr<PlanDraft> draft;
};
using Action =
    std::variant<Send, SetTimer, Publish, Promise, Complete, Reopen, Notice, Traced, MakePlan>;
using Actions = std::vector<Action>;

}  // namespace fieldcast
