// How `fieldcast` ends: the contract with scripts.
#pragma once

namespace fieldcast::cli {

enum class ExitCode : int {
  kOk = 0,     // done, or verified
  kFound = 1,  // the thing looked at is at fault: a frame with faults, a plan that is not feasible
  kUsage = 2,  // the command line or a file that it names cannot be understood
  kNoBridge = 3,  // nobody of Fieldcast in this DDS domain
  kNothing = 4,   // the bridge is there, but nothing of it matches
  // A command was refused before the wire: access, type, range, unknown channel, ...
  kRejected = 5,
  kFailed = 6,         // a command reached the wire, or its device, and failed there
  kExpired = 7,        // a command was too late
  kNoAnswer = 8,       // no result came within the timeout
  kTrouble = 9,        // the machine: DDS would not start, the output is closed
  kInterrupted = 130,  // Ctrl-C
};

[[nodiscard]] constexpr int to_int(ExitCode code) { return static_cast<int>(code); }

}  // namespace fieldcast::cli
