// A program's command line: options and subcommands that fill variables of the caller. CLI11 does
// the work; only command_line.cpp includes it.
//
// Describe everything, then call parse() once. The variables must live until then. Main thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "core/base/duration_text.hpp"

namespace fieldcast {

class CommandLine {
 public:
  CommandLine(const std::string& name, const std::string& description);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  // An option or an argument that was described; refers to the CommandLine.
  class Option {
   public:
    const Option& required() const;
    const Option& show_default() const;   // in the help: the present value of its variable
    const Option& existing_file() const;  // its text must name a file that is there
    const Option& needs(std::string_view other) const;
    const Option& excludes(std::string_view other) const;
    const Option& one_each() const;  // of texts: one behind each name, which may be said again

   private:
    friend class CommandLine;
    Option(CommandLine& owner, void* option) : owner_(&owner), option_(option) {}
    CommandLine* owner_;
    void* option_;  // CLI::Option
  };

  // `names`: "--json", or "PATTERN" for an argument that has no name on the command line.
  Option flag(const std::string& names, bool& target, const std::string& help);
  Option text(const std::string& names, std::string& target, const std::string& help);
  Option texts(const std::string& names, std::vector<std::string>& target, const std::string& help);
  Option number(const std::string& names, std::uint64_t& target, const std::string& help);
  Option number(const std::string& names, std::uint32_t& target, std::uint32_t least,
                std::uint32_t most, const std::string& help);
  Option number(const std::string& names, std::optional<std::uint32_t>& target, std::uint32_t least,
                std::uint32_t most, const std::string& help);
  // A number without a unit is seconds, as scripts have it.
  Option duration(const std::string& names, Duration& target, Duration least,
                  const std::string& help);
  Option duration(const std::string& names, std::optional<Duration>& target, Duration least,
                  const std::string& help);
  // Any other value: `take` says what is wrong with a text, or nothing.
  using Take = std::function<std::optional<std::string>(const std::string& text)>;
  Option value(const std::string& names, Take take, const std::string& help);

  // A subcommand; lives as long as this one. The first one makes a subcommand necessary.
  CommandLine& command(const std::string& name, const std::string& description);
  // Without one of its subcommands it has a meaning too. After the last command().
  void make_commands_optional();
  // Runs after the options were read, if this (sub)command was given. A fault ends the parse.
  struct Fault {
    std::string option, what;
  };
  void when_given(std::function<std::optional<Fault>()> check);

  void set_footer(const std::string& text);

  // What there is to say instead of a run: help and version (not a fault), or what is wrong.
  struct Ended {
    bool fault = false;
    std::string text;
  };
  [[nodiscard]] std::optional<Ended> parse(int argc, const char* const* argv);

  // The longest duration that an option takes.
  static constexpr Duration kLongest = std::chrono::hours{24 * 365};
  // The shortest that is not 0.
  static constexpr Duration kShortest = std::chrono::microseconds{1};

 private:
  struct State;
  explicit CommandLine(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast
