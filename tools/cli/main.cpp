// `fieldcast`: parses the command line, runs one command and exits with its code.
#include <cerrno>
#include <exception>
#include <iostream>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/base/write_faults.hpp"
#include "bridge/process/secret.hpp"
#include "tools/cli/arguments.hpp"
#include "tools/cli/terminal/console.hpp"

namespace fieldcast::cli {
namespace {

// Reports incomplete output as an error. A reader that has closed the pipe needs no message.
ExitCode whole_output(ExitCode code) {
  errno = 0;
  if (std::cout.flush() || code != ExitCode::kOk) return code;
  if (errno != EPIPE)
    std::cerr << "fieldcast: the output could not be written"
              << (errno == 0 ? "" : ": " + errno_text(errno)) << '\n';
  return ExitCode::kTrouble;
}

int run(int argc, const char* const* argv) {
  auto arguments = parse_arguments(argc, argv);
  if (!arguments) {
    (arguments.error().code == ExitCode::kOk ? std::cout : std::cerr) << arguments.error().text;
    return to_int(arguments.error().code);
  }
  const Streams streams{std::cin, std::cout, std::cerr, output_screen().colour};
  return to_int(whole_output((*arguments)->run(streams)));
}

}  // namespace
}  // namespace fieldcast::cli

int main(int argc, char** argv) {
  fieldcast::make_writes_fail_not_kill();
  fieldcast::guard_memory();
  try {
    return fieldcast::cli::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "fieldcast: " << error.what() << '\n';
    return to_int(fieldcast::cli::ExitCode::kTrouble);
  }
}
