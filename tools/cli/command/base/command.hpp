// A subcommand of `fieldcast`, with its own file here and an entry in registry.cpp. Main thread.
#pragma once

#include <iosfwd>
#include <memory>
#include <span>
#include <string_view>

#include "bridge/process/command_line.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

struct Streams {
  std::istream& in;
  std::ostream& out;
  std::ostream& err;
  bool colour = false;  // `out` is a terminal with colours
  // For text printed once: not truncated, the terminal wraps it.
  [[nodiscard]] Screen wide_screen() const { return {0, 0, colour}; }
};

// Prints "fieldcast scan: FAULT" to `err`.
ExitCode usage_fault(std::ostream& err, std::string_view command, std::string_view fault);

class Command {
 public:
  virtual ~Command() = default;
  // Called once, before the command line is parsed.
  virtual void describe(CommandLine& line) = 0;
  // May throw DdsError or StoreError.
  [[nodiscard]] virtual ExitCode run(const Streams& streams) = 0;
};

// Gives tests access to the parsed options.
template <typename Options>
class CommandWith : public Command {
 public:
  [[nodiscard]] const Options& options() const { return options_; }

 protected:
  Options options_;
};

struct CommandEntry {
  std::string_view name;     // "watch"
  std::string_view summary;  // one human-readable line
  std::unique_ptr<Command> (*make)() = nullptr;
};

// In the order of the help.
[[nodiscard]] std::span<const CommandEntry> commands();

template <typename C>
[[nodiscard]] std::unique_ptr<Command> make_command() {
  return std::make_unique<C>();
}

}  // namespace fieldcast::cli
