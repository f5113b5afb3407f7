#include "config/channel/exponent.hpp"

#include <fmt/format.h>

#include "config/document/scalars.hpp"

namespace fieldcast::config {
namespace {

constexpr unsigned kRegisterBits = 16;

bool has_exponent_type(const Encoding& encoding) {
  switch (encoding.type) {
    case ValueType::kBool:
    case ValueType::kString:
    case ValueType::kFloat32:
    case ValueType::kFloat64: return false;
    default: return !encoding.text_number;
  }
}

}  // namespace

void read_exponent(MapReader& map, const Protocol* protocol, const ParsedAddress* value,
                   ChannelSpec& spec) {
  std::string at;
  if (!map.read(kExponentKey, at, TextRule{kMaxNameLength}) || value == nullptr) return;
  const auto fault = [&](const std::string& what, const std::string& allowed) {
    map.faults().add(map.position_of(kExponentKey), what, allowed);
  };
  const Area& area = protocol->areas()[value->area];
  if (!has_exponent_type(spec.encoding)) {
    const bool text = static_cast<bool>(spec.encoding.text_number);
    return fault(
        fmt::format("'{}' at a {}", kExponentKey, text ? "number as text" : to_text(spec.encoding)),
        "a channel of an integer or BCD type");
  }
  if (area.item_bits != kRegisterBits || value->value_bits != 0) {
    return fault(
        fmt::format("'{}' at '{}', which is not in 16-bit registers", kExponentKey, spec.at),
        "a channel in an area of 16-bit registers");
  }
  const auto exponent = protocol->parse_address(at);
  if (!exponent) {
    map.faults().add(map.position_of(kExponentKey), exponent.error().what, exponent.error().allowed,
                     exponent.error().suggestion);
    return;
  }
  if (exponent->area != value->area || exponent->bit) {
    return fault(
        fmt::format("'{}' is not a register of area {}, in which '{}' is", at, area.name, spec.at),
        fmt::format("a whole register of area {}", area.name));
  }
  const std::int64_t distance = std::int64_t{exponent->first} - value->first;
  const std::uint32_t own = item_count(spec.encoding, kRegisterBits);
  if (distance >= 0 && distance < own) {
    return fault(fmt::format("'{}' is part of the value at '{}'", at, spec.at),
                 "a register before or behind the value");
  }
  spec.exponent_from = std::move(at);
  spec.encoding.exponent_distance = static_cast<std::int32_t>(distance);
}

}  // namespace fieldcast::config
