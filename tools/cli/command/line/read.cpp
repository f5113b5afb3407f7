#include "tools/cli/command/line/read.hpp"

#include <fmt/format.h>

#include <ostream>

#include "core/model/bus_spec.hpp"
#include "core/model/fit.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/direct/direct_bus.hpp"
#include "tools/cli/direct/line_exchange.hpp"
#include "tools/cli/direct/meanings.hpp"
#include "tools/cli/model/address_notation.hpp"
#include "tools/cli/model/command_text.hpp"
#include "tools/cli/model/sample_text.hpp"

namespace fieldcast::cli {
namespace {

struct Part {
  std::string at;
  std::uint32_t values = 1;
};
struct Wanted {
  std::string at, type;
  Encoding encoding;
  unsigned item_bits = 16;
  std::uint32_t value_items = 1;
  std::vector<Part> parts;
};

// With `as`, reads the raw items.
tl::expected<Wanted, std::string> wanted_at(const ReadOptions& options, const Protocol& protocol,
                                            const std::string& at) {
  const auto parsed = protocol.parse_address(at);
  if (!parsed) {
    const AddressFault& fault = parsed.error();
    return tl::unexpected(fmt::format("{}: {}; {}", printable(at), fault.what,
                                      fault.suggestion.empty()
                                          ? "allowed: " + fault.allowed
                                          : "did you mean " + fault.suggestion + '?'));
  }
  Wanted wanted{at, {}};
  wanted.item_bits = protocol.areas()[parsed->area].item_bits;
  if (!options.as.empty()) {
    if (parsed->bit || (wanted.item_bits != 8 && wanted.item_bits != 16))
      return tl::unexpected(fmt::format("{}: --as is for registers and bytes", printable(at)));
    wanted.type = wanted.item_bits == 8 ? "uint8" : "uint16";
  } else {
    auto type = type_at(at, options.type, protocol);
    if (!type) return tl::unexpected(std::move(type.error()));
    wanted.type = *std::move(type);
  }
  const auto encoding = parse_type(wanted.type);
  if (!encoding) return tl::unexpected(encoding.error());
  wanted.encoding = *encoding;
  wanted.encoding = with_form_of(*parsed, wanted.encoding);
  wanted.value_items = item_count(wanted.encoding, wanted.item_bits);
  const Area& area = protocol.areas()[parsed->area];
  if (!parsed->bit && options.count > 1 && is_field(*parsed))
    return tl::unexpected(
        fmt::format("{} is one value; --count is for what has neighbours", printable(at)));
  if (!parsed->bit &&
      parsed->first + std::uint64_t{options.count} * wanted.value_items > area.items)
    return tl::unexpected(
        fmt::format("{}: with {} values it reaches beyond the end of {}; there is "
                    "room for {}",
                    printable(at), options.count, area.name,
                    (area.items - parsed->first) / wanted.value_items));
  std::uint32_t left = options.count, items = 0;
  // The engine counts bits of a word itself.
  const std::uint32_t most =
      parsed->bit ? left : values_in_request(protocol, *parsed, wanted.value_items);
  while (left > 0) {
    const std::uint32_t values = std::min(left, most);
    auto part = address_behind(protocol, at, items);
    if (!part)
      return tl::unexpected(fmt::format(
          "{}: one request reads {} of these values; ask for the rest apart", printable(at), most));
    wanted.parts.push_back({*std::move(part), values});
    left -= values;
    items += values * wanted.value_items;
  }
  return wanted;
}

Json values_json(const Wanted& wanted, const std::vector<Value>& values) {
  return {{"address", wanted.at}, {"type", wanted.type}, {"values", values}};
}

class Reading {
 public:
  Reading(const ReadOptions& options, std::unique_ptr<Protocol> protocol, DirectBus& bus,
          const Streams& to)
      : options_(options), protocol_(std::move(protocol)), bus_(bus), to_(to) {}

  ExitCode read(const Wanted& wanted, std::span<const Meaning> meanings,
                const Interrupt& interrupt) {
    std::vector<Value> values;
    for (const Part& part : wanted.parts) {
      fieldcast::Command command;
      command.device = "device";
      command.target = AddressTarget{part.at, wanted.encoding};
      command.operation = Operation::kAcquire;
      command.count = part.values;
      const auto result = bus_.run(std::move(command), interrupt);
      if (!result) return ExitCode::kInterrupted;
      if (result->state != CommandState::kDone) return failed(part, *result);
      values.insert(values.end(), result->values.begin(), result->values.end());
    }
    if (!meanings.empty())
      show_meanings(wanted, values, meanings);
    else if (options_.json)
      to_.out << values_json(wanted, values).text() << '\n';
    else
      show(wanted, values);
    to_.out.flush();
    return ExitCode::kOk;
  }

 private:
  ExitCode failed(const Part& part, const CommandResult& result) {
    if (options_.json) {
      to_.out << Json{{"address", part.at},
                      {"cause", to_name(result.cause)},
                      {"device_code", result.device_code},
                      {"reason", result.reason}}
                     .text()
              << '\n';
      to_.out.flush();
    }
    to_.err << printable(fmt::format("{}: {}", part.at, result.reason)) << '\n';
    return result.state == CommandState::kRejected ? ExitCode::kRejected : ExitCode::kFailed;
  }

  [[nodiscard]] std::string address_of(const Wanted& wanted, std::size_t value) const {
    const auto items = static_cast<std::uint32_t>(value * wanted.value_items);
    const auto at = address_behind(*protocol_, wanted.at, items);
    return at ? *at : fmt::format("{} + {}", wanted.at, value);
  }
  void show(const Wanted& wanted, const std::vector<Value>& values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      to_.out << printable(fmt::format("{} = {}", address_of(wanted, i),
                                       value_text(values[i], wanted.type)))
              << '\n';
  }
  void show_meanings(const Wanted& wanted, const std::vector<Value>& values,
                     std::span<const Meaning> meanings) {
    Bytes image;
    std::vector<std::string> addresses;
    for (const Value& value : values) {
      addresses.push_back(address_of(wanted, addresses.size()));
      if (const auto item = encode_value(wanted.encoding, wanted.item_bits, value))
        append(image, *item);
    }
    print(to_.out, meaning_lines(addresses, wanted.item_bits, image, meanings, to_.wide_screen()));
  }

  const ReadOptions& options_;
  const std::unique_ptr<Protocol> protocol_;
  DirectBus& bus_;
  const Streams& to_;
};

}  // namespace

ExitCode read(const ReadOptions& options, const Interrupt& interrupt, const Streams& to) {
  const auto named = named_protocol(protocol_of(options.line), "read", to.err);
  if (!named) return ExitCode::kUsage;
  const auto bus = bus_of(options.line, *named);
  if (!bus) return usage_fault(to.err, "read", bus.error());
  auto protocol = *make_protocol(bus->devices.front(), line_of(bus->port));
  std::vector<Meaning> meanings;
  if (!options.as.empty()) {
    auto named_meanings = meanings_of(options.as);
    if (!named_meanings) return usage_fault(to.err, "read", named_meanings.error());
    meanings = *std::move(named_meanings);
  }
  std::vector<Wanted> all;
  for (const std::string& at : options.addresses) {
    auto wanted = wanted_at(options, *protocol, at);
    if (!wanted) return usage_fault(to.err, "read", wanted.error());
    all.push_back(*std::move(wanted));
  }
  const DirectRun run{"read", *bus, options.capture, options.trace};
  return on_direct_bus(run, interrupt, to.err, [&](DirectBus& line) {
    Reading reading(options, std::move(protocol), line, to);
    ExitCode worst = ExitCode::kOk;
    for (const Wanted& wanted : all) {
      const ExitCode code = reading.read(wanted, meanings, interrupt);
      if (code == ExitCode::kInterrupted) return code;
      if (code != ExitCode::kOk) worst = code;
    }
    return worst;
  });
}

namespace {

void describe_read(CommandLine& line, ReadOptions& options) {
  add_line_options(line, options.line);
  line.texts("ADDRESS", options.addresses, "In the PLC's own notation: holding:100, DM10, VW4")
      .required();
  line.number("--count", options.count, 1, kMaxRawValues,
              "Values at each address, one behind the other (1)");
  line.text("--type", options.type,
            "Of the values: uint16, float32, string(8), .. (what the address implies)");
  line.text("--as", options.as,
            "What the items mean: types with commas (float32,int32), each in every order, or all")
      .excludes("--type");
  line.flag("--trace", options.trace, "The bytes on the line, as they pass");
  line.text("--capture", options.capture, kCaptureHelp);
  line.flag("--json", options.json, "JSON lines").excludes("--trace").excludes("--as");
}

}  // namespace

CommandRow read_command() {
  return command_row("read", "Read from a line; needs no bridge and no configuration",
                     describe_read, interruptible(read));
}

}  // namespace fieldcast::cli
