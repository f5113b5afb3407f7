// Command line of a program: options and subcommands that fill the caller's variables. Add all,
// then call parse() once. Main thread. Only command_line.cpp includes CLI11.
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

  // An option or argument that was added. Valid as long as the CommandLine.
  class Option {
   public:
    const Option& required() const;
    const Option& show_default() const;  // shows the present value of the variable in the help
    const Option& existing_file() const;
    const Option& needs(std::string_view other) const;
    const Option& excludes(std::string_view other) const;
    // For texts: one value after each name; the name may be repeated.
    const Option& one_each() const;

   private:
    friend class CommandLine;
    Option(CommandLine& owner, void* option) : owner_(&owner), option_(option) {}
    CommandLine* owner_;
    void* option_;
  };

  // `names`: "--json", or "PATTERN" for a positional argument.
  Option flag(const std::string& names, bool& target, const std::string& help);
  Option text(const std::string& names, std::string& target, const std::string& help);
  Option texts(const std::string& names, std::vector<std::string>& target, const std::string& help);
  Option number(const std::string& names, std::uint64_t& target, const std::string& help);
  Option number(const std::string& names, std::uint32_t& target, std::uint32_t least,
                std::uint32_t most, const std::string& help);
  Option number(const std::string& names, std::optional<std::uint32_t>& target, std::uint32_t least,
                std::uint32_t most, const std::string& help);
  // A number without a unit means seconds, as in scripts.
  Option duration(const std::string& names, Duration& target, Duration least,
                  const std::string& help);
  Option duration(const std::string& names, std::optional<Duration>& target, Duration least,
                  const std::string& help);
  // An option of any other type: `take` returns the error of a text, or `std::nullopt`.
  using Take = std::function<std::optional<std::string>(const std::string& text)>;
  Option value(const std::string& names, Take take, const std::string& help);

  // Adds a subcommand, which lives as long as this object. One of them is then required.
  CommandLine& command(const std::string& name, const std::string& description);
  // Allows a call without a subcommand. The required options of this command are required only in
  // such a call. Call it after the last command().
  void make_commands_optional();
  // Called after the options were parsed, if this (sub)command was given. A fault ends the parse.
  struct Fault {
    std::string option, what;
  };
  void when_given(std::function<std::optional<Fault>()> check);

  void set_footer(const std::string& text);

  // Text to print instead of a run: help or version (no fault), or the error.
  struct Ended {
    bool fault = false;
    std::string text;
  };
  [[nodiscard]] std::optional<Ended> parse(int argc, const char* const* argv);
  // Prints the text of parse(), an error to standard error. Returns whether it was an error.
  [[nodiscard]] std::optional<bool> parse_or_print(int argc, const char* const* argv);

  static constexpr Duration kLongest = std::chrono::hours{24 * 365};
  static constexpr Duration kShortest = std::chrono::microseconds{1};

 private:
  struct State;
  explicit CommandLine(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast
