// fieldcast-bridge CONFIG [--check]: reads PLCs on buses, publishes their channels on DDS, carries
// commands back.
#include <CLI/CLI.hpp>
#include <chrono>
#include <exception>

#include "bridge/daemon.hpp"
#include "bridge/log/log.hpp"
#include "bridge/write_faults.hpp"

namespace {

fieldcast::ExitCode run(int argc, char** argv) {
  CLI::App app{"Publishes the channels of PLCs on DDS and carries commands back."};
  app.footer(
      "Signals: SIGHUP reloads the file, SIGUSR1 switches the wire trace, SIGTERM and SIGINT stop "
      "in order.\n"
      "Exit codes: 0 in order, 1 a fault of the program, 2 command line, 3 faults in the "
      "configuration, 4 DDS cannot be joined, 5 a driver or a library hung during the stop.");
  fieldcast::DaemonOptions options;
  bool check = false;
  app.add_option("CONFIG", options.configuration, "the configuration (YAML)")->required();
  app.add_flag("--check", check, "only report the faults of the configuration");
  app.add_flag("--trace", options.trace, "write every frame to stdout from the start");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? fieldcast::ExitCode::kOk : fieldcast::ExitCode::kUsage;
  }
  return check ? fieldcast::check_configuration(options.configuration)
               : fieldcast::run_daemon(options);
}

}  // namespace

int main(int argc, char** argv) {
  fieldcast::make_writes_fail_not_kill();
  try {
    return static_cast<int>(run(argc, argv));
  } catch (const std::exception& error) {
    fieldcast::log_error("bridge", error.what());
    fieldcast::flush_log(std::chrono::milliseconds{300});
    return static_cast<int>(fieldcast::ExitCode::kInternal);
  }
}
