// Exit codes of fieldcast-bridge.
#pragma once

namespace fieldcast {

enum class ExitCode : int {
  kOk = 0,  // stopped normally, or --check found no fault
  kInternal = 1,
  kUsage = 2,
  kBadConfiguration = 3,  // faults in the file or in the identity it names, all on stderr
  kCannotStart = 4,       // DDS cannot be joined as configured
  kHung = 5,              // a bus or the bridge could not stop because a driver or a library hangs
};

}  // namespace fieldcast
