// fieldcast-bridge CONFIG [--check]: reads PLCs on buses, publishes their channels on DDS, carries commands back.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "bridge/daemon.hpp"

namespace {

fieldcast::ExitCode run(int argc, char** argv) {
  CLI::App app{"Publishes the channels of PLCs on DDS and carries commands back."};
  app.footer(
      "Signals: SIGHUP reloads the file, SIGUSR1 switches the wire trace, SIGTERM and SIGINT stop in order.\n"
      "Exit codes: 0 in order, 1 a fault of the program, 2 command line, 3 faults in the configuration, 4 DDS cannot be joined.");
  fieldcast::DaemonOptions options;
  bool check = false;
  app.add_option("CONFIG", options.configuration, "the configuration (YAML)")->required();
  app.add_flag("--check", check, "only report the faults of the configuration");
  app.add_flag("--trace", options.trace, "write every frame to stdout from the start");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) { return app.exit(error) == 0 ? fieldcast::ExitCode::kOk : fieldcast::ExitCode::kUsage; }
  return check ? fieldcast::check_configuration(options.configuration) : fieldcast::run_daemon(options);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return static_cast<int>(run(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fieldcast-bridge: %s\n", error.what());
    return static_cast<int>(fieldcast::ExitCode::kInternal);
  }
}
