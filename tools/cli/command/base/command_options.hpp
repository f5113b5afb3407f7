#pragma once

#include <optional>
#include <span>
#include <string>
#include <tl/expected.hpp>
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

// --from and --to: the time span that a command reads from the store.

class SpanOption {
 public:
  void describe(CommandLine& line);
  [[nodiscard]] bool given() const { return !from_.empty() || !to_.empty(); }
  // Default: the last hour. Fails if a text is not a time or the end is not after the start.
  [[nodiscard]] std::optional<CommandLine::Fault> read(TimeSpan& span) const;

 private:
  std::string from_, to_;
};

}  // namespace fieldcast::cli
