// Exit codes of `fieldcast`; part of the interface for scripts.
#pragma once

namespace fieldcast::cli {

enum class ExitCode : int {
  kOk = 0,        // done, or verified
  kFound = 1,     // the input has a fault: an invalid frame, an infeasible plan
  kUsage = 2,     // invalid command line, or invalid file named there
  kNoBridge = 3,  // no bridge in this DDS domain
  kNothing = 4,   // a bridge exists, but nothing matches
  // A command was refused before it reached the wire: access, type, range, unknown channel, ...
  kRejected = 5,
  kFailed = 6,         // a command failed on the wire or in the device
  kExpired = 7,        // a command expired
  kNoAnswer = 8,       // no result within the timeout
  kTrouble = 9,        // a fault of the machine: DDS cannot start, the output is closed
  kInterrupted = 130,  // Ctrl-C
};

[[nodiscard]] constexpr int to_int(ExitCode code) { return static_cast<int>(code); }

}  // namespace fieldcast::cli
