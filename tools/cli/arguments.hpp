#pragma once

#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "tools/cli/command/base/command.hpp"

namespace fieldcast::cli {

struct NoCommand {
  ExitCode code = ExitCode::kOk;
  std::string text;
};

[[nodiscard]] tl::expected<std::unique_ptr<Command>, NoCommand> parse_arguments(
    int argc, const char* const* argv);

}  // namespace fieldcast::cli
