// The command line of `fieldcast`: which command is to be run, with its options.
#pragma once

#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "tools/cli/command/command.hpp"

namespace fieldcast::cli {

// Not a command to be run: help, the version, or a fault with what is wrong.
struct NoCommand {
  ExitCode code = ExitCode::kOk;
  std::string text;
};

[[nodiscard]] tl::expected<std::unique_ptr<Command>, NoCommand> parse_arguments(
    int argc, const char* const* argv);

}  // namespace fieldcast::cli
