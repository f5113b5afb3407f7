// fieldcast-port: connects a virtual serial port to a PLC behind a bridge while it runs.
#include "bridge/base/write_faults.hpp"
#include "bridge/process/secret.hpp"
#include "tools/program-port/connection.hpp"

int main(int argc, char** argv) {
  using namespace fieldcast;
  make_writes_fail_not_kill();
  guard_memory();
  port::Connection given;
  CommandLine line("fieldcast-port",
                   "Makes a virtual serial port at PATH that leads to a PLC behind a bridge: "
                   "programming software opens it as a COM port.");
  port::describe_connection(line, given);
  if (const auto fault = line.parse_or_print(argc, argv))
    return *fault ? port::kUsage : port::kStopped;
  return port::run_connection(given);
}
