// The second seam: what happens to a bus, and what the bus wants done.
#pragma once

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
struct Opened {};  // the port is ready; nothing sent before is on the wire any more
struct Closed {
  std::string reason;
  Cause cause = Cause::kPortClosed;
};  // the port is gone, or could not be opened
struct Received {
  ByteView bytes;
};                     // valid during the call
struct TimerFired {};  // the instant of the last SetTimer has come
struct CommandArrived {
  Command command;
};
struct InterestChanged {  // the shortest refresh wished for a channel, or the end of all wishes
  ChannelIndex channel = 0;
  std::optional<Duration> refresh;
};
struct LeaseBegan {
  std::string who;
};  // the port belongs to a programming session from now on
struct LeaseEnded {};
struct StopRequested {
};                 // answers every pending command with kShutdown; nothing is sent afterwards
struct PlanMade {  // what MakePlan asked for
  std::shared_ptr<PlanDraft> draft;
};
using BusEvent = std::variant<Opened, Closed, Received, TimerFired, CommandArrived, InterestChanged,
                              LeaseBegan, LeaseEnded, StopRequested, PlanMade>;

// Actions, to be executed in order.
struct Send {
  Bytes bytes;
};  // one whole request; the wire is ours until its answer or timeout
struct SetTimer {
  Instant at;
};  // replaces the one before; kNever: none
struct Publish {
  std::vector<Sample> samples;
};
struct Promise {  // from now on the channel is published at least this often; nothing: no promise
  ChannelIndex channel = 0;
  std::optional<Duration> gap;
};
struct Complete {
  CommandResult result;
};
struct Reopen {
  std::string reason;
};  // close the port and open it again, with the shell's back-off
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
    kGarbageEnded
  };
  Kind kind;
  std::string device;  // empty for the bus
  Cause cause = Cause::kNone;
  std::string text;  // "holding:107 refused (exception 02); asked again in 10min"
};
// One exchange ended: for the wire trace.
struct Traced {
  std::string device;
  std::string text;  // "read holding 100..109: 10 items" or the failure
};
// Call the draft's make() away from the wire's time, on any thread, then tell PlanMade; one is
// asked for at a time. The draft needs nothing of the engine, which may end before it.
struct MakePlan {
  std::shared_ptr<PlanDraft> draft;
};
using Action =
    std::variant<Send, SetTimer, Publish, Promise, Complete, Reopen, Notice, Traced, MakePlan>;
using Actions = std::vector<Action>;

}  // namespace fieldcast
