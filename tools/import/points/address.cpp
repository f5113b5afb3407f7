#include "tools/import/points/address.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/import/points/types.hpp"
#include "tools/import/text/table.hpp"
#include "tools/import/text/text.hpp"

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
    {"digitalausgang", ModbusArea::kCoil},
    {"spule", ModbusArea::kCoil},
    {"spulen", ModbusArea::kCoil},
    {"discrete", ModbusArea::kInput},
    {"discreteinput", ModbusArea::kInput},
    {"discreteinputs", ModbusArea::kInput},
    {"inputstatus", ModbusArea::kInput},
    {"digitalinput", ModbusArea::kInput},
    {"inputbit", ModbusArea::kInput},
    {"digitaleingang", ModbusArea::kInput},
    {"diskretereingang", ModbusArea::kInput},
    {"di", ModbusArea::kInput},
    {"1x", ModbusArea::kInput},
    {"input", ModbusArea::kInputRegister},
    {"inputs", ModbusArea::kInputRegister},
    {"inputregister", ModbusArea::kInputRegister},
    {"inputregisters", ModbusArea::kInputRegister},
    {"inputreg", ModbusArea::kInputRegister},
    {"analoginput", ModbusArea::kInputRegister},
    {"analogeingang", ModbusArea::kInputRegister},
    {"eingangsregister", ModbusArea::kInputRegister},
    {"ir", ModbusArea::kInputRegister},
    {"ai", ModbusArea::kInputRegister},
    {"3x", ModbusArea::kInputRegister},
    {"holding", ModbusArea::kHolding},
    {"holdings", ModbusArea::kHolding},
    {"holdingregister", ModbusArea::kHolding},
    {"holdingregisters", ModbusArea::kHolding},
    {"holdingreg", ModbusArea::kHolding},
    {"analogoutput", ModbusArea::kHolding},
    {"analogausgang", ModbusArea::kHolding},
    {"halteregister", ModbusArea::kHolding},
    {"presetmultipleregisters", ModbusArea::kHolding},
    {"presetsingleregister", ModbusArea::kHolding},
    {"writemultipleregisters", ModbusArea::kHolding},
    {"writesingleregister", ModbusArea::kHolding},
    {"hr", ModbusArea::kHolding},
    {"ao", ModbusArea::kHolding},
    {"4x", ModbusArea::kHolding},
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

std::optional<ModbusArea> area_of_function(std::uint64_t code) {
  switch (code) {
    case 1:
    case 5:
    case 15: return ModbusArea::kCoil;
    case 2: return ModbusArea::kInput;
    case 3:
    case 6:
    case 16:
    case 22:
    case 23: return ModbusArea::kHolding;
    case 4: return ModbusArea::kInputRegister;
    default: return std::nullopt;
  }
}

bool is_access(std::string_view word) {
  for (const std::string_view access : {"", "r", "w", "rw", "ro", "wo", "read", "write"})
    if (word == access) return true;
  return false;
}

// "3", "03", "0x03", "10h", "03read".
std::optional<ModbusArea> area_of_number(std::string_view word) {
  const bool hex = word.starts_with("0x") || word.ends_with('h');
  if (hex) return area_of_function(whole_from(word).value_or(0));
  const std::size_t end = std::min(word.find_first_not_of("0123456789"), word.size());
  if (end == 0 || !is_access(word.substr(end))) return std::nullopt;
  return area_of_function(whole_from(word.substr(0, end)).value_or(0));
}

// Finds a table name inside the word; empty if it contains two.
std::optional<ModbusArea> area_inside(const std::string& word) {
  struct Part {
    std::string_view text;
    ModbusArea area;
  };
  constexpr Part kParts[] = {{"holding", ModbusArea::kHolding},
                             {"halteregister", ModbusArea::kHolding},
                             {"inputreg", ModbusArea::kInputRegister},
                             {"eingangsregister", ModbusArea::kInputRegister},
                             {"discretein", ModbusArea::kInput},
                             {"discretestat", ModbusArea::kInput},
                             {"coil", ModbusArea::kCoil}};
  std::optional<ModbusArea> found;
  for (const Part& part : kParts) {
    if (word.find(part.text) == std::string::npos) continue;
    if (found && *found != part.area) return std::nullopt;
    found = part.area;
  }
  // "Read Input Registers (04)", "3 (Holding register)": the function must agree.
  const std::size_t first = std::min(word.find_first_not_of("0123456789"), word.size());
  const std::size_t last = word.find_last_not_of("0123456789");
  for (const std::string& digits : {word.substr(0, first), word.substr(last + 1)}) {
    const auto area = area_of_function(whole_from(digits).value_or(0));
    if (found && area && digits.size() <= 2 && *area != *found) return std::nullopt;
  }
  return found;
}

std::optional<ModbusArea> area_of_word(std::string word) {
  if (word.starts_with("modbus") && word.size() > 6) word.erase(0, 6);
  for (const std::string_view begin : {"functioncode", "function", "funktion", "fc", "fn", "f"}) {
    const bool number = word.size() > begin.size() && word.starts_with(begin) &&
                        word[begin.size()] >= '0' && word[begin.size()] <= '9';
    if (number) word.erase(0, begin.size());
  }
  const auto known = std::ranges::find(kWords, word, &AreaWord::word);
  if (known != std::end(kWords)) return known->area;
  const auto number = area_of_number(word);
  return number ? number : area_inside(word);
}

bool all_digits(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

using Parsed = tl::expected<Reference, std::string>;

Parsed counted(std::optional<ModbusArea> area, std::string_view digits, unsigned base) {
  const auto number = whole_from(digits);
  if (!number || *number > 65535 + base)
    return tl::unexpected(
        fmt::format("'{}' is no number from {} to {}", digits, base, 65535 + base));
  if (*number < base) return tl::unexpected(std::string("references count from 1"));
  return Reference{area, static_cast<std::uint32_t>(*number - base), {}};
}

Parsed offset(std::optional<ModbusArea> area, std::string_view digits) {
  const auto number = whole_from(digits);
  if (!number || *number > 65535)
    return tl::unexpected(fmt::format("'{}' is no address from 0 to 65535", digits));
  return Reference{area, static_cast<std::uint32_t>(*number), {}};
}

Parsed without_bit(std::string_view text, unsigned base) {
  if (text.starts_with("%MW")) return offset(ModbusArea::kHolding, text.substr(3));
  if (text.starts_with("%IW")) return offset(ModbusArea::kInputRegister, text.substr(3));
  if (text.starts_with("%M")) return offset(ModbusArea::kCoil, text.substr(2));
  if (text.starts_with("%I")) return offset(ModbusArea::kInput, text.substr(2));
  // "4x0101", "4:101", "3-0007"
  if (text.size() > 2 && std::string_view("xX:-").find(text[1]) != std::string_view::npos &&
      !text.starts_with("0x") && !text.starts_with("0X")) {
    if (const auto area = area_of_digit(text[0])) return counted(area, text.substr(2), base);
  }
  if (all_digits(text) && (text.size() == 5 || text.size() == 6)) {
    if (const auto area = area_of_digit(text[0])) return counted(area, text.substr(1), base);
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
  // "03/06", "3, 16", "(R/W) Holding": all parts must name the same table.
  std::optional<ModbusArea> found;
  while (!name.empty()) {
    const std::size_t end = std::min(name.find_first_of("/,;+&|"), name.size());
    const std::string word = column_word(name.substr(0, end));
    name.remove_prefix(std::min(end + 1, name.size()));
    if (is_access(word)) continue;
    const auto area = area_of_word(word);
    if (!area || (found && *found != *area)) return std::nullopt;
    found = area;
  }
  return found;
}

bool is_area_word(std::string_view name) {
  const std::string word = column_word(name);
  return !word.empty() && (word[0] < '0' || word[0] > '9') && area_by_name(name);
}

Slave slave_from(std::string_view text) {
  text = trimmed(text);
  if (text.empty()) return std::nullopt;
  const auto number = whole_from(text);
  if (!number || *number > 65535)
    return tl::unexpected(fmt::format("'{}' is no address of a device on its bus", text));
  return static_cast<std::uint16_t>(*number);
}

tl::expected<Reference, std::string> reference_from(std::string_view text, unsigned base) {
  text = trimmed(text);
  if (text.empty()) return tl::unexpected(std::string("no address"));
  const std::size_t point = text.find_first_of(".");
  if (point == std::string_view::npos) return without_bit(text, base);
  auto reference = without_bit(trimmed(text.substr(0, point)), base);
  if (!reference) return reference;
  const auto bit = whole_from(text.substr(point + 1));
  if (!bit || *bit > 15)
    return tl::unexpected(fmt::format("bit '{}' is not 0 to 15", text.substr(point + 1)));
  reference->bit = static_cast<std::uint8_t>(*bit);
  return reference;
}

void append_array(std::vector<Point>& points, const Point& first, ModbusArea area,
                  std::uint32_t address, unsigned count) {
  const unsigned step = holds_bits(area) ? 1 : registers_of(first.type, first.string_bytes);
  for (unsigned i = 0; i < count && points.size() <= kMaxPoints; ++i) {
    Point point = first;
    point.name = fmt::format("{}-{}", first.name, i);
    point.at = address_text(area, address + std::uint64_t{i} * step);
    point.changes.push_back(fmt::format("element {} of an array of {}", i, count));
    points.push_back(std::move(point));
  }
}

}  // namespace fieldcast::importing
