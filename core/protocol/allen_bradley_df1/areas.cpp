#include "core/protocol/allen_bradley_df1/areas.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace fieldcast::df1 {
namespace {

constexpr auto kInt16 = ValueType::kInt16;
constexpr std::uint32_t kFiles = 256;
// Name, code, bits of an item, type; words of an element, only file, elements.
constexpr FileRow kRows[] = {
    {"N", 0x89, 16, {}},
    {"B", 0x85, 16, {}},
    {"F", 0x8A, 32, ValueType::kFloat32},
    {"L", 0x91, 32, ValueType::kInt32},
    {"T", 0x86, 16, kInt16, 3},
    {"C", 0x87, 16, kInt16, 3},
    {"R", 0x88, 16, kInt16, 3},
    {"S", 0x84, 16, {}, 1, 2, 256},
    {"O", 0x8B, 16, {}, 32, 0, 31},
    {"I", 0x8C, 16, {}, 32, 1, 31},
};

// Parts of a timer, counter or control: words, and bits of the control word from bit 15 downwards.
struct Parts {
  std::string_view file;
  std::array<std::string_view, 3> words;
  std::array<std::string_view, 8> bits;
};
constexpr Parts kParts[] = {
    {"T", {"", "PRE", "ACC"}, {"EN", "TT", "DN"}},
    {"C", {"", "PRE", "ACC"}, {"CU", "CD", "DN", "OV", "UN", "UA"}},
    {"R", {"", "LEN", "POS"}, {"EN", "EU", "DN", "EM", "ER", "UL", "IN", "FD"}}};

constexpr AddressFaults address_fault{
    "N7:0, N7:0/3, B3:1/5, B3/21, F8:3, L9:0, T4:0.ACC, T4:0.PRE, T4:0/DN, C5:0.ACC, R6:0.POS, "
    "S:1/15, O:0.0, I:1.0/3"};

// Cuts the text behind the mark off; empty without the mark.
std::optional<std::string_view> cut(std::string_view& at, char mark) {
  const std::size_t where = at.rfind(mark);
  if (where == std::string_view::npos) return std::nullopt;
  const std::string_view behind = at.substr(where + 1);
  at = at.substr(0, where);
  return behind;
}

// Word and bit of the part named behind the dot or the slash. Empty if there is no such part.
struct Piece {
  std::uint32_t word = 0;
  std::optional<std::uint32_t> bit;
};
std::optional<Piece> piece_of(const FileRow& row, std::optional<std::string_view> dot,
                              std::optional<std::string_view> slash) {
  Piece piece;
  if (slash) piece.bit = whole_number(*slash);
  if (row.by_slot()) {
    const auto word = dot ? whole_number(*dot) : piece.bit.value_or(0) / 16;  // I:1/17 is I:1.1/1
    if (!word || *word >= row.words || (slash && !piece.bit)) return std::nullopt;
    if (!dot && piece.bit) piece.bit = *piece.bit % 16;
    return Piece{*word, piece.bit};
  }
  if (row.words == 1) return dot || (slash && !piece.bit) ? std::nullopt : std::optional(piece);
  if (!dot && piece.bit) return piece;  // of the control word
  const Parts& parts = *std::ranges::find(kParts, row.name, &Parts::file);
  const std::string_view name = dot ? *dot : slash.value_or("");
  if (name.empty()) return std::nullopt;
  const auto word = std::ranges::find(parts.words, name) - parts.words.begin();
  const auto bit = std::ranges::find(parts.bits, name) - parts.bits.begin();
  if (bit < 8) return dot && slash ? std::nullopt : std::optional(Piece{0, 15 - bit});
  if (word == 3 || (slash && !piece.bit)) return std::nullopt;
  return Piece{static_cast<std::uint32_t>(word), piece.bit};
}

}  // namespace

std::span<const FileRow> file_rows() { return kRows; }

std::vector<Area> areas_of(std::uint32_t bytes) {
  std::vector<Area> areas;
  for (const FileRow& row : kRows) {
    const bool parts = row.words == 3;
    Area area{.name = row.name, .item_bits = row.item_bits, .type = row.type};
    area.items = row.file_items() * (row.file ? 1 : kFiles);
    area.bank = row.by_slot() ? row.words : row.file_items();
    const std::uint32_t most = bytes / (row.item_bits / 8);
    area.max_read = static_cast<std::uint16_t>(parts ? most / 3 * 3 : std::min(most, area.bank));
    area.writable = !row.by_slot();
    // One word of a timer, counter or control, so that the others keep counting.
    const std::uint32_t write = parts ? 1 : std::min(bytes, kMaxWrite) / (row.item_bits / 8);
    area.max_write = static_cast<std::uint16_t>(area.writable ? write : 0);
    area.alignment = parts ? 3 : 1;
    area.bit_write = area.writable && row.item_bits == 16;
    // COP copies a float to two words of N with its low word first.
    if (row.item_bits == 16) area.word_order = WordOrder::kLittleEndian;
    areas.push_back(area);
  }
  return areas;
}

Place place_of(const FileRow& row, const Range& range, bool write) {
  const std::uint32_t first = row.file ? range.first : range.first % row.file_items();
  Place place{range.count * row.item_bits / 8, row.file.value_or(0), first / row.words,
              first % row.words};
  if (!row.file) place.file = range.first / row.file_items();
  if (row.words != 3 || write) return place;
  place.bytes = (place.sub + range.count + 2) / 3 * 6;
  place.sub = 0;
  return place;
}

ParsedOrFault parse_address(std::string_view at) {
  const std::string whole(at);
  const auto slash = cut(at, '/'), dot = cut(at, '.'), number = cut(at, ':');
  const std::size_t letters = std::min(at.find_first_of("0123456789"), at.size());
  const auto row = std::ranges::find(kRows, at.substr(0, letters), &FileRow::name);
  if (row == std::end(kRows))
    return address_fault("file type " + in_quotes(at.substr(0, letters)) + " is unknown",
                         upper_case(whole));
  auto file = whole_number(at.substr(letters));
  if (letters == at.size() && row->file) file = *row->file;
  if (!file || *file >= kFiles || (row->file && *file != *row->file))
    return address_fault(in_quotes(at) + " is not a file: a number 0..255 follows the letters");
  std::uint32_t element = number ? whole_number(*number).value_or(UINT32_MAX) : UINT32_MAX;
  auto piece = piece_of(*row, dot, slash);
  if (!number && !dot && row->name == "B" && piece && piece->bit) {  // B3/21 is B3:1/5
    element = *piece->bit / 16;
    piece->bit = *piece->bit % 16;
  }
  if (element >= row->elements)
    return address_fault(in_quotes(whole) + " has no element 0.." +
                         std::to_string(row->elements - 1));
  const std::string before = whole.substr(0, whole.find_first_of("./"));
  if (!piece)
    return address_fault(in_quotes(whole) + " is not a word or a bit of " + before,
                         row->words == 3 ? before + (row->name == "R" ? ".POS" : ".ACC")
                         : dot           ? before + '/' + std::string(*dot)
                                         : before);
  ParsedAddress address{.area = static_cast<AreaIndex>(row - std::begin(kRows))};
  address.first = (row->file ? 0 : *file * row->file_items()) + element * row->words + piece->word;
  if (row->item_bits != 16) address.width_bits = row->item_bits;
  const unsigned bits = row->type == ValueType::kFloat32 ? 0 : row->item_bits;
  if (piece->bit && !set_bit(address, piece->bit, bits))
    return address_fault("bit " + std::to_string(*piece->bit) + " of " + before + " does not exist",
                         before);
  return address;
}

}  // namespace fieldcast::df1
