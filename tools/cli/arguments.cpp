#include "tools/cli/arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "core/base/message_text.hpp"

namespace fieldcast::cli {
namespace {

constexpr const char* kExitCodes =
    "exit codes: 0 done, 1 found at fault, 2 usage, 3 no bridge, 4 nothing there, 5 rejected, 6 "
    "failed, 7 expired, 8 no result, "
    "9 failure, 130 interrupted";

// Suggests the nearest command; the library would only report that a command is required.
std::optional<NoCommand> unknown_command(std::string_view word) {
  std::vector<std::string> names;
  for (const CommandRow& entry : commands()) names.emplace_back(entry.name);
  if (word.empty() || word.front() == '-' || std::ranges::find(names, word) != names.end())
    return std::nullopt;
  std::string text = fmt::format("fieldcast: '{}' is no command; ", printable(word));
  if (const auto near = near_miss(word, names); !near.empty())
    return NoCommand{ExitCode::kUsage, fmt::format("{}did you mean {}?\n", text, near)};
  text += "there are";
  for (const auto& name : names) text += ' ' + name;
  return NoCommand{ExitCode::kUsage, text + '\n'};
}

}  // namespace

tl::expected<std::unique_ptr<Command>, NoCommand> parse_arguments(int argc,
                                                                  const char* const* argv) {
  if (argc > 1) {
    if (auto fault = unknown_command(argv[1])) return tl::unexpected(*std::move(fault));
  }
  CommandLine line("fieldcast",
                   "Fieldcast's command line: samples, commands, state and plans of the buses that "
                   "fieldcast-bridge serves.");
  line.set_footer(kExitCodes);
  std::vector<std::unique_ptr<Command>> all;
  for (const CommandRow& entry : commands()) {
    all.push_back(entry.make());
    all.back()->describe(line.command(std::string(entry.name), std::string(entry.summary)));
  }
  if (const auto ended = line.parse(argc, argv)) {
    return tl::unexpected(NoCommand{ended->fault ? ExitCode::kUsage : ExitCode::kOk,
                                    (ended->fault ? "fieldcast: " : "") + ended->text});
  }
  // The parser accepts an option such as --version=false before the command.
  const auto entry = std::ranges::find(commands(), std::string_view(argv[1]), &CommandRow::name);
  if (entry == commands().end())
    return tl::unexpected(NoCommand{
        ExitCode::kUsage, fmt::format("fieldcast: expected a command as the first word, got '{}'\n",
                                      printable(argv[1]))});
  return std::move(all[static_cast<std::size_t>(entry - commands().begin())]);
}

}  // namespace fieldcast::cli
