#include "core/model/fit.hpp"

#include <string>

#include "core/codec/raw_items.hpp"
#include "core/protocol/option_reader.hpp"

namespace fieldcast {

namespace {

using About = FitFault::About;

std::string bits(unsigned count) { return std::to_string(count) + " bits"; }

std::optional<FitFault> check_bit(std::string_view at, const ParsedAddress& address,
                                  const Area& area, const Encoding& encoding) {
  if (encoding.bit && *encoding.bit >= area.item_bits) {
    return FitFault{About::kPart,
                    "bit " + std::to_string(*encoding.bit) + " is beyond " + in_quotes(at),
                    "0 to " + std::to_string(area.item_bits - 1),
                    {}};
  }
  if (!encoding.bit && area.item_bits > 1) {
    return FitFault{
        About::kType, "a bool in " + in_quotes(at) + " needs a bit",
        "a bit in 'at', or 'bit': 0 to " + std::to_string(bits_of_value(address, area) - 1),
        address.width_bits ? std::string() : std::string(at) + ".0"};
  }
  return std::nullopt;
}

std::optional<FitFault> check_byte(std::string_view at, const ParsedAddress& address,
                                   const Area& area, const Encoding& encoding) {
  const std::string type(to_text(encoding.type));
  if (encoding.bit) {
    if (area.item_bits == 8) {
      return FitFault{About::kPart,
                      "a byte of " + in_quotes(at) + ", which is a byte already",
                      "no 'byte'",
                      {}};
    }
    if (address.width_bits.value_or(area.item_bits) != area.item_bits) {
      return FitFault{About::kPart,
                      "a byte of " + in_quotes(at) + ", which has " + bits(*address.width_bits),
                      "a byte of an item of " + bits(area.item_bits),
                      {}};
    }
    if (*encoding.bit % 8 == 0 && *encoding.bit + 8u <= area.item_bits) return std::nullopt;
    return FitFault{
        About::kPart, "that byte is beyond " + in_quotes(at), byte_names(area.item_bits), {}};
  }
  if (area.item_bits == 8 && address.width_bits.value_or(8) == 8) return std::nullopt;
  if (address.value_bits != 0 && address.value_bits <= 8) {
    if (is_signed(encoding.type) == address.value_signed) return std::nullopt;
    return FitFault{About::kType,
                    in_quotes(at) +
                        (address.value_signed ? " is declared with a sign, type "
                                              : " is declared without a sign, type ") +
                        type + (address.value_signed ? " has none" : " has one"),
                    address.value_signed ? "int8" : "uint8, bcd8, or 'signed: true' at the field",
                    address.value_signed ? "int8" : "uint8"};
  }
  const unsigned whole = address.width_bits.value_or(area.item_bits);
  return FitFault{
      About::kType,
      "type " + type + " has 8 bits, " + in_quotes(at) + " has " + std::to_string(whole),
      "a type of " + bits(whole) +
          (whole == area.item_bits ? ", or " + byte_names(area.item_bits) : ""),
      {}};
}

// An address of a text requires a string, or a number written as text.
std::optional<FitFault> check_text(std::string_view at, const ParsedAddress& address,
                                   const Encoding& encoding) {
  const std::string there = std::to_string(address.text_characters);
  const std::string where = in_quotes(at) + ", which is a text of " + there + " characters";
  const std::string string = "string(" + there + ")";
  if (is_date_time(address.text_layout)) {
    if (to_text(encoding) == string) return std::nullopt;
    return FitFault{About::kType,
                    "type " + to_text(encoding) + " at " + in_quotes(at) + ", which is a date",
                    string, string};
  }
  if (!encoding.is_text()) {
    const bool number = encoding.type != ValueType::kBool && !is_bcd(encoding.type);
    return FitFault{About::kType,
                    "type " + std::string(to_text(encoding.type)) + " at " + where,
                    string + (number ? ", or text: decimal, decimal-comma, hex or a picture, where "
                                       "it spells a number"
                                     : ""),
                    {}};
  }
  if (encoding.string_bytes <= address.text_characters) return std::nullopt;
  return FitFault{About::kType, to_text(encoding) + " at " + where, string, string};
}

}  // namespace

unsigned bits_of_value(const ParsedAddress& address, const Area& area) {
  return address.value_bits != 0 ? address.value_bits : address.width_bits.value_or(area.item_bits);
}

std::string byte_names(unsigned item_bits) {
  if (item_bits == 16) return "byte: low, byte: high";
  return "byte: 0 to " + std::to_string(item_bits / 8 - 1);
}

std::optional<std::string> why_no_byte_write(std::string_view at, const Area& area) {
  if (area.byte_write) return std::nullopt;
  return "a byte of " + std::string(at) + " cannot be written without the rest of it";
}

std::optional<FitFault> check_fit(std::string_view at, const ParsedAddress& address,
                                  const Area& area, const Encoding& encoding) {
  const std::string type(to_text(encoding.type));
  const bool is_bool = encoding.type == ValueType::kBool;
  if (address.text_characters != 0) return check_text(at, address, encoding);
  if (address.text_layout == TextLayout::kCounted && encoding.type != ValueType::kString)
    return FitFault{About::kType,
                    "type " + type + " at " + in_quotes(at) + ", which is a string",
                    "string(1) to string(" + std::to_string(kMaxStringBytes) + ")",
                    {}};
  const bool is_text = encoding.is_text();
  const bool is_byte = !is_text && width_bits(encoding) == 8;
  if (encoding.bit && area.item_bits == 1) {
    return FitFault{
        About::kPart, "a bit of " + in_quotes(at) + ", which is a bit already", "no 'bit'", {}};
  }
  if (encoding.bit && !is_bool && (address.bit || !is_byte))
    return FitFault{About::kType, "type " + type + " with a bit of a word", "bool", "bool"};
  if (is_bool) return check_bit(at, address, area, encoding);
  const unsigned whole = area.item_bits == 1 ? 1u : address.width_bits.value_or(0);
  if (whole == 1) {
    return FitFault{About::kType,
                    "type " + type + " does not fit " + in_quotes(at) + ", which is one bit",
                    "bool", "bool"};
  }
  if (is_byte) return check_byte(at, address, area, encoding);
  if (whole > 1 && !is_text && width_bits(encoding) != whole) {
    return FitFault{About::kType,
                    "type " + type + " has " + std::to_string(width_bits(encoding)) + " bits, " +
                        in_quotes(at) + " has " + std::to_string(whole),
                    "a type of " + std::to_string(whole) + " bits",
                    {}};
  }
  return std::nullopt;
}

Encoding with_form_of(const ParsedAddress& address, Encoding encoding) {
  if (address.bit) encoding.bit = address.bit;
  const bool number = encoding.type != ValueType::kBool && encoding.type != ValueType::kString;
  if (number && !is_bcd(encoding.type) && address.text_number) {
    encoding.text_number = address.text_number;
    encoding.string_bytes = address.text_characters;
  }
  encoding.layout = address.text_layout;
  return encoding;
}

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
  if (address.text_layout == TextLayout::kCounted) return std::nullopt;
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
