#include <algorithm>
#include <optional>
#include <string>

#include "core/base/message_text.hpp"
#include "core/protocol/modbus/areas.hpp"
#include "core/protocol/option_reader.hpp"

namespace fieldcast::modbus {
namespace {

constexpr std::uint32_t kLastAddress = 65535;
constexpr std::string_view kAllowed =
    "coil:N, input:N, holding:N, holding:N.BIT, input-register:N with N 0..65535 (or 0x0..0xFFFF) "
    "and BIT 0..15, file:F:R, id:N, id:basic, fifo:N, or a reference 00001.., 10001.., 30001.., "
    "40001.. "
    "(counted from 1)";
constexpr std::string_view kRecordAllowed =
    "file:F:R, file:F:R.BIT with F 1..65535, R 0..9999 and BIT 0..15";
constexpr std::string_view kObjectAllowed = "id:N with N 0..6 or 128..255, or id:basic";
constexpr std::string_view kQueueAllowed =
    "fifo:N (count of the queue), fifo:N:P, fifo:N:P.BIT with N 0..65535, P 1..31 and BIT 0..15";

struct Word {
  std::string_view name;
  Table table;
};
constexpr std::array kWords{Word{"coil", Table::kCoil},
                            Word{"input", Table::kInput},
                            Word{"discrete-input", Table::kInput},
                            Word{"holding", Table::kHolding},
                            Word{"input-register", Table::kInputRegister},
                            Word{"file", Table::kFile},
                            Word{"id", Table::kIdentity},
                            Word{"fifo", Table::kFifo}};
// Spellings of other tools; only used for the suggestion.
constexpr std::array kHabits{Word{"coils", Table::kCoil},
                             Word{"inputs", Table::kInput},
                             Word{"discrete", Table::kInput},
                             Word{"di", Table::kInput},
                             Word{"hr", Table::kHolding},
                             Word{"holding-register", Table::kHolding},
                             Word{"holding_register", Table::kHolding},
                             Word{"register", Table::kHolding},
                             Word{"ir", Table::kInputRegister},
                             Word{"input_register", Table::kInputRegister}};

std::string_view name_of(Table table) { return areas(false)[static_cast<std::size_t>(table)].name; }
bool holds_bits(Table table) { return table == Table::kCoil || table == Table::kInput; }

// "46h", "46H", "0x46", "$46": hexadecimal notation of data sheets and other programs.
std::optional<std::string> as_hexadecimal(std::string_view text) {
  const bool marked = text.starts_with("0x") || text.starts_with("0X");
  const bool behind = text.ends_with('h') || text.ends_with('H');
  const bool before = text.starts_with('$') || text.starts_with('#');
  if (!marked && !behind && !before) return std::nullopt;
  const auto digits = marked   ? text.substr(2)
                      : behind ? text.substr(0, text.size() - 1)
                               : text.substr(1);
  if (!whole_number(digits, 16)) return std::nullopt;
  return "0x" + std::string(digits);
}

constexpr AddressFaults address_fault{kAllowed}, record_fault{kRecordAllowed},
    object_fault{kObjectAllowed}, queue_fault{kQueueAllowed};

std::optional<std::uint32_t> number(std::string_view text) {
  const bool hex = text.starts_with("0x") || text.starts_with("0X");
  return hex ? whole_number(text.substr(2), 16) : whole_number(text);
}

ParsedAddress address(Table table, std::uint32_t first, std::optional<std::uint8_t> bit = {}) {
  ParsedAddress parsed{.area = static_cast<AreaIndex>(table), .first = first, .bit = bit};
  if (holds_bits(table) || bit) parsed.width_bits = 1;
  return parsed;
}

std::string suggest_area(std::string_view area, std::string_view rest) {
  for (const Word& habit : kHabits) {
    if (habit.name == area) return std::string(name_of(habit.table)) + ":" + std::string(rest);
  }
  std::array<std::string_view, kWords.size()> names;
  std::transform(kWords.begin(), kWords.end(), names.begin(),
                 [](const Word& word) { return word.name; });
  const std::string_view near = near_miss(area, names);
  return near.empty() ? std::string{}
                      : std::string(near) + ":" + std::string(rest.empty() ? "0" : rest);
}

std::optional<std::uint8_t> bit_of_word(std::string_view text) {
  const auto bit = number(text);
  return bit && *bit <= 15 ? std::optional(static_cast<std::uint8_t>(*bit)) : std::nullopt;
}
ParsedOrFault bit_fault(const AddressFaults& fault, std::string_view bit,
                        const std::string& whole) {
  return fault("bit " + in_quotes(bit) + " is not 0..15", whole + ".0");
}

// "4:7", "4:7.3": record 7 of file 4.
ParsedOrFault parse_record(std::string_view rest) {
  const std::size_t colon = rest.find(':');
  const std::string_view file_text = rest.substr(0, colon);
  const auto file = number(file_text);
  if (!file || *file == 0 || *file >= kFiles)
    return record_fault("file " + in_quotes(file_text) + " is not 1..65535", "file:1:0");
  const std::string prefix = "file:" + std::string(file_text) + ":";
  if (colon == std::string_view::npos)
    return record_fault("file " + in_quotes(file_text) + " without a record", prefix + "0");
  const std::string_view place = rest.substr(colon + 1);
  const std::size_t dot = place.find('.');
  const auto record = number(place.substr(0, dot));
  if (!record || *record >= kRecords)
    return record_fault("record " + in_quotes(place.substr(0, dot)) + " is not 0..9999",
                        prefix + "0");
  const std::uint32_t first = *file * kRecords + *record;
  if (dot == std::string_view::npos) return address(Table::kFile, first);
  const auto bit = bit_of_word(place.substr(dot + 1));
  if (!bit)
    return bit_fault(record_fault, place.substr(dot + 1),
                     prefix + std::string(place.substr(0, dot)));
  return address(Table::kFile, first, bit);
}

// "0": vendor. Objects 7..127 are reserved (V1.1b3, 6.21).
ParsedOrFault parse_object(std::string_view rest) {
  const auto object = rest == "basic" ? std::optional(kBasicObjects) : number(rest);
  if (!object || *object >= kObjects || (*object > 6 && *object < 128 && rest != "basic"))
    return object_fault("object " + in_quotes(rest) + " is not 0..6 or 128..255", "id:0");
  ParsedAddress parsed = address(Table::kIdentity, *object * kObjectCharacters);
  parsed.text_characters = kObjectCharacters;
  return parsed;
}

// "1246": the count; "1246:1", "1246:1.5": its first register.
ParsedOrFault parse_queue(std::string_view rest) {
  const std::size_t colon = rest.find(':');
  const std::string pointer_text(rest.substr(0, colon));
  const auto pointer = number(pointer_text);
  if (!pointer || *pointer > kLastAddress)
    return queue_fault("pointer " + in_quotes(pointer_text) + " is not 0..65535", "fifo:0");
  const std::uint32_t first = *pointer * kQueueItems;
  if (colon == std::string_view::npos) return address(Table::kFifo, first);
  const std::string_view place = rest.substr(colon + 1);
  const std::size_t dot = place.find('.');
  const std::string position_text(place.substr(0, dot));
  const auto position = number(position_text);
  const std::string prefix = "fifo:" + pointer_text + ":";
  if (!position || *position == 0 || *position > kMaxQueued)
    return queue_fault("position " + in_quotes(position_text) + " is not 1..31", prefix + "1");
  if (dot == std::string_view::npos) return address(Table::kFifo, first + *position);
  const auto bit = bit_of_word(place.substr(dot + 1));
  if (!bit) return bit_fault(queue_fault, place.substr(dot + 1), prefix + position_text);
  return address(Table::kFifo, first + *position, bit);
}

// "holding:100.5".
ParsedOrFault parse_named(std::string_view area, std::string_view rest) {
  const auto word =
      std::ranges::find_if(kWords, [&](const Word& candidate) { return candidate.name == area; });
  if (word == kWords.end())
    return address_fault("area " + in_quotes(area) + " is unknown", suggest_area(area, rest));
  if (word->table == Table::kFile) return parse_record(rest);
  if (word->table == Table::kIdentity) return parse_object(rest);
  if (word->table == Table::kFifo) return parse_queue(rest);

  const std::size_t dot = rest.find('.');
  const auto first = number(rest.substr(0, dot));
  const std::string prefix = std::string(word->name) + ":";
  if (!first)
    return address_fault(in_quotes(rest.substr(0, dot)) + " is no number",
                         prefix + as_hexadecimal(rest.substr(0, dot)).value_or("0"));
  if (*first > kLastAddress)
    return address_fault("address " + in_quotes(rest.substr(0, dot)) + " is beyond 65535",
                         prefix + "65535");
  if (dot == std::string_view::npos) return address(word->table, *first);

  const std::string whole = prefix + std::string(rest.substr(0, dot));
  if (holds_bits(word->table))
    return address_fault("a " + std::string(word->name) + " is a bit itself and has no bits",
                         whole);
  const auto bit = bit_of_word(rest.substr(dot + 1));
  if (!bit) return bit_fault(address_fault, rest.substr(dot + 1), whole);
  return address(word->table, *first, bit);
}

// "40101": the first digit is the table, the others count from 1. A bit may follow a dot.
ParsedOrFault parse_reference(std::string_view at) {
  const std::size_t dot = at.find('.');
  const std::string_view digits = at.substr(0, dot);
  if (digits.size() != 5 && digits.size() != 6) {
    std::string near = digits.size() < 5 ? "holding:" + std::string(digits) : std::string{};
    return address_fault("reference " + in_quotes(digits) + " has not 5 or 6 digits",
                         std::move(near));
  }
  Table table{};
  switch (digits.front()) {
    case '0': table = Table::kCoil; break;
    case '1': table = Table::kInput; break;
    case '3': table = Table::kInputRegister; break;
    case '4': table = Table::kHolding; break;
    default:
      return address_fault("reference " + in_quotes(digits) + " does not begin with 0, 1, 3 or 4");
  }
  const std::uint32_t counted = *number(digits.substr(1));
  if (counted == 0)
    return address_fault("references count from 1",
                         std::string(digits.substr(0, digits.size() - 1)) + "1");
  if (counted > kLastAddress + 1)
    return address_fault("reference " + in_quotes(digits) + " is beyond " + digits.front() +
                         "65536");
  if (dot == std::string_view::npos) return address(table, counted - 1);
  return parse_named(name_of(table), std::to_string(counted - 1) + std::string(at.substr(dot)));
}

}  // namespace

ParsedOrFault parse_address(std::string_view at) {
  if (const std::size_t colon = at.find(':'); colon != std::string_view::npos) {
    return parse_named(at.substr(0, colon), at.substr(colon + 1));
  }
  const std::size_t digits = at.find_first_not_of("0123456789");
  const std::string_view number_part = at.substr(0, digits);
  if (!number_part.empty() && (number_part.size() == at.size() || at[number_part.size()] == '.'))
    return parse_reference(at);
  if (const auto hex = as_hexadecimal(at))
    return address_fault(in_quotes(at) + " names no area", "holding:" + *hex);
  // "4x0071" is a reference with an x; "%MW70" and "%M3" are words and bits of IEC 61131.
  if (at.size() > 2 && (at[1] == 'x' || at[1] == 'X') && at[0] > '0' && at[0] < '5') {
    const auto counted = whole_number(at.substr(2));
    std::string counted_text = std::to_string(counted.value_or(0));
    if (counted_text.size() < 4) counted_text.insert(0, 4 - counted_text.size(), '0');
    return address_fault(in_quotes(at) + " is no address", at[0] + counted_text);
  }
  for (const Word& word : {Word{"%MW", Table::kHolding}, Word{"%IW", Table::kInputRegister},
                           Word{"%M", Table::kCoil}, Word{"%I", Table::kInput}}) {
    if (at.starts_with(word.name))
      return address_fault(
          in_quotes(at) + " is no address",
          std::string(name_of(word.table)) + ":" + std::string(at.substr(word.name.size())));
  }
  // "holding100": the colon is missing.
  const std::size_t first_digit = at.find_first_of("0123456789");
  if (first_digit != std::string_view::npos && first_digit > 0) {
    const std::string near = suggest_area(at.substr(0, first_digit), at.substr(first_digit));
    return address_fault(in_quotes(at) + " is no address", near);
  }
  return address_fault(in_quotes(at) + " is no address");
}

}  // namespace fieldcast::modbus
