#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <type_traits>
#include <vector>

#include "bridge/process/command_line.hpp"
#include "core/model/channel_pattern.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/model/address_notation.hpp"
#include "tools/cli/model/command_text.hpp"

namespace fieldcast::cli {

struct CommandOptions {
  ConnectionOptions connection;
  std::string at;    // address in the PLC's notation; empty: channels
  std::string type;  // type of the values at the address; empty: default of the address
  std::string byte;  // byte of a wider item, for an 8-bit type
  bool json = false;
  Duration timeout = std::chrono::seconds{5};
};

// `verb`: "Read" or "Write to", for the help of --at. REQUIRES: `options` lives until the parse.
void add_command_options(CommandLine& line, CommandOptions& options, const std::string& verb);

struct AddressType {
  std::string text;  // as in --type
  Encoding encoding;
};
// Without --type, the channels of the device may be needed to determine its protocol. The error is
// one line.
[[nodiscard]] tl::expected<AddressType, std::string> address_type(
    const CommandOptions& options, std::span<const KnownChannel> channels = {});

[[nodiscard]] std::vector<KnownChannel> channels_of(const Catalogue& catalogue,
                                                    const ChannelPath& device);

inline constexpr const char* kPatternHelp =
    "BUS/DEVICE/CHANNEL with *; a shorter one matches all below it";

// REQUIRES: `target` lives until the parse.
[[nodiscard]] inline CommandLine::Take pattern_into(Pattern& target) {
  return [&target](const std::string& text) -> std::optional<std::string> {
    auto pattern = Pattern::parse(text);
    if (!pattern) return pattern.error();
    target = *std::move(pattern);
    return std::nullopt;
  };
}

// --from and --to: the time span that a command reads from the store; by default the last hour.
// REQUIRES: `span` lives until the parse.
void add_span(CommandLine& line, TimeSpan& span);
// The span stays empty if neither option is given. `then` runs after the options were parsed.
void add_span(CommandLine& line, std::optional<TimeSpan>& span,
              std::function<std::optional<CommandLine::Fault>()> then);

// Sets `target` if the subcommand `line` is given.
template <typename Value>
void set_when_given(CommandLine& line, Value& target, std::type_identity_t<Value> value) {
  line.when_given([&target, value]() -> std::optional<CommandLine::Fault> {
    target = value;
    return std::nullopt;
  });
}

}  // namespace fieldcast::cli
