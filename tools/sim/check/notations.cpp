#include "tools/sim/check/notations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace fieldcast::sim {
namespace {

std::string number(std::uint32_t number, int base) {
  char text[16];
  const auto [end, error] = std::to_chars(text, text + sizeof text, number, base);
  return {text, end};
}

// Uses the base of the declaration; hexadecimal digits in both cases.
void add_numbered(const declared::DeclaredArea& area, std::vector<std::string>& all) {
  const std::uint32_t last = area.origin + area.items - 1;
  const auto add = [&](std::uint32_t item) {
    const std::string text = number(item, area.base);
    std::string upper = text;
    std::ranges::transform(upper, upper.begin(), [](char c) {
      return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    });
    all.push_back(area.prefix + text);
    if (upper != text) all.push_back(area.prefix + upper);
  };
  add(area.origin);
  if (area.items > 1) add(last);
  if (area.items > 31) add(area.origin + 30);
  if (area.item_bits > 1 && area.items > 2)
    all.push_back(fmt::format("{}{}.3", area.prefix, number(area.origin + 1, area.base)));
}

}  // namespace

std::vector<std::string> notations_of(const Subject& subject) {
  if (!subject.device.declaration) return {subject.addresses.begin(), subject.addresses.end()};
  std::vector<std::string> all;
  for (const declared::DeclaredArea& area : subject.device.declaration.value->areas) {
    if (!area.record) add_numbered(area, all);
    for (const declared::Place& place : area.places) {
      all.push_back(place.name);
      if (place.bits != 0) all.push_back(fmt::format("{}.{}", place.name, place.bits - 1));
    }
  }
  return all;
}

Encoding natural_encoding(const ParsedAddress& address, const Area& area,
                          const declared::Declaration* declaration) {
  Encoding encoding;
  encoding.word_order = area.word_order;
  encoding.bit = address.bit;
  if (area.item_bits == 1 || address.bit) {
    encoding.type = ValueType::kBool;
    return encoding;
  }
  if (declaration != nullptr && declaration->areas[address.area].record && !address.width_bits) {
    for (const declared::Place& place : declaration->areas[address.area].places) {
      if (place.first != address.first) continue;
      encoding.type = ValueType::kString;
      encoding.string_bytes = static_cast<std::uint16_t>(2 * place.items);
    }
    return encoding;
  }
  switch (address.width_bits.value_or(area.item_bits)) {
    case 8: encoding.type = ValueType::kUint8; break;
    case 32: encoding.type = ValueType::kUint32; break;
    case 64: encoding.type = ValueType::kUint64; break;
    default: encoding.type = ValueType::kUint16;
  }
  return encoding;
}

}  // namespace fieldcast::sim
