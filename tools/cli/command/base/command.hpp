// A subcommand of `fieldcast`: one file with its options, its function and its row, and its name in
// registry.cpp. Help, completion and manual pages are made from the row. Main thread.
#pragma once

#include <functional>
#include <iosfwd>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

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

ExitCode usage_fault(std::ostream& err, std::string_view command, std::string_view fault);

class Command {
 public:
  virtual ~Command() = default;
  // Called once, before the command line is parsed.
  virtual void describe(CommandLine& line) = 0;
  // May throw DdsError or StoreError.
  [[nodiscard]] virtual ExitCode run(const Streams& to) = 0;
};

template <typename Options>
using RunCommand = std::function<ExitCode(const Options& options, const Streams& to)>;

template <typename Options>
class CommandWith final : public Command {
 public:
  using Describe = void (*)(CommandLine& line, Options& options);
  CommandWith(Describe add_options, RunCommand<Options> run)
      : add_options_(add_options), run_(std::move(run)) {}

  void describe(CommandLine& line) override { add_options_(line, options_); }
  [[nodiscard]] ExitCode run(const Streams& to) override { return run_(options_, to); }
  [[nodiscard]] const Options& options() const { return options_; }

 private:
  Options options_;
  Describe add_options_;
  RunCommand<Options> run_;
};

struct CommandRow {
  std::string_view name;     // "watch"
  std::string_view summary;  // one human-readable line
  std::function<std::unique_ptr<Command>()> make;
};

template <typename Options>
[[nodiscard]] CommandRow command_row(std::string_view name, std::string_view summary,
                                     void (*add_options)(CommandLine& line, Options& options),
                                     std::type_identity_t<RunCommand<Options>> run) {
  return {name, summary, [=] { return std::make_unique<CommandWith<Options>>(add_options, run); }};
}

// Each is defined in the file of its command.
CommandRow watch_command(), write_command(), acquire_command(), status_command(),
    sessions_command(), plan_command(), inspect_command(), scan_command(), read_command(),
    poke_command(), replay_command(), sim_check_command(), history_command(), devices_command(),
    audit_command(), user_command(), token_command(), alarms_command(), doctor_command(),
    secure_command(), standby_command(), module_command(), import_command(), capture_command(),
    health_command();

[[nodiscard]] std::span<const CommandRow> commands();

}  // namespace fieldcast::cli
