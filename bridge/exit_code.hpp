// What fieldcast-bridge tells its caller when it ends.
#pragma once

namespace fieldcast {

enum class ExitCode : int {
  kOk = 0,                // stopped in order, or --check found no fault
  kInternal = 1,          // a fault of our own
  kUsage = 2,             // the command line
  kBadConfiguration = 3,  // faults in the file, or in the identity that it names: all on stderr
  kCannotStart = 4,       // DDS cannot be joined as configured
  kHung = 5,              // a bus was to stop, or all, and a driver or a library did not let it
};

}  // namespace fieldcast
