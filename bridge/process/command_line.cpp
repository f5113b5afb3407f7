#include "bridge/process/command_line.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <sstream>

#include "core/base/message_text.hpp"

namespace fieldcast {

struct CommandLine::State {
  std::unique_ptr<CLI::App> root;  // null for a subcommand
  CLI::App* app = nullptr;
  std::vector<std::unique_ptr<CommandLine>> commands;
};

namespace {

CLI::Option* as_option(void* option) { return static_cast<CLI::Option*>(option); }

}  // namespace

const CommandLine::Option& CommandLine::Option::required() const {
  as_option(option_)->required();
  return *this;
}
const CommandLine::Option& CommandLine::Option::show_default() const {
  as_option(option_)->capture_default_str();
  return *this;
}
const CommandLine::Option& CommandLine::Option::existing_file() const {
  as_option(option_)->check(CLI::ExistingFile);
  return *this;
}
const CommandLine::Option& CommandLine::Option::needs(std::string_view other) const {
  as_option(option_)->needs(owner_->state_->app->get_option(std::string(other)));
  return *this;
}
const CommandLine::Option& CommandLine::Option::excludes(std::string_view other) const {
  as_option(option_)->excludes(owner_->state_->app->get_option(std::string(other)));
  return *this;
}
const CommandLine::Option& CommandLine::Option::one_each() const {
  as_option(option_)->allow_extra_args(false);
  return *this;
}

CommandLine::CommandLine(const std::string& name, const std::string& description)
    : state_(std::make_unique<State>()) {
  state_->root = std::make_unique<CLI::App>(description, name);
  state_->app = state_->root.get();
  state_->app->set_version_flag("--version", name + " " + FIELDCAST_VERSION);
}
CommandLine::CommandLine(std::unique_ptr<State> state) : state_(std::move(state)) {}
CommandLine::~CommandLine() = default;

CommandLine::Option CommandLine::flag(const std::string& names, bool& target,
                                      const std::string& help) {
  return {*this, state_->app->add_flag(names, target, help)};
}
CommandLine::Option CommandLine::text(const std::string& names, std::string& target,
                                      const std::string& help) {
  return {*this, state_->app->add_option(names, target, help)};
}
CommandLine::Option CommandLine::texts(const std::string& names, std::vector<std::string>& target,
                                       const std::string& help) {
  return {*this, state_->app->add_option(names, target, help)};
}
CommandLine::Option CommandLine::number(const std::string& names, std::uint64_t& target,
                                        const std::string& help) {
  return {*this, state_->app->add_option(names, target, help)};
}
CommandLine::Option CommandLine::number(const std::string& names, std::uint32_t& target,
                                        std::uint32_t least, std::uint32_t most,
                                        const std::string& help) {
  return {*this, state_->app->add_option(names, target, help)->check(CLI::Range(least, most))};
}
CommandLine::Option CommandLine::number(const std::string& names,
                                        std::optional<std::uint32_t>& target, std::uint32_t least,
                                        std::uint32_t most, const std::string& help) {
  return {*this, state_->app->add_option(names, target, help)->check(CLI::Range(least, most))};
}

CommandLine::Option CommandLine::value(const std::string& names, Take take,
                                       const std::string& help) {
  const auto parse = [names, take = std::move(take)](const std::string& text) {
    if (const auto fault = take(text)) throw CLI::ValidationError(names, *fault);
  };
  return {*this, state_->app->add_option_function<std::string>(names, parse, help)};
}

namespace {

template <typename Target>
CommandLine::Take duration_into(Target& target, Duration least) {
  return [&target, least](const std::string& text) -> std::optional<std::string> {
    const auto time = read_duration(text, {least, CommandLine::kLongest, true});
    if (!time) return fault_text(escaped(text), time.error());
    target = *time;
    return std::nullopt;
  };
}

}  // namespace

CommandLine::Option CommandLine::duration(const std::string& names, Duration& target,
                                          Duration least, const std::string& help) {
  return value(names, duration_into(target, least), help);
}
CommandLine::Option CommandLine::duration(const std::string& names, std::optional<Duration>& target,
                                          Duration least, const std::string& help) {
  return value(names, duration_into(target, least), help);
}

CommandLine& CommandLine::command(const std::string& name, const std::string& description) {
  auto state = std::make_unique<State>();
  state->app = state_->app->add_subcommand(name, description);
  state_->app->require_subcommand(1);
  state_->commands.push_back(std::unique_ptr<CommandLine>(new CommandLine(std::move(state))));
  return *state_->commands.back();
}

void CommandLine::make_commands_optional() {
  state_->app->require_subcommand(0, 1);
  for (const auto& command : state_->commands) {
    command->state_->app->preparse_callback([parent = state_->app](std::size_t) {
      for (CLI::Option* option : parent->get_options()) option->required(false);
    });
  }
}

void CommandLine::when_given(std::function<std::optional<Fault>()> check) {
  state_->app->callback([check = std::move(check)] {
    if (const auto fault = check()) throw CLI::ValidationError(fault->option, fault->what);
  });
}

void CommandLine::set_footer(const std::string& text) { state_->app->footer(text); }

std::optional<CommandLine::Ended> CommandLine::parse(int argc, const char* const* argv) {
  try {
    state_->app->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream out;
    std::ostringstream err;
    const bool asked = state_->app->exit(error, out, err) == 0;  // help and version have code 0
    return Ended{!asked, asked ? out.str() : err.str()};
  }
  return std::nullopt;
}

std::optional<bool> CommandLine::parse_or_print(int argc, const char* const* argv) {
  const auto ended = parse(argc, argv);
  if (!ended) return std::nullopt;
  std::fputs(ended->text.c_str(), ended->fault ? stderr : stdout);
  return ended->fault;
}

}  // namespace fieldcast
