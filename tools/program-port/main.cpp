// fieldcast-port: connects a virtual serial port to a PLC behind a bridge while it runs, or lists
// the devices of the bridge.
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
  bool list = false;
  CommandLine& command =
      line.command("list", "shows the devices that you may program through the bridge");
  port::describe_list(command, given).required();
  command.when_given([&list]() -> std::optional<CommandLine::Fault> {
    list = true;
    return std::nullopt;
  });
  line.make_commands_optional();
  if (const auto fault = line.parse_or_print(argc, argv))
    return *fault ? port::kUsage : port::kStopped;
  return list ? port::run_list(given) : port::run_connection(given);
}
