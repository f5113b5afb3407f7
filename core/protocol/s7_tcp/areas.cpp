#include "core/protocol/s7_tcp/areas.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "core/protocol/option_reader.hpp"

namespace fieldcast::s7_tcp {
namespace {

constexpr AddressFaults address_fault{
    "DB10.DBB20, DB10.DBW20, DB10.DBD20, DB10.DBL20, DB10.DBS20 (a STRING), DB10.DTL20, "
    "DB10.DT20 (a DATE_AND_TIME), DB10.DBX20.3; MB4, MW4, MD4, ML4, M4.3 and likewise I, Q, PI; "
    "T5, C5"};

// B, W, D and L as in IEC 61131-3, 6.5.5.
std::optional<unsigned> width_of(std::string_view letter) {
  static constexpr std::string_view kLetters = "BWDL";
  const std::size_t at = letter.size() == 1 ? kLetters.find(letter[0]) : std::string_view::npos;
  return at == std::string_view::npos ? std::nullopt : std::optional(8u << at);
}

struct Named {
  AreaIndex area = 0;
  unsigned width = 0;  // bits; 0: a bit or a number follows
  TextLayout text = TextLayout::kPlain;
};

std::optional<Named> named(std::span<const Area> areas, bool in_block, std::string_view letters) {
  if (in_block) {
    if (letters == "DBX") return Named{kDB};
    if (letters == "DBS") return Named{kDB, 0, TextLayout::kCounted};
    if (letters == "DTL") return Named{kDB, 0, TextLayout::kDtl};
    if (letters == "DT") return Named{kDB, 0, TextLayout::kDateAndTime};
    if (!letters.starts_with("DB")) return std::nullopt;
    const auto width = width_of(letters.substr(2));
    return width ? std::optional(Named{kDB, *width}) : std::nullopt;
  }
  for (AreaIndex area = kM; area < kAreaCount; ++area) {
    if (!letters.starts_with(areas[area].name)) continue;
    const std::string_view rest = letters.substr(areas[area].name.size());
    if (rest.empty()) return Named{area};
    if (const auto width = width_of(rest); width && !kCodes[area].counted)
      return Named{area, *width};
  }
  return std::nullopt;
}

// Accepts the percent sign of TIA Portal, the German names, lower case, and DB10.W20.
std::string suggestion(std::string_view at) {
  std::string upper = upper_case(at);
  if (upper.starts_with("%")) upper.erase(0, 1);
  std::ranges::replace(upper, ',', '.');
  if (upper.starts_with("DB")) {
    const std::size_t dot = upper.find('.');
    if (dot != std::string::npos && upper.compare(dot + 1, 2, "DB") != 0 &&
        upper.compare(dot + 1, 2, "DT") != 0)
      upper.insert(dot + 1, "DB");
    return upper;
  }
  const std::size_t area = upper.starts_with("PE") || upper.starts_with("PA") ? 1 : 0;
  if (area < upper.size() && upper[area] == 'E') upper[area] = 'I';
  if (area < upper.size() && upper[area] == 'A') upper[area] = 'Q';
  if (upper.starts_with("Z")) upper[0] = 'C';
  return upper;
}

}  // namespace

ParsedOrFault parse_address(std::span<const Area> areas, std::string_view at) {
  const std::string near = suggestion(at);
  const auto fault = [&](std::string what) {
    return address_fault(std::move(what), near == at ? std::string() : near);
  };
  std::string_view rest = at;
  std::uint32_t first = 0;
  const std::size_t block_end = at.starts_with("DB") ? at.find('.') : std::string_view::npos;
  const bool in_block = block_end != std::string_view::npos;
  if (in_block) {
    const auto number = whole_number(at.substr(2, block_end - 2));
    if (!number || *number < 1 || *number > s7comm::kBlocks)
      return fault("data block " + in_quotes(at.substr(2, block_end - 2)) + " is not 1..65535");
    first = (*number - 1) * s7comm::kBlockBytes;
    rest = at.substr(block_end + 1);
  }
  const std::size_t digits = std::min(rest.find_first_of("0123456789"), rest.size());
  const auto name = named(areas, in_block, rest.substr(0, digits));
  if (!name) return fault("area " + in_quotes(rest.substr(0, digits)) + " is unknown");
  const std::size_t dot = std::min(rest.find('.'), rest.size());
  const auto number = whole_number(rest.substr(digits, dot - digits));
  if (!number) return fault(in_quotes(at) + " has no number");
  const std::uint32_t items = in_block ? s7comm::kBlockBytes : areas[name->area].items;
  const std::uint32_t last = name->width / 8;
  if (*number >= items || items - *number < last)
    return fault(in_quotes(at) + " is beyond the end of " +
                 (in_block ? "a data block" : std::string(areas[name->area].name)));
  ParsedAddress address{.area = name->area, .first = first + *number};
  const bool counted = kCodes[name->area].counted;
  const std::string_view bit = rest.substr(std::min(dot + 1, rest.size()));
  address.text_layout = name->text;
  const bool text = name->text != TextLayout::kPlain;
  if (is_date_time(name->text)) address.text_characters = date_time_characters(name->text);
  if (dot == rest.size() && text) return address;
  if (dot == rest.size()) {
    if (name->width == 0 && !counted)
      return address_fault(in_quotes(at) + " says neither a bit nor a width",
                           std::string(at) + ".0");
    if (!counted) address.width_bits = name->width;
    return address;
  }
  if (name->width != 0 || counted || text)
    return address_fault(in_quotes(at) + " has no bits",
                         std::string(at.substr(0, at.size() - bit.size() - 1)));
  if (!set_bit(address, whole_number(bit), 8))
    return address_fault("bit " + in_quotes(bit) + " is not 0..7",
                         std::string(at.substr(0, at.size() - bit.size())) + "0");
  return address;
}

}  // namespace fieldcast::s7_tcp
