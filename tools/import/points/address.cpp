#include "tools/import/points/address.hpp"

#include <algorithm>

#include "tools/import/points/types.hpp"
#include "tools/import/text/table.hpp"

namespace fieldcast::importing {
namespace {

constexpr Words<ModbusArea> kWords[] = {
    {"coil coils coilstatus do 0x digitaloutput discreteoutput outputcoil digitalausgang "
     "spule spulen",
     ModbusArea::kCoil},
    {"discrete discreteinput discreteinputs inputstatus digitalinput inputbit "
     "digitaleingang diskretereingang di 1x",
     ModbusArea::kInput},
    {"input inputs inputregister inputregisters inputreg analoginput analogeingang "
     "eingangsregister ir ai 3x",
     ModbusArea::kInputRegister},
    {"holding holdings holdingregister holdingregisters holdingreg analogoutput "
     "analogausgang halteregister presetmultipleregisters presetsingleregister "
     "writemultipleregisters writesingleregister hr ao 4x register registers",
     ModbusArea::kHolding}};

constexpr Words<ModbusArea> kParts[] = {{"holding halteregister", ModbusArea::kHolding},
                                        {"inputreg eingangsregister", ModbusArea::kInputRegister},
                                        {"discretein discretestat", ModbusArea::kInput},
                                        {"coil", ModbusArea::kCoil}};
constexpr Words<ModbusArea> kFunctions[] = {{"1 5 15", ModbusArea::kCoil},
                                            {"2", ModbusArea::kInput},
                                            {"4", ModbusArea::kInputRegister},
                                            {"3 6 16 22 23", ModbusArea::kHolding}};

std::optional<ModbusArea> area_of_function(std::string_view number) {
  return value_of(kFunctions, std::to_string(whole_from(number).value_or(0)));
}

bool is_access(std::string_view word) {
  return word.empty() || is_one_of(word, "r w rw ro wo read write");
}

std::size_t leading_digits(std::string_view text) {
  return std::min(text.find_first_not_of("0123456789"), text.size());
}

// "3", "03", "0x03", "10h", "03read".
std::optional<ModbusArea> area_of_number(std::string_view word) {
  if (word.starts_with("0x") || word.ends_with('h')) return area_of_function(word);
  const std::size_t end = leading_digits(word);
  if (end == 0 || !is_access(word.substr(end))) return std::nullopt;
  return area_of_function(word.substr(0, end));
}

// Finds a table name inside the word; empty if it contains two.
std::optional<ModbusArea> area_inside(std::string_view word) {
  std::optional<ModbusArea> found;
  for (const auto& [parts, area] : kParts) {
    const auto inside = [&](std::string_view part) { return contains(word, part); };
    if (std::ranges::none_of(split(parts, ' '), inside)) continue;
    if (found) return std::nullopt;
    found = area;
  }
  // "Read Input Registers (04)", "3 (Holding register)": the function must agree.
  const std::size_t last = word.find_last_not_of("0123456789");
  for (const auto digits : {word.substr(0, leading_digits(word)), word.substr(last + 1)}) {
    const auto area = area_of_function(digits);
    if (found && area && digits.size() <= 2 && *area != *found) return std::nullopt;
  }
  return found;
}

std::optional<ModbusArea> area_of_word(std::string_view word) {
  if (word.starts_with("modbus") && word.size() > 6) word.remove_prefix(6);
  for (const std::string_view begin : {"functioncode", "function", "funktion", "fc", "fn", "f"}) {
    if (word.size() > begin.size() && word.starts_with(begin) && is_digit(word[begin.size()]))
      word.remove_prefix(begin.size());
  }
  if (const auto known = value_of(kWords, word)) return known;
  const auto number = area_of_number(word);
  return number ? number : area_inside(word);
}

using Parsed = Result<Reference>;

Parsed counted(std::optional<ModbusArea> area, std::string_view digits, unsigned base) {
  const auto number = whole_from(digits, 0, 65535 + base);
  if (!number) return refused("'{}' is no number from {} to {}", digits, base, 65535 + base);
  if (*number < base) return refused("references count from 1");
  return Reference{area, static_cast<std::uint32_t>(*number - base), {}};
}

Parsed offset(std::optional<ModbusArea> area, std::string_view digits) {
  const auto number = whole_from(digits, 0, 65535);
  if (!number) return refused("'{}' is no address from 0 to 65535", digits);
  return Reference{area, static_cast<std::uint32_t>(*number), {}};
}

Parsed without_bit(std::string_view text, unsigned base) {
  constexpr std::pair<std::string_view, ModbusArea> kIec[] = {{"%MW", ModbusArea::kHolding},
                                                              {"%IW", ModbusArea::kInputRegister},
                                                              {"%M", ModbusArea::kCoil},
                                                              {"%I", ModbusArea::kInput}};
  for (const auto& [begin, area] : kIec) {
    if (text.starts_with(begin)) return offset(area, text.substr(begin.size()));
  }
  // "4x0101", "4:101", "3-0007", "40101"
  const bool marked = text.size() > 2 && contains("xX:-", text.substr(1, 1)) &&
                      !text.starts_with("0x") && !text.starts_with("0X");
  if (marked || (all_digits(text) && (text.size() == 5 || text.size() == 6))) {
    if (const auto area = area_of_digit(text[0]))
      return counted(area, text.substr(marked ? 2 : 1), base);
  }
  const std::size_t digit = text.find_first_of("0123456789");
  if (digit != std::string_view::npos && digit > 1) {
    std::string_view word = text.substr(0, digit);
    word = word.substr(0, word.find_last_not_of(" :_-#") + 1);
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

std::optional<ModbusArea> area_of_digit(char digit) {
  const std::size_t area = std::string_view("0134").find(digit);
  return area < 4 ? std::optional(static_cast<ModbusArea>(area)) : std::nullopt;
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
  return !word.empty() && !is_digit(word[0]) && area_by_name(name);
}

Slave slave_from(std::string_view text) {
  text = trimmed(text);
  if (text.empty()) return std::nullopt;
  const auto number = whole_from(text, 0, 65535);
  if (!number) return refused("'{}' is no address of a device on its bus", text);
  return static_cast<std::uint16_t>(*number);
}

Result<Reference> reference_from(std::string_view text, unsigned base) {
  text = trimmed(text);
  if (text.empty()) return refused("no address");
  const auto [place, bit_text] = halves(text, '.');
  auto reference = without_bit(trimmed(place), base);
  if (!reference || place.size() == text.size()) return reference;
  const auto bit = whole_from(bit_text, 0, 15);
  if (!bit) return refused("bit '{}' is not 0 to 15", bit_text);
  reference->bit = static_cast<std::uint8_t>(*bit);
  return reference;
}

void append_points(std::vector<Point>& points, Point point, ModbusArea area, std::uint32_t address,
                   unsigned elements) {
  if (elements == 0) return points.push_back(std::move(point));
  const unsigned step = holds_bits(area) ? 1 : registers_of(point.type, point.string_bytes);
  for (unsigned i = 0; i < elements && points.size() <= kMaxPoints; ++i) {
    Point& element = points.emplace_back(point);
    element.name = fmt::format("{}-{}", point.name, i);
    element.at = address_text(area, address + std::uint64_t{i} * step);
    element.change("element {} of an array of {}", i, elements);
  }
}

}  // namespace fieldcast::importing
