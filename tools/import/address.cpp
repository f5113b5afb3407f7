#include "tools/import/address.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/import/number.hpp"
#include "tools/import/table.hpp"
#include "tools/import/text.hpp"

namespace fieldcast::importing {
namespace {

struct AreaWord {
  std::string_view word;
  ModbusArea area;
};
constexpr AreaWord kWords[] = {
    {"coil", ModbusArea::kCoil},
    {"coils", ModbusArea::kCoil},
    {"coilstatus", ModbusArea::kCoil},
    {"do", ModbusArea::kCoil},
    {"0x", ModbusArea::kCoil},
    {"digitaloutput", ModbusArea::kCoil},
    {"discreteoutput", ModbusArea::kCoil},
    {"outputcoil", ModbusArea::kCoil},
    {"1", ModbusArea::kCoil},
    {"01", ModbusArea::kCoil},
    {"5", ModbusArea::kCoil},
    {"05", ModbusArea::kCoil},
    {"15", ModbusArea::kCoil},
    {"discrete", ModbusArea::kInput},
    {"discreteinput", ModbusArea::kInput},
    {"discreteinputs", ModbusArea::kInput},
    {"inputstatus", ModbusArea::kInput},
    {"digitalinput", ModbusArea::kInput},
    {"inputbit", ModbusArea::kInput},
    {"di", ModbusArea::kInput},
    {"1x", ModbusArea::kInput},
    {"2", ModbusArea::kInput},
    {"02", ModbusArea::kInput},
    {"input", ModbusArea::kInputRegister},
    {"inputs", ModbusArea::kInputRegister},
    {"inputregister", ModbusArea::kInputRegister},
    {"inputregisters", ModbusArea::kInputRegister},
    {"inputreg", ModbusArea::kInputRegister},
    {"analoginput", ModbusArea::kInputRegister},
    {"ir", ModbusArea::kInputRegister},
    {"ai", ModbusArea::kInputRegister},
    {"3x", ModbusArea::kInputRegister},
    {"4", ModbusArea::kInputRegister},
    {"04", ModbusArea::kInputRegister},
    {"holding", ModbusArea::kHolding},
    {"holdings", ModbusArea::kHolding},
    {"holdingregister", ModbusArea::kHolding},
    {"holdingregisters", ModbusArea::kHolding},
    {"holdingreg", ModbusArea::kHolding},
    {"analogoutput", ModbusArea::kHolding},
    {"hr", ModbusArea::kHolding},
    {"ao", ModbusArea::kHolding},
    {"4x", ModbusArea::kHolding},
    {"3", ModbusArea::kHolding},
    {"03", ModbusArea::kHolding},
    {"6", ModbusArea::kHolding},
    {"06", ModbusArea::kHolding},
    {"16", ModbusArea::kHolding},
    {"10h", ModbusArea::kHolding},
    {"register", ModbusArea::kHolding},
    {"registers", ModbusArea::kHolding},
};

std::optional<ModbusArea> area_of_digit(char digit) {
  switch (digit) {
    case '0': return ModbusArea::kCoil;
    case '1': return ModbusArea::kInput;
    case '3': return ModbusArea::kInputRegister;
    case '4': return ModbusArea::kHolding;
    default: return std::nullopt;
  }
}

bool all_digits(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

using Parsed = tl::expected<Reference, std::string>;

// Counted from 1.
Parsed counted(std::optional<ModbusArea> area, std::string_view digits) {
  const auto number = whole_from(digits);
  if (!number || *number > 65536)
    return tl::unexpected(fmt::format("'{}' is no number from 1 to 65536", digits));
  if (*number == 0) return tl::unexpected(std::string("references count from 1"));
  return Reference{area, static_cast<std::uint32_t>(*number - 1), {}};
}

// Counted from 0.
Parsed offset(std::optional<ModbusArea> area, std::string_view digits) {
  const auto number = whole_from(digits);
  if (!number || *number > 65535)
    return tl::unexpected(fmt::format("'{}' is no address from 0 to 65535", digits));
  return Reference{area, static_cast<std::uint32_t>(*number), {}};
}

Parsed without_bit(std::string_view text) {
  if (text.starts_with("%MW")) return offset(ModbusArea::kHolding, text.substr(3));
  if (text.starts_with("%IW")) return offset(ModbusArea::kInputRegister, text.substr(3));
  if (text.starts_with("%M")) return offset(ModbusArea::kCoil, text.substr(2));
  if (text.starts_with("%I")) return offset(ModbusArea::kInput, text.substr(2));
  // "4x0101", "4:101", "3-0007"
  if (text.size() > 2 && std::string_view("xX:-").find(text[1]) != std::string_view::npos &&
      !text.starts_with("0x") && !text.starts_with("0X")) {
    if (const auto area = area_of_digit(text[0])) return counted(area, text.substr(2));
  }
  if (all_digits(text) && (text.size() == 5 || text.size() == 6)) {
    if (const auto area = area_of_digit(text[0])) return counted(area, text.substr(1));
  }
  // "HR100", "holding:100"
  const std::size_t digit = text.find_first_of("0123456789");
  if (digit != std::string_view::npos && digit > 1) {
    std::string_view word = text.substr(0, digit);
    while (!word.empty() && std::string_view(" :_-#").find(word.back()) != std::string_view::npos)
      word.remove_suffix(1);
    if (const auto area = area_by_name(word)) return offset(area, text.substr(digit));
  }
  return offset(std::nullopt, text);
}

}  // namespace

std::string address_text(ModbusArea area, std::uint64_t first, std::optional<std::uint8_t> bit) {
  constexpr std::string_view kNames[] = {"coil", "input", "input-register", "holding"};
  const std::string text = fmt::format("{}:{}", kNames[static_cast<std::size_t>(area)], first);
  return bit ? fmt::format("{}.{}", text, *bit) : text;
}

std::optional<ModbusArea> area_by_name(std::string_view name) {
  std::string word = column_word(name);
  for (const std::string_view begin : {"fc", "function", "fn", "modbus"}) {
    if (word.starts_with(begin) && word.size() > begin.size()) word.erase(0, begin.size());
  }
  if (word.starts_with("0x") && word.size() == 4) word.erase(0, 2);
  // "(R/W) Holding", "3 (Holding register)", "03/06": what comes first decides.
  const auto found = std::ranges::find(kWords, word, &AreaWord::word);
  if (found != std::end(kWords)) return found->area;
  for (const std::string_view part : {"holding", "inputregister", "discrete", "coil"}) {
    if (word.find(part) != std::string::npos) return area_by_name(part);
  }
  const std::size_t digits = word.find_first_not_of("0123456789");
  if (digits == std::string::npos || digits == 0) {
    const std::size_t stroke = name.find_first_of("/,+ ");
    if (stroke != std::string_view::npos && stroke > 0) return area_by_name(name.substr(0, stroke));
    return std::nullopt;
  }
  return area_by_name(word.substr(0, digits));
}

bool is_area_word(std::string_view name) {
  const std::string word = column_word(name);
  return !word.empty() && (word[0] < '0' || word[0] > '9') && area_by_name(name);
}

tl::expected<Reference, std::string> reference_from(std::string_view text) {
  text = trimmed(text);
  if (text.empty()) return tl::unexpected(std::string("no address"));
  const std::size_t point = text.find_first_of(".");
  if (point == std::string_view::npos) return without_bit(text);
  auto reference = without_bit(trimmed(text.substr(0, point)));
  if (!reference) return reference;
  const auto bit = whole_from(text.substr(point + 1));
  if (!bit || *bit > 15)
    return tl::unexpected(fmt::format("bit '{}' is not 0 to 15", text.substr(point + 1)));
  reference->bit = static_cast<std::uint8_t>(*bit);
  return reference;
}

}  // namespace fieldcast::importing
