#include "core/protocol/allen_bradley_df1/areas.hpp"

#include <algorithm>
#include <string>

#include "core/base/message_text.hpp"

namespace fieldcast::df1 {
namespace {

constexpr auto kInt16 = ValueType::kInt16, kInt32 = ValueType::kInt32, kFloat = ValueType::kFloat32;
constexpr std::uint32_t kFiles = 256, kStatusWords = 256, kThree = 3 * kElements;
// Name, code, bits of an item, only file, bank, words of an element, by slot, writable, type.
constexpr FileRow kRows[] = {
    {"N", 0x89, 16, {}, kElements, 1, false, true, {}},
    {"B", 0x85, 16, {}, kElements, 1, false, true, {}},
    {"F", 0x8A, 32, {}, kElements, 1, false, true, kFloat},
    {"L", 0x91, 32, {}, kElements, 1, false, true, kInt32},
    {"T", 0x86, 16, {}, kThree, 3, false, true, kInt16},
    {"C", 0x87, 16, {}, kThree, 3, false, true, kInt16},
    {"R", 0x88, 16, {}, kThree, 3, false, true, kInt16},
    {"S", 0x84, 16, 2, kStatusWords, 1, false, true, {}},
    {"O", 0x8B, 16, 0, kSlotWords, 1, true, false, {}},
    {"I", 0x8C, 16, 1, kSlotWords, 1, true, false, {}},
};

// A part of a timer, counter or control: a word, or a bit of the control word.
struct Part {
  std::string_view files;  // letters of its files
  std::string_view name;
  std::uint8_t word = 0;
  std::optional<std::uint8_t> bit{};
};
constexpr Part kParts[] = {
    {"TC", "PRE", 1, {}}, {"TC", "ACC", 2, {}}, {"R", "LEN", 1, {}},  {"R", "POS", 2, {}},
    {"TR", "EN", 0, 15},  {"T", "TT", 0, 14},   {"TCR", "DN", 0, 13}, {"C", "CU", 0, 15},
    {"C", "CD", 0, 14},   {"C", "OV", 0, 12},   {"C", "UN", 0, 11},   {"C", "UA", 0, 10},
    {"R", "EU", 0, 14},   {"R", "EM", 0, 12},   {"R", "ER", 0, 11},   {"R", "UL", 0, 10},
    {"R", "IN", 0, 9},    {"R", "FD", 0, 8},
};

constexpr AddressFaults address_fault{
    "N7:0, N7:0/3, B3:1/5, B3/21, F8:3, L9:0, T4:0.ACC, T4:0.PRE, T4:0/DN, C5:0.ACC, R6:0.POS, "
    "S:1/15, O:0.0, I:1.0/3"};

const Part* part_of(const FileRow& row, std::string_view name) {
  const auto found = std::ranges::find_if(kParts, [&](const Part& part) {
    return part.name == name && part.files.find(row.name) != std::string_view::npos;
  });
  return found == std::end(kParts) ? nullptr : &*found;
}

std::string parts_text(const FileRow& row) {
  std::string text;
  for (const Part& part : kParts) {
    if (part.files.find(row.name) != std::string_view::npos)
      text +=
          (text.empty() ? "" : ", ") + std::string(part.bit ? "/" : ".") + std::string(part.name);
  }
  return text;
}

// "N7:3.ACC/5": the pieces of an address. A piece that is not there is empty.
struct Pieces {
  std::string_view letters, file, element, dot, slash;
  bool has_dot = false, has_slash = false;
};
Pieces split(std::string_view at) {
  Pieces pieces;
  const auto cut = [&](char mark, std::string_view& into, bool* found) {
    const std::size_t where = at.rfind(mark);
    if (where == std::string_view::npos) return;
    into = at.substr(where + 1);
    at = at.substr(0, where);
    if (found != nullptr) *found = true;
  };
  cut('/', pieces.slash, &pieces.has_slash);
  cut('.', pieces.dot, &pieces.has_dot);
  cut(':', pieces.element, nullptr);
  const std::size_t digits = std::min(at.find_first_of("0123456789"), at.size());
  pieces.letters = at.substr(0, digits);
  pieces.file = at.substr(digits);
  return pieces;
}

class Parser {
 public:
  explicit Parser(std::string_view at) : at_(at), pieces_(split(at)) {}

  ParsedOrFault run() {
    const auto named = std::ranges::find(kRows, pieces_.letters, &FileRow::name);
    if (named == std::end(kRows)) return unknown();
    row_ = &*named;
    address_.area = static_cast<AreaIndex>(named - std::begin(kRows));
    auto file = number(pieces_.file);
    if (pieces_.file.empty() && row_->file) file = *row_->file;
    if (!file) return address_fault(in_quotes(at_) + " has no file number", with_file());
    if (*file >= kFiles || (row_->file && *file != *row_->file))
      return address_fault("file " + std::string(pieces_.letters) + in_text(*file) +
                           " does not exist");
    file_ = *file;
    // B3/21 is bit 5 of word 1.
    if (pieces_.element.empty() && row_->name == "B" && pieces_.has_slash && !pieces_.has_dot)
      return bit_of_file();
    const auto element = number(pieces_.element);
    if (!element) return address_fault(in_quotes(at_) + " has no element", with_file());
    if (*element >= (row_->by_slot ? kSlots : row_->bank / row_->words))
      return address_fault("element " + in_text(*element) + " does not exist");
    return row_->by_slot     ? word_of_slot(*element)
           : row_->words > 1 ? part_of_element(*element)
                             : item(*element);
  }

 private:
  static std::optional<std::uint32_t> number(std::string_view text) { return whole_number(text); }
  static std::string in_text(std::uint32_t number) { return std::to_string(number); }

  ParsedOrFault unknown() const {
    const std::string upper = upper_case(pieces_.letters);
    const bool known = std::ranges::find(kRows, upper, &FileRow::name) != std::end(kRows);
    return address_fault("file type " + in_quotes(pieces_.letters) + " is unknown",
                         known ? upper_case(at_) : "");
  }
  std::string with_file() const {
    constexpr std::string_view kFactory[] = {"N7", "B3", "F8", "L9", "T4", "C5", "R6", "S"};
    if (row_->by_slot) return std::string(row_->name) + ":0.0";
    const std::string rest = row_->words > 1 ? row_->name == "R" ? ".POS" : ".ACC" : "";
    return std::string(kFactory[address_.area]) + ':' +
           (number(pieces_.element) ? std::string(pieces_.element) : "0") + rest;
  }

  ParsedOrFault bit_of_file() {
    const auto bit = number(pieces_.slash);
    if (!bit || *bit >= kElements * 16)
      return address_fault("bit " + in_quotes(pieces_.slash) + " does not exist");
    address_.first = file_ * row_->bank + *bit / 16;
    (void)set_bit(address_, *bit % 16, 16);
    return address_;
  }

  ParsedOrFault item(std::uint32_t element) {
    if (pieces_.has_dot)
      return address_fault(
          in_quotes(at_) + " is not an address: bits follow a slash",
          std::string(at_.substr(0, at_.find('.'))) + '/' + std::string(pieces_.dot));
    address_.first = (row_->file ? 0 : file_ * row_->bank) + element;
    if (row_->item_bits != 16) address_.width_bits = row_->item_bits;
    return with_bit(row_->type == kFloat ? 0 : row_->item_bits);
  }

  ParsedOrFault part_of_element(std::uint32_t element) {
    const auto name = pieces_.has_dot ? pieces_.dot : pieces_.slash;
    const bool control_bit = !pieces_.has_dot && number(name).has_value();
    const Part* part = part_of(*row_, name);
    if (part == nullptr && !control_bit)
      return address_fault(
          "element " + std::string(at_.substr(0, at_.find_first_of("./"))) +
              (name.empty() ? " needs a part" : " has no part " + in_quotes(name)) + ": " +
              parts_text(*row_),
          with_file());
    address_.first = file_ * row_->bank + element * row_->words + (control_bit ? 0 : part->word);
    if (!control_bit && part->bit) {
      if (pieces_.has_dot && pieces_.has_slash) return no_bit(pieces_.slash);
      (void)set_bit(address_, *part->bit, 16);
      return address_;
    }
    return with_bit(16);
  }

  // I:1/17 is bit 1 of word 1.
  ParsedOrFault word_of_slot(std::uint32_t slot) {
    const auto word = pieces_.has_dot ? number(pieces_.dot) : 0;
    const auto bit = number(pieces_.slash);
    const bool long_bit = !pieces_.has_dot && bit && *bit < kSlotWords * 16;
    if (!word || *word >= kSlotWords)
      return address_fault("word " + in_quotes(pieces_.dot) + " does not exist");
    address_.first = slot * kSlotWords + (long_bit ? *bit / 16 : *word);
    if (!long_bit) return with_bit(16);
    (void)set_bit(address_, *bit % 16, 16);
    return address_;
  }

  ParsedOrFault with_bit(unsigned bits) {
    if (pieces_.has_slash && !set_bit(address_, number(pieces_.slash), bits))
      return no_bit(pieces_.slash);
    return address_;
  }
  ParsedOrFault no_bit(std::string_view bit) const {
    return address_fault("bit " + in_quotes(bit) + " does not exist",
                         std::string(at_.substr(0, at_.find('/'))));
  }

  const std::string_view at_;
  const Pieces pieces_;
  const FileRow* row_ = nullptr;
  std::uint32_t file_ = 0;
  ParsedAddress address_;
};

}  // namespace

std::span<const FileRow> file_rows() { return kRows; }

const FileRow* row_of_code(std::uint8_t code) {
  const auto found = std::ranges::find(kRows, code, &FileRow::code);
  return found == std::end(kRows) ? nullptr : &*found;
}

std::vector<Area> areas_of(std::uint32_t bytes) {
  std::vector<Area> areas;
  for (const FileRow& row : kRows) {
    const std::uint32_t each = row.item_bits / 8;
    Area area{.name = row.name, .item_bits = row.item_bits, .type = row.type};
    area.items = row.by_slot ? kSlots * row.bank : row.file ? row.bank : kFiles * row.bank;
    area.bank = row.bank;
    const std::uint32_t most = bytes / (each * row.words) * row.words;
    area.max_read = static_cast<std::uint16_t>(row.by_slot ? std::min(most, kSlotWords) : most);
    area.writable = row.writable;
    // One word of a timer, counter or control, so that the others keep counting.
    const std::uint32_t most_written = row.words > 1 ? 1 : std::min(bytes, kMaxWrite) / each;
    area.max_write = static_cast<std::uint16_t>(row.writable ? most_written : 0);
    area.alignment = static_cast<std::uint16_t>(row.words);
    area.bit_write = row.writable && row.item_bits == 16;
    // COP copies a float to two words of N with its low word first.
    if (row.item_bits == 16) area.word_order = WordOrder::kLittleEndian;
    areas.push_back(area);
  }
  return areas;
}

Place place_of(const FileRow& row, const Range& range, bool write) {
  Place place{.bytes = range.count * row.item_bits / 8};
  place.file = row.file ? *row.file : range.first / row.bank;
  const std::uint32_t in_bank = range.first % row.bank;
  if (row.by_slot) {
    place.element = range.first / row.bank;
    place.sub = in_bank;
    return place;
  }
  place.element = in_bank / row.words;
  if (row.words == 1) return place;
  if (write) {
    place.sub = in_bank % row.words;
  } else {
    const std::uint32_t end = (in_bank + range.count + row.words - 1) / row.words;
    place.bytes = (end - place.element) * row.words * 2;
  }
  return place;
}

ParsedOrFault parse_address(std::string_view at) { return Parser(at).run(); }

std::string text_of(const FileRow& row, const Place& place) {
  std::string text(row.name);
  if (!row.file) text += std::to_string(place.file);
  text += ':' + std::to_string(place.element);
  if (row.by_slot || place.sub > 0) text += '.' + std::to_string(place.sub);
  return text;
}

}  // namespace fieldcast::df1
