#include "core/model/implied_type.hpp"

#include <string>

namespace fieldcast {

std::optional<Encoding> fixed_type(const ParsedAddress& address, const Area& area) {
  if (address.bit || address.width_bits == 1u || area.item_bits == 1)
    return Encoding{ValueType::kBool};
  if (address.text_characters != 0 && !address.text_number)
    return Encoding{.type = ValueType::kString, .string_bytes = address.text_characters};
  if (area.type) return Encoding{*area.type};
  return std::nullopt;
}

std::optional<Encoding> implied_type(const ParsedAddress& address, const Area& area) {
  if (auto fixed = fixed_type(address, area)) return fixed;
  if (address.text_number) {
    const bool hex = address.text_number.kind == TextNumber::Kind::kHex;
    return Encoding{hex ? ValueType::kUint64 : ValueType::kFloat64};
  }
  const bool byte = address.value_bits != 0 && address.value_bits <= 8;
  const unsigned bits = byte ? 8 : address.width_bits.value_or(area.item_bits);
  const auto type = value_type_from((address.value_signed ? "int" : "uint") + std::to_string(bits));
  return type ? std::optional(Encoding{*type}) : std::nullopt;
}

}  // namespace fieldcast
