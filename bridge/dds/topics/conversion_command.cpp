#include <algorithm>
#include <cmath>

#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

namespace {

constexpr std::size_t kMaxRequester = 128, kMaxTarget = 128;

tl::unexpected<MalformedCommand> malformed(Cause cause, std::string reason) {
  return tl::unexpected(MalformedCommand{cause, std::move(reason)});
}

tl::expected<Encoding, MalformedCommand> from_idl(const idl::Encoding& encoding) {
  const auto type = fieldcast::from_idl(encoding.type());
  if (!type) return malformed(Cause::kWrongType, "encoding: unknown type");
  Encoding out;
  out.type = *type;
  out.string_bytes = encoding.string_bytes();
  if (out.type == ValueType::kString &&
      (out.string_bytes == 0 || out.string_bytes > kMaxStringBytes)) {
    return malformed(Cause::kRange, "encoding: a string has 1..250 bytes");
  }
  out.word_order = encoding.low_word_first() ? WordOrder::kLittleEndian : WordOrder::kBigEndian;
  out.byte_order = encoding.low_byte_first() ? ByteOrder::kLittleEndian : ByteOrder::kBigEndian;
  if (encoding.bit() < -1 || encoding.bit() > 63)
    return malformed(Cause::kRange, "encoding: bit is -1 or 0..63");
  if (encoding.bit() >= 0) {
    if (width_bits(out) > 8 || out.type == ValueType::kString)
      return malformed(Cause::kWrongType, "encoding: only a bool or an 8-bit type has a bit");
    out.bit = static_cast<std::uint8_t>(encoding.bit());
  }
  if (!std::isfinite(encoding.scale()) || !std::isfinite(encoding.offset())) {
    return malformed(Cause::kRange, "encoding: scale and offset are finite numbers");
  }
  out.scale = encoding.scale() == 0.0 ? 1.0 : encoding.scale();
  out.offset = encoding.offset();
  return out;
}

void to_idl(const Encoding& encoding, idl::Encoding& out) {
  out.type(to_idl(encoding.type));
  out.string_bytes(encoding.string_bytes);
  out.low_word_first(encoding.word_order == WordOrder::kLittleEndian);
  out.low_byte_first(encoding.byte_order == ByteOrder::kLittleEndian);
  out.bit(encoding.bit ? static_cast<std::int16_t>(*encoding.bit) : std::int16_t{-1});
  out.scale(encoding.scale);
  out.offset(encoding.offset);
}

}  // namespace

tl::expected<Command, MalformedCommand> from_idl(const idl::Command& command) {
  Command out;
  out.requester = command.requester().c_str();
  out.request_id = command.request_id();
  out.device = command.device().c_str();
  out.verify = command.verify();
  out.count = command.count();

  const auto operation = from_idl(command.operation());
  if (!operation) return malformed(Cause::kUnsupported, "unknown operation");
  out.operation = *operation;

  const bool channel = command.target_kind() == idl::TargetKind::TARGET_CHANNEL;
  if (!channel && command.target_kind() != idl::TargetKind::TARGET_ADDRESS)
    return malformed(Cause::kUnsupported, "unknown kind of target");
  if (channel) {
    out.target = ChannelTarget{command.target().c_str()};
    out.count = 1;
    if (out.operation == Operation::kWrite && command.target().size() == 0) {
      return malformed(Cause::kUnknownChannel, "a write names its channel");
    }
  } else {
    auto encoding = from_idl(command.encoding());
    if (!encoding) return tl::unexpected(encoding.error());
    out.target = AddressTarget{command.target().c_str(), *encoding};
    if (out.operation == Operation::kAcquire && (out.count == 0 || out.count > kMaxCommandValues)) {
      return malformed(Cause::kRange, "count is 1..2048");
    }
  }

  if (out.operation == Operation::kWrite && command.values().empty())
    return malformed(Cause::kWrongType, "a write needs a value");
  if (command.values().size() > kMaxCommandValues)
    return malformed(Cause::kRange, "more than 2048 values");
  out.values.reserve(command.values().size());
  for (const idl::Value& value : command.values()) {
    std::optional<Value> known = from_idl(value);
    if (!known) return malformed(Cause::kWrongType, "a value of an unknown kind");
    out.values.push_back(std::move(*known));
  }
  return out;
}

bool to_idl(std::string_view bus, const Command& command, idl::Command& out) {
  const auto* address = std::get_if<AddressTarget>(&command.target);
  const std::string& target = address ? address->at : std::get<ChannelTarget>(command.target).name;
  if (bus.size() > kMaxNameLength || command.device.size() > kMaxNameLength ||
      command.requester.size() > kMaxRequester ||
      target.size() > (address ? kMaxTarget : kMaxNameLength) ||
      command.values.size() > kMaxCommandValues) {
    return false;
  }
  out.requester() = command.requester;
  out.request_id(command.request_id);
  out.bus() = std::string(bus);
  out.device() = command.device;
  out.target_kind(address ? idl::TargetKind::TARGET_ADDRESS : idl::TargetKind::TARGET_CHANNEL);
  out.target() = target;
  to_idl(address ? address->encoding : Encoding{}, out.encoding());
  out.operation(to_idl(command.operation));
  out.values().resize(command.values.size());
  for (std::size_t i = 0; i < command.values.size(); ++i) {
    if (!to_idl(command.values[i], out.values()[i])) return false;
  }
  out.count(command.count);
  out.verify(command.verify);
  return true;
}

void to_idl(std::string_view bus, const CommandResult& result, const UtcMapping& mapping,
            idl::CommandResult& out) {
  out.requester() = cut_text(result.requester, kMaxRequester);
  out.request_id(result.request_id);
  out.bus() = cut_text(bus, kMaxNameLength);
  out.state(to_idl(result.state));
  out.cause() = std::string(to_name(result.cause));
  out.device_code(result.device_code);
  std::string reason = result.reason;
  auto& values = out.values();
  values.clear();
  values.reserve(std::min(result.values.size(), kMaxCommandValues));
  for (const Value& value : result.values) {
    idl::Value& next = values.emplace_back();
    if (values.size() <= kMaxCommandValues && to_idl(value, next)) continue;
    values.pop_back();
    reason = "from value " + std::to_string(values.size()) +
             " on, the values do not fit the topic. " + reason;
    break;
  }
  out.reason() = cut_text(reason, 256);
  out.received_at(mapping.to_utc(result.received).nanoseconds);
  out.started_at(mapping.to_utc(result.started).nanoseconds);
  out.completed_at(mapping.to_utc(result.completed).nanoseconds);
}

StationResult from_idl(const idl::CommandResult& result) {
  StationResult out;
  out.requester = result.requester().c_str();
  out.request_id = result.request_id();
  out.bus = result.bus().c_str();
  out.state = from_idl(result.state()).value_or(CommandState::kFailed);
  out.cause = result.cause().c_str();
  out.device_code = result.device_code();
  out.reason = result.reason().c_str();
  for (const idl::Value& value : result.values()) {
    std::optional<Value> known = from_idl(value);
    if (!known) break;
    out.values.push_back(std::move(*known));
  }
  out.received_at = {result.received_at()};
  out.started_at = {result.started_at()};
  out.completed_at = {result.completed_at()};
  return out;
}

std::optional<Interest> from_idl(const idl::Interest& interest) {
  if (interest.refresh() <= 0 || interest.station().size() == 0 || interest.pattern().size() == 0)
    return std::nullopt;
  return Interest{interest.station().c_str(), interest.pattern().c_str(),
                  Duration{interest.refresh()}};
}

}  // namespace fieldcast
