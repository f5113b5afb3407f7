// `fieldcast`: reads the command line, runs one command, ends with its exit code.
#include <cerrno>
#include <cstring>
#include <exception>
#include <iostream>
#include <string>

#include "bridge/write_faults.hpp"
#include "tools/cli/arguments.hpp"
#include "tools/cli/console.hpp"

namespace fieldcast::cli {
namespace {

// For what is printed once: better wrapped by the terminal than cut.
Screen wide_screen() { return {0, 0, output_screen().colour}; }

struct Run {
  ExitCode operator()(const InspectOptions& options) const {
    return inspect(options, std::cin, std::cout, std::cerr, wide_screen());
  }
  ExitCode operator()(const PlanOptions& options) const {
    return plan(options, std::cout, std::cerr, wide_screen());
  }
  ExitCode operator()(const SimCheckOptions& options) const {
    return sim_check(options, std::cout, std::cerr, wide_screen());
  }
  ExitCode operator()(const HistoryOptions& options) const {
    return history(options, std::cout, std::cerr);
  }
  ExitCode operator()(const DevicesOptions& options) const {
    return devices(options, std::cout, std::cerr);
  }
  ExitCode operator()(const AuditOptions& options) const {
    return audit(options, std::cout, std::cerr);
  }
  ExitCode operator()(const UserOptions& options) const {
    return user(options, std::cin, std::cout, std::cerr);
  }
  ExitCode operator()(const WatchOptions& options) const { return joined(options, watch); }
  ExitCode operator()(const WriteOptions& options) const { return joined(options, write); }
  ExitCode operator()(const AcquireOptions& options) const { return joined(options, acquire); }
  ExitCode operator()(const SessionsOptions& options) const { return joined(options, sessions); }
  ExitCode operator()(const StatusOptions& options) const { return joined(options, status); }
  ExitCode operator()(const AlarmsOptions& options) const {
    return options.span ? stored_alarms(options, std::cout, std::cerr) : joined(options, alarms);
  }

 private:
  template <typename Options, typename Command>
  static ExitCode joined(const Options& options, Command command) {
    Interrupt interrupt;  // before DDS starts its threads
    const auto spec = resolve(options.connection);
    if (!spec) {
      std::cerr << spec.error() << '\n';
      return ExitCode::kUsage;
    }
    return command(options, *spec, interrupt, std::cout, std::cerr);
  }
};

// What was not written was not said, whatever the command came to. A reader that closes the pipe
// has heard enough.
ExitCode whole_output(ExitCode code) {
  errno = 0;
  if (std::cout.flush() || code != ExitCode::kOk) return code;
  if (errno != EPIPE)
    std::cerr << "fieldcast: the output could not be written"
              << (errno == 0 ? "" : std::string(": ") + std::strerror(errno)) << '\n';
  return ExitCode::kTrouble;
}

int run(int argc, const char* const* argv) {
  const auto arguments = parse_arguments(argc, argv);
  if (!arguments) {
    (arguments.error().code == ExitCode::kOk ? std::cout : std::cerr) << arguments.error().text;
    return to_int(arguments.error().code);
  }
  return to_int(whole_output(std::visit(Run{}, *arguments)));
}

}  // namespace
}  // namespace fieldcast::cli

int main(int argc, char** argv) {
  fieldcast::make_writes_fail_not_kill();
  try {
    return fieldcast::cli::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "fieldcast: " << error.what() << '\n';
    return to_int(fieldcast::cli::ExitCode::kTrouble);
  }
}
