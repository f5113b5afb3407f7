#include "tools/cli/model/command_text.hpp"

#include <fmt/format.h>

#include "core/codec/value_codec.hpp"
#include "tools/cli/model/address_notation.hpp"
#include "tools/cli/model/sample_text.hpp"

namespace fieldcast::cli {
namespace {

constexpr std::size_t kValuesShown = 16;

std::string values_text(const std::vector<Value>& values, const std::string& type) {
  std::string text;
  for (std::size_t i = 0; i < values.size() && i < kValuesShown; ++i)
    text += (i == 0 ? "" : " ") + value_text(values[i], type);
  return values.size() > kValuesShown
             ? fmt::format("{} .. ({} values, all with --json)", text, values.size())
             : text;
}

std::string_view state_text(const Outcome& outcome) {
  switch (outcome.state) {
    case Outcome::State::kResult: return to_text(outcome.result.state);
    case Outcome::State::kRefusedHere: return to_text(CommandState::kRejected);
    case Outcome::State::kNoResult: return "no-answer";
    case Outcome::State::kNotSent: return "not-sent";
  }
  return "?";
}

std::string took_text(const StationResult& result) {
  const auto took = result.completed_at.nanoseconds - result.received_at.nanoseconds;
  return fmt::format("{:.1f} ms", static_cast<double>(took) / 1e6);
}

}  // namespace

tl::expected<Assignment, std::string> Assignment::parse(std::string_view text) {
  const auto equals = text.find('=');
  if (equals == std::string_view::npos) {
    return tl::unexpected(fmt::format("'{}' sets nothing; write BUS/DEVICE/CHANNEL=VALUE", text));
  }
  auto path = ChannelPath::parse(text.substr(0, equals));
  if (!path) return tl::unexpected(path.error());
  return Assignment{*std::move(path), std::string(text.substr(equals + 1))};
}

tl::expected<ChannelPath, std::string> parse_device_or_channel(std::string_view text) {
  const auto slash = text.find('/');
  if (slash != std::string_view::npos && text.find('/', slash + 1) == std::string_view::npos &&
      slash > 0 && slash + 1 < text.size()) {
    return ChannelPath{std::string(text.substr(0, slash)), std::string(text.substr(slash + 1)), {}};
  }
  if (auto path = ChannelPath::parse(text)) return path;
  return tl::unexpected(fmt::format("'{}' is neither BUS/DEVICE nor BUS/DEVICE/CHANNEL", text));
}

tl::expected<Encoding, std::string> parse_type(std::string_view text) {
  if (auto encoding = encoding_from(text)) return *std::move(encoding);
  return tl::unexpected(fmt::format("type '{}' is unknown; there are {}", text, allowed_types()));
}

tl::expected<Encoding, std::string> with_byte(Encoding encoding, std::string_view byte) {
  if (byte.empty()) return encoding;
  constexpr std::string_view kDigits = "01234567";
  const std::size_t at = byte == "low"      ? 0
                         : byte == "high"   ? 1
                         : byte.size() == 1 ? kDigits.find(byte[0])
                                            : std::string_view::npos;
  if (at == std::string_view::npos)
    return tl::unexpected(fmt::format("byte '{}' is unknown; low, high, 0 to 7", byte));
  encoding.bit = static_cast<std::uint8_t>(8 * at);
  return encoding;
}

tl::expected<Value, ValueFault> value_from_text(const Encoding& encoding, std::string_view text) {
  const auto parsed = [&](ValueType type) { return parse_value(Encoding{type}, text); };
  if (encoding.type == ValueType::kString) return Value{std::string(text)};
  if (encoding.type == ValueType::kBool) {
    if (const auto value = parsed(ValueType::kBool)) return *value;
    return tl::unexpected(
        ValueFault{Cause::kWrongType,
                   fmt::format("'{}' is no bool; write true or false, on or off, 1 or 0", text)});
  }
  const bool real = encoding.type == ValueType::kFloat32 || encoding.type == ValueType::kFloat64;
  if (!real) {
    for (const auto type : {ValueType::kInt64, ValueType::kUint64}) {
      if (const auto value = parsed(type)) return *value;
    }
  }
  const auto value = parsed(ValueType::kFloat64);
  if (value) return *value;
  if (value.error() == Cause::kRange)
    return tl::unexpected(
        ValueFault{Cause::kRange, fmt::format("'{}' does not fit {}", text, to_text(encoding))});
  return tl::unexpected(ValueFault{
      Cause::kWrongType,
      fmt::format("'{}' is no number, and the type is {}", text, to_text(encoding.type))});
}

Outcome refused_here(const ChannelPath& path, bool write, Cause cause, std::string reason) {
  Outcome outcome;
  outcome.state = Outcome::State::kRefusedHere;
  outcome.bus = path.bus;
  outcome.device = path.device;
  outcome.target = path.channel;
  outcome.write = write;
  outcome.result.state = CommandState::kRejected;
  outcome.result.cause = to_name(cause);
  outcome.result.reason = std::move(reason);
  return outcome;
}

ExitCode exit_code_of(CommandState state) {
  switch (state) {
    case CommandState::kDone:
    case CommandState::kVerified: return ExitCode::kOk;
    case CommandState::kRejected: return ExitCode::kRejected;
    case CommandState::kFailed: return ExitCode::kFailed;
    case CommandState::kExpired: return ExitCode::kExpired;
  }
  return ExitCode::kTrouble;
}

ExitCode exit_code_of(const Outcome& outcome) {
  switch (outcome.state) {
    case Outcome::State::kResult: break;
    case Outcome::State::kRefusedHere: return ExitCode::kRejected;
    case Outcome::State::kNoResult: return ExitCode::kNoResponse;
    case Outcome::State::kNotSent: return ExitCode::kUsage;
  }
  return exit_code_of(outcome.result.state);
}

std::string outcome_line(const Outcome& outcome) {
  const auto& result = outcome.result;
  const bool ok = exit_code_of(outcome) == ExitCode::kOk;
  std::string line = outcome.bus + '/' + outcome.device + '/' + outcome.target;
  const auto unit = outcome.unit.empty() ? std::string{} : ' ' + outcome.unit;
  if (!outcome.wanted.empty()) line += " = " + values_text(outcome.wanted, outcome.type);
  if (ok && !outcome.write)
    return printable(fmt::format("{} = {}{} in {}", line, values_text(result.values, outcome.type),
                                 unit, took_text(result)));

  line += fmt::format(": {}", state_text(outcome));
  if (ok && !result.values.empty())
    line += fmt::format(" (read back {}{})", values_text(result.values, outcome.type), unit);
  if (ok) return printable(fmt::format("{} in {}", line, took_text(result)));
  if (!result.reason.empty()) line += ": " + result.reason;
  if (!result.cause.empty()) line += fmt::format(" ({})", result.cause);
  return printable(line);
}

Json outcome_json(const Outcome& outcome) {
  const auto& result = outcome.result;
  return {{"request_id", result.request_id},
          {"bus", outcome.bus},
          {"device", outcome.device},
          {"target", outcome.target},
          {"state", state_text(outcome)},
          {"cause", result.cause},
          {"reason", result.reason},
          {"device_code", result.device_code},
          {"values", result.values},
          {"received_at", result.received_at.nanoseconds},
          {"started_at", result.started_at.nanoseconds},
          {"completed_at", result.completed_at.nanoseconds}};
}

}  // namespace fieldcast::cli
