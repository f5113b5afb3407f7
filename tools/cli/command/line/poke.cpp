#include "tools/cli/command/line/poke.hpp"

#include <fmt/format.h>

#include <ostream>

#include "core/bus/command/command_job.hpp"
#include "core/model/bus_spec.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/direct/direct_bus.hpp"
#include "tools/cli/direct/line_exchange.hpp"
#include "tools/cli/model/address_notation.hpp"
#include "tools/cli/model/command_text.hpp"
#include "tools/cli/model/sample_text.hpp"

namespace fieldcast::cli {
namespace {

struct Write {
  std::string at, type;
  Encoding encoding;
  std::vector<Value> values;
};

// "holding:100=7", "holding:100=7,8,9"; a string is everything behind '='.
tl::expected<Write, std::string> write_of(const std::string& assignment, const std::string& type,
                                          const Protocol& protocol) {
  const auto equals = assignment.find('=');
  if (equals == 0 || equals == std::string::npos)
    return tl::unexpected(fmt::format("'{}' is not ADDRESS=VALUE", printable(assignment)));
  Write write{assignment.substr(0, equals), {}};
  if (const auto parsed = protocol.parse_address(write.at); !parsed)
    return tl::unexpected(fmt::format("{}: {}; allowed: {}", printable(write.at),
                                      parsed.error().what, parsed.error().allowed));
  auto implied = type_at(write.at, type, protocol);
  if (!implied) return tl::unexpected(std::move(implied.error()));
  write.type = *std::move(implied);
  const auto encoding = parse_type(write.type);
  if (!encoding) return tl::unexpected(encoding.error());
  write.encoding = *encoding;
  std::string_view rest = std::string_view(assignment).substr(equals + 1);
  while (true) {
    const auto comma = write.encoding.is_text() ? std::string_view::npos : rest.find(',');
    auto value = value_from_text(write.encoding, rest.substr(0, comma));
    if (!value)
      return tl::unexpected(fmt::format("{}: {}", printable(write.at), value.error().text));
    write.values.push_back(*std::move(value));
    if (comma == std::string_view::npos) return write;
    rest.remove_prefix(comma + 1);
  }
}

std::string values_text(const std::vector<Value>& values, const std::string& type) {
  std::string text;
  for (const Value& value : values) text += (text.empty() ? "" : ", ") + value_text(value, type);
  return text;
}

void show(const PokeOptions& options, const Write& write, const CommandResult& result,
          const Streams& to) {
  if (options.json) {
    Json json{{"address", write.at},
              {"state", to_text(result.state)},
              {"cause", to_name(result.cause)},
              {"device_code", result.device_code},
              {"reason", result.reason},
              {"values", result.values}};
    to.out << json.text() << '\n';
  }
  std::string line = fmt::format("{} = {}: {}", write.at, values_text(write.values, write.type),
                                 to_text(result.state));
  if (!result.reason.empty()) line += ": " + result.reason;
  if (!result.values.empty())
    line += fmt::format(" (read back {})", values_text(result.values, write.type));
  const bool done = result.state == CommandState::kDone || result.state == CommandState::kVerified;
  if (!options.json || !done) (done ? to.out : to.err) << printable(line) << '\n';
  to.out.flush();
}

fieldcast::Command command_of(const Write& write, bool verify) {
  fieldcast::Command command;
  command.device = "device";
  command.target = AddressTarget{write.at, write.encoding};
  command.values = write.values;
  command.count = static_cast<std::uint32_t>(write.values.size());
  command.verify = verify;
  return command;
}

// Prints the first write that the bus would refuse without a request.
bool refuses_any(const PokeOptions& options, const std::vector<Write>& writes,
                 const DeviceSpec& device, const Protocol& protocol, const Streams& to) {
  for (const Write& write : writes) {
    const auto job = CommandJob::make(command_of(write, options.verify), device, 0, 0, protocol,
                                      plain_text_codec());
    if (job) continue;
    CommandResult result;
    result.state = CommandState::kRejected;
    result.cause = job.error().cause;
    result.reason = job.error().reason;
    if (writes.size() > 1) result.reason += "; nothing is written";
    show(options, write, result, to);
    return true;
  }
  return false;
}

}  // namespace

ExitCode poke(const PokeOptions& options, const Interrupt& interrupt, const Streams& to) {
  const auto named = named_protocol(protocol_of(options.line), "poke", to.err);
  if (!named) return ExitCode::kUsage;
  const auto bus = bus_of(options.line, *named);
  if (!bus) return usage_fault(to.err, "poke", bus.error());
  const auto protocol = *make_protocol(bus->devices.front(), line_of(bus->port));
  std::vector<Write> writes;
  for (const std::string& assignment : options.assignments) {
    auto write = write_of(assignment, options.type, *protocol);
    if (!write) return usage_fault(to.err, "poke", write.error());
    writes.push_back(*std::move(write));
  }
  if (refuses_any(options, writes, bus->devices.front(), *protocol, to)) return ExitCode::kRejected;
  const DirectRun run{"poke", *bus, options.capture, options.trace};
  return on_direct_bus(run, interrupt, to.err, [&](DirectBus& line) {
    for (const Write& write : writes) {
      const auto result = line.run(command_of(write, options.verify), interrupt);
      if (!result) {
        to.err << "fieldcast poke: interrupted; whether " << printable(write.at)
               << " was written is not known\n";
        return ExitCode::kInterrupted;
      }
      show(options, write, *result, to);
      if (result->state == CommandState::kRejected) return ExitCode::kRejected;
      if (result->state == CommandState::kFailed) return ExitCode::kFailed;
    }
    return ExitCode::kOk;
  });
}

namespace {

void describe_poke(CommandLine& line, PokeOptions& options) {
  add_line_options(line, options.line);
  line.texts("ASSIGNMENT", options.assignments,
             "holding:100=7; further values of the items behind it with commas")
      .required();
  line.text("--type", options.type,
            "Of the values: uint16, float32, string(8), .. (what the address implies)");
  line.flag("--verify", options.verify, "Read back what was written");
  line.flag("--trace", options.trace, "The bytes on the line, as they pass");
  line.text("--capture", options.capture, kCaptureHelp);
  line.flag("--json", options.json, "JSON lines").excludes("--trace");
}

}  // namespace

CommandRow poke_command() {
  return command_row("poke", "Write to a line; needs no bridge and no configuration", describe_poke,
                     interruptible(poke));
}

}  // namespace fieldcast::cli
