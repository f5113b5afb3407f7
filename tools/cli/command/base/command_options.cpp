#include "tools/cli/command/base/command_options.hpp"

#include <memory>
#include <utility>

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
    const bool calculated = channel.at.starts_with('=');  // without an address
    if (path.bus == device.bus && path.device == device.device && !calculated)
      channels.push_back({channel.at, channel.type});
  }
  return channels;
}

namespace {

struct SpanText {
  std::string from, to;
  [[nodiscard]] bool given() const { return !from.empty() || !to.empty(); }
};

std::shared_ptr<const SpanText> add_span_text(CommandLine& line) {
  auto text = std::make_shared<SpanText>();
  line.text("--from", text->from, "2026-11-21T10:30 (UTC), or 2h, 3d for so long ago (1h)");
  line.text("--to", text->to, "The same (now)");
  return text;
}

std::optional<CommandLine::Fault> read_span(const SpanText& text, TimeSpan& span) {
  const UtcTime now = utc_now();
  span = {{now.nanoseconds - Duration(std::chrono::hours{1}).count()}, now};
  const auto read = [&](const char* option, const std::string& given,
                        UtcTime& time) -> std::optional<CommandLine::Fault> {
    if (given.empty()) return std::nullopt;
    const auto parsed = parse_time(given, now);
    if (!parsed) return CommandLine::Fault{option, parsed.error()};
    time = *parsed;
    return std::nullopt;
  };
  if (auto fault = read("--from", text.from, span.from)) return fault;
  if (auto fault = read("--to", text.to, span.to)) return fault;
  if (span.to <= span.from) return CommandLine::Fault{"--to", "the end is not after the beginning"};
  return std::nullopt;
}

}  // namespace

void add_span(CommandLine& line, TimeSpan& span) {
  line.when_given([text = add_span_text(line), &span] { return read_span(*text, span); });
}

void add_span(CommandLine& line, std::optional<TimeSpan>& span,
              std::function<std::optional<CommandLine::Fault>()> then) {
  line.when_given([text = add_span_text(line), &span, then = std::move(then)] {
    auto fault = text->given() ? read_span(*text, span.emplace()) : std::nullopt;
    return fault ? fault : then();
  });
}

}  // namespace fieldcast::cli
