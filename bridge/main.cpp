// fieldcast-bridge CONFIG [--check]: polls PLCs, publishes their channels on DDS, runs commands.
#include <chrono>
#include <cstdio>
#include <exception>

#include "bridge/daemon.hpp"
#include "bridge/log/log.hpp"
#include "bridge/process/command_line.hpp"
#include "bridge/process/secret.hpp"
#include "bridge/write_faults.hpp"

namespace {

fieldcast::ExitCode run(int argc, char** argv) {
  fieldcast::CommandLine line("fieldcast-bridge",
                              "Publishes the channels of PLCs on DDS and carries commands back.");
  line.set_footer(
      "Signals: SIGHUP reloads the file, SIGUSR1 switches the wire trace, SIGTERM and SIGINT stop "
      "in order.\n"
      "Exit codes: 0 in order, 1 a fault of the program, 2 command line, 3 faults in the "
      "configuration, 4 DDS cannot be joined, 5 a driver or a library hung during the stop.");
  fieldcast::DaemonOptions options;
  bool check = false;
  line.text("CONFIG", options.configuration, "the configuration (YAML)").required();
  line.flag("--check", check, "only report the faults of the configuration");
  line.flag("--trace", options.trace, "write every frame to stdout from the start");
  if (const auto ended = line.parse(argc, argv)) {
    std::fputs(ended->text.c_str(), ended->fault ? stderr : stdout);
    return ended->fault ? fieldcast::ExitCode::kUsage : fieldcast::ExitCode::kOk;
  }
  return check ? fieldcast::check_configuration(options.configuration)
               : fieldcast::run_daemon(options);
}

}  // namespace

int main(int argc, char** argv) {
  fieldcast::make_writes_fail_not_kill();
  fieldcast::guard_memory();
  try {
    return static_cast<int>(run(argc, argv));
  } catch (const std::exception& error) {
    fieldcast::log_error("bridge", error.what());
    fieldcast::flush_log(std::chrono::milliseconds{300});
    return static_cast<int>(fieldcast::ExitCode::kInternal);
  }
}
