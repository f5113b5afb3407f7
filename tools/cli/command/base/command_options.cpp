#include "tools/cli/command/base/command_options.hpp"

#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/terminal/interrupt.hpp"

namespace fieldcast::cli {

void add_command_options(CommandLine& line, CommandOptions& options, const std::string& verb) {
  line.text("--at", options.at,
            verb + " an address of the device, in the PLC's own notation (holding:100)");
  line.text("--type", options.type,
            "Type of the values at the address: uint16, float32, string(8), .. (what the address "
            "implies: bool for a coil, uint16 for holding:100)")
      .needs("--at");
  line.text("--byte", options.byte, "With an 8-bit type: low or high byte of a register")
      .needs("--at");
  line.duration("--timeout", options.timeout, CommandLine::kShortest,
                "The command is not started later than this (5s)");
  line.flag("--json", options.json, "JSON lines");
  add_connection(line, options.connection);
}

tl::expected<AddressType, std::string> address_type(const CommandOptions& options,
                                                    std::span<const KnownChannel> channels) {
  return type_at(options.at, options.type, channels).and_then([&](std::string text) {
    return parse_type(text)
        .and_then([&](const Encoding& parsed) { return with_byte(parsed, options.byte); })
        .map([&](const Encoding& encoding) {
          return AddressType{std::move(text), encoding};
        });
  });
}

std::vector<KnownChannel> channels_of(const Catalogue& catalogue, const ChannelPath& device) {
  std::vector<KnownChannel> channels;
  for (const auto& [path, channel] : catalogue.channels()) {
    if (path.bus == device.bus && path.device == device.device)
      channels.push_back({channel.at, channel.type});
  }
  return channels;
}

void SpanOption::describe(CommandLine& line) {
  line.text("--from", from_, "2026-11-21T10:30 (UTC), or 2h, 3d for so long ago (1h)");
  line.text("--to", to_, "The same (now)");
}

std::optional<CommandLine::Fault> SpanOption::read(TimeSpan& span) const {
  const UtcTime now = utc_now();
  span = {{now.nanoseconds - Duration(std::chrono::hours{1}).count()}, now};
  if (!from_.empty()) {
    const auto from = parse_time(from_, now);
    if (!from) return CommandLine::Fault{"--from", from.error()};
    span.from = *from;
  }
  if (!to_.empty()) {
    const auto to = parse_time(to_, now);
    if (!to) return CommandLine::Fault{"--to", to.error()};
    span.to = *to;
  }
  if (span.to <= span.from) return CommandLine::Fault{"--to", "the end is not after the beginning"};
  return std::nullopt;
}

}  // namespace fieldcast::cli
