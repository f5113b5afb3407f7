#include <algorithm>

#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

std::string cut_text(std::string_view text, std::size_t limit) {
  text = text.substr(0, text.find('\0'));
  if (text.size() <= limit) return std::string(text);
  std::size_t end = limit;
  // never cut inside a character
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return std::string(text.substr(0, end));
}

bool to_idl(const Value& value, idl::Value& out) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    if (text->size() > kMaxTextValue || text->find('\0') != std::string::npos) return false;
    out.string_value(text->c_str());
  } else if (const auto* on = std::get_if<bool>(&value)) {
    out.boolean_value(*on);
  } else if (const auto* whole = std::get_if<std::int64_t>(&value)) {
    out.int64_value(*whole);
  } else if (const auto* natural = std::get_if<std::uint64_t>(&value)) {
    out.uint64_value(*natural);
  } else {
    out.double_value(std::get<double>(value));
  }
  return true;
}

std::optional<Value> from_idl(const idl::Value& value) {
  switch (value._d()) {
    case idl::VALUE_BOOLEAN: return value.boolean_value();
    case idl::VALUE_INT64: return std::int64_t{value.int64_value()};
    case idl::VALUE_UINT64: return std::uint64_t{value.uint64_value()};
    case idl::VALUE_DOUBLE: return value.double_value();
    case idl::VALUE_STRING: return std::string(value.string_value().c_str());
  }
  return std::nullopt;
}

void to_idl(const Sample& sample, const UtcMapping& mapping, idl::Sample& out) {
  if (to_idl(sample.value, out.value())) {
    out.quality(to_idl(sample.quality));
  } else {
    out.value().string_value("");
    out.quality(idl::BAD_RANGE);
  }
  out.device_code(sample.device_code);
  out.acquired_at(mapping.to_utc(sample.acquired).nanoseconds);
  out.sequence(sample.sequence);
}

std::optional<StationSample> from_idl(const idl::Sample& sample) {
  std::optional<Value> value = from_idl(sample.value());
  const auto quality = from_idl(sample.quality());
  if (!value || !quality) return std::nullopt;
  StationSample out;
  out.bus = sample.bus().c_str();
  out.device = sample.device().c_str();
  out.channel = sample.channel().c_str();
  out.value = std::move(*value);
  out.quality = *quality;
  out.device_code = sample.device_code();
  out.acquired_at = {sample.acquired_at()};
  out.sequence = sample.sequence();
  return out;
}

namespace {

void add_limit(std::vector<idl::Limit>& limits, idl::LimitKind kind,
               const std::optional<double>& value) {
  if (!value) return;
  limits.emplace_back();
  limits.back().kind(kind);
  limits.back().value(*value);
}

}  // namespace

void to_idl(std::string_view bridge, std::string_view bus, const DeviceSpec& device,
            const ChannelSpec& channel, std::optional<Duration> refresh, idl::Channel& out) {
  out.bus() = cut_text(bus, kMaxNameLength);
  out.device() = cut_text(device.name, kMaxNameLength);
  out.channel() = cut_text(channel.name, kMaxNameLength);
  out.bridge() = cut_text(bridge, kMaxNameLength);
  out.type() = to_text(channel.encoding);
  out.unit() = cut_text(channel.unit, 32);
  out.at() = cut_text(channel.at, 128);
  out.access(to_idl(channel.access));
  out.mode(to_idl(channel.mode));
  out.refresh(refresh.value_or(Duration::zero()).count());
  auto& limits = out.limits();
  limits.clear();
  add_limit(limits, idl::LIMIT_LOW_LOW, channel.limits.low_low);
  add_limit(limits, idl::LIMIT_LOW, channel.limits.low);
  add_limit(limits, idl::LIMIT_HIGH, channel.limits.high);
  add_limit(limits, idl::LIMIT_HIGH_HIGH, channel.limits.high_high);
  add_limit(limits, idl::LIMIT_WRITE_MIN, channel.write_min);
  add_limit(limits, idl::LIMIT_WRITE_MAX, channel.write_max);
  out.description() = cut_text(channel.description, 256);
}

StationChannel from_idl(const idl::Channel& channel) {
  StationChannel out;
  out.bridge = channel.bridge().c_str();
  out.bus = channel.bus().c_str();
  out.device = channel.device().c_str();
  out.channel = channel.channel().c_str();
  out.type = channel.type().c_str();
  out.unit = channel.unit().c_str();
  out.at = channel.at().c_str();
  out.description = channel.description().c_str();
  out.access = from_idl(channel.access()).value_or(Access::kReadOnly);
  out.mode = from_idl(channel.mode()).value_or(Mode::kScheduled);
  out.refresh = Duration{channel.refresh()};
  for (const idl::Limit& limit : channel.limits()) {
    switch (limit.kind()) {
      case idl::LIMIT_LOW_LOW: out.limits.low_low = limit.value(); break;
      case idl::LIMIT_LOW: out.limits.low = limit.value(); break;
      case idl::LIMIT_HIGH: out.limits.high = limit.value(); break;
      case idl::LIMIT_HIGH_HIGH: out.limits.high_high = limit.value(); break;
      case idl::LIMIT_WRITE_MIN: out.write_min = limit.value(); break;
      case idl::LIMIT_WRITE_MAX: out.write_max = limit.value(); break;
    }
  }
  return out;
}

}  // namespace fieldcast
