// The interface between a bus engine and its shell: what happens to a bus (events), and what the
// engine wants done (actions). Plain values without a thread; their receiver owns them.
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
#include "core/model/command.hpp"
#include "core/model/sample.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class PlanDraft;  // core/dispatch/plan_draft.hpp

// Events. The shell tells them in the order in which they happened.

// The port is ready. `quiet_until`: answers to what another engine sent into it may come until
// then; nothing is sent before, and what comes is nobody's.
struct Opened {
  Instant quiet_until = kLongAgo;
};
// The port is gone, or could not be opened.
struct Closed {
  std::string reason;
  Cause cause = Cause::kPortClosed;
};
// Bytes arrived; they are valid during the call.
struct Received {
  ByteView bytes;
};
// The instant of the last SetTimer has come.
struct TimerFired {};
struct CommandArrived {
  Command command;
};
// The shortest refresh that stations want of a channel; nothing: all interest in it ended.
struct InterestChanged {
  ChannelIndex channel = 0;
  std::optional<Duration> refresh;
};
// The port belongs to a programming session from now on.
struct LeaseBegan {
  std::string who;
};
struct LeaseEnded {};
// Every pending command is answered with kShutdown; nothing is sent afterwards.
struct StopRequested {};
// Another bridge may have published samples of this bus, with numbers up to this one: samples count
// on from above it, and what is not good is told once more.
struct CountAbove {
  std::uint64_t number = 0;
};
// The last Send was not carried out: by its time another master may have had the wire. Nothing of
// it left; told before anything else.
struct NotSent {};
// The draft of the last MakePlan is made.
struct PlanMade {
  std::shared_ptr<PlanDraft> draft;
};
using BusEvent = std::variant<Opened, Closed, Received, TimerFired, CommandArrived, InterestChanged,
                              LeaseBegan, LeaseEnded, StopRequested, CountAbove, NotSent, PlanMade>;

// Actions, to be executed in order.

// Send one whole request; the wire is ours until its answer or timeout.
struct Send {
  Bytes bytes;
};
// Replaces the timer before it; kNever: no timer.
struct SetTimer {
  Instant at;
};
struct Publish {
  std::vector<Sample> samples;
};
// From now on the channel is published at least this often; nothing: no promise.
struct Promise {
  ChannelIndex channel = 0;
  std::optional<Duration> gap;
};
struct Complete {
  CommandResult result;
};
// Close the port and open it again, with the shell's back-off.
struct Reopen {
  std::string reason;
};
// Something a log should say once; counted when it repeats.
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
  std::string device;  // empty: the whole bus
  Cause cause = Cause::kNone;
  std::string text;  // "holding:107 is refused (02 illegal data address); asked again in 60s"
};
// One exchange ended: for the wire trace.
struct Traced {
  std::string device;
  std::string text;  // "read holding 100..109: 10 items" or the failure
};
// Call the draft's make(), best on another thread than the bus's, then tell PlanMade. At most one
// draft is under way. It needs nothing of the engine, which may end before it.
struct MakePlan {
  std::shared_ptr<PlanDraft> draft;
};
using Action =
    std::variant<Send, SetTimer, Publish, Promise, Complete, Reopen, Notice, Traced, MakePlan>;
using Actions = std::vector<Action>;

}  // namespace fieldcast
