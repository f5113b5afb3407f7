#include "tools/cli/direct/meanings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>

#include "tools/cli/model/command_text.hpp"
#include "tools/cli/model/sample_text.hpp"

namespace fieldcast::cli {

std::optional<std::string> address_behind(const Protocol& protocol, std::string_view at,
                                          std::uint32_t items) {
  if (items == 0) return std::string(at);
  const auto from = protocol.parse_address(at);
  const std::size_t before = at.find_last_not_of("0123456789");
  const std::size_t digits = before == std::string_view::npos ? 0 : before + 1;
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(at.data() + digits, at.data() + at.size(), number);
  if (!from || error != std::errc{}) return std::nullopt;
  std::string text = std::to_string(number + items);
  const std::size_t width = at.size() - digits;
  if (text.size() < width) text.insert(0, width - text.size(), '0');
  text.insert(0, at.substr(0, digits));
  const auto behind = protocol.parse_address(text);
  const bool right = behind && behind->area == from->area && behind->bit == from->bit &&
                     behind->first == from->first + items;
  return right ? std::optional(std::move(text)) : std::nullopt;
}

std::uint32_t values_in_request(const Protocol& protocol, const ParsedAddress& at,
                                std::uint32_t value_items) {
  const Area& area = protocol.areas()[at.area];
  std::uint32_t values = std::max(1u, area.max_read / value_items);
  const auto fits = [&](std::uint32_t count) {
    return protocol.size(ReadRequest{{{at.area, at.first, count * value_items}}}).has_value();
  };
  while (values > 1 && !fits(values)) --values;
  return values;
}

namespace {

constexpr auto kSwapped = WordOrder::kLittleEndian;
constexpr auto kBytesSwapped = ByteOrder::kLittleEndian;

void add_orders(const Encoding& encoding, std::vector<Meaning>& out) {
  const std::string type = to_text(encoding);
  const auto add = [&](const char* order, WordOrder words, ByteOrder bytes) {
    Meaning meaning{type + order, encoding};
    meaning.encoding.word_order = words;
    meaning.encoding.byte_order = bytes;
    out.push_back(std::move(meaning));
  };
  add("", WordOrder::kBigEndian, ByteOrder::kBigEndian);
  const unsigned bits = width_bits(encoding);
  if (bits <= 8) return;
  const bool words = bits > 16 && !encoding.is_text();
  if (words) add(" words swapped", kSwapped, ByteOrder::kBigEndian);
  add(" bytes swapped", WordOrder::kBigEndian, kBytesSwapped);
  if (words) add(" both swapped", kSwapped, kBytesSwapped);
}

std::optional<std::string> value_at(const Meaning& meaning, unsigned item_bits, ByteView image) {
  const std::size_t bytes = image_bytes(item_bits, item_count(meaning.encoding, item_bits));
  if (image.size() < bytes) return std::nullopt;
  const auto value = decode_value(meaning.encoding, item_bits, image.first(bytes));
  return value ? value_text(*value, to_text(meaning.encoding.type)) : "-";
}

}  // namespace

tl::expected<std::vector<Meaning>, std::string> meanings_of(std::string_view types) {
  std::vector<Meaning> meanings;
  if (types == "all") {
    for (const ValueType type : plain_types()) {
      if (type != ValueType::kBool) add_orders(Encoding{type}, meanings);
    }
    return meanings;
  }
  while (true) {
    const auto comma = types.find(',');
    const auto encoding = parse_type(types.substr(0, comma));
    if (!encoding) return tl::unexpected(encoding.error());
    add_orders(*encoding, meanings);
    if (comma == std::string_view::npos) return meanings;
    types.remove_prefix(comma + 1);
  }
}

std::vector<std::string> meaning_lines(std::span<const std::string> addresses, unsigned item_bits,
                                       ByteView image, std::span<const Meaning> meanings,
                                       const Screen& screen) {
  std::vector<std::string> lines;
  const std::size_t item_bytes = image_bytes(item_bits, 1);
  const std::size_t items = image.size() / item_bytes;
  for (std::size_t item = 0; item < items; ++item) {
    const ByteView rest = image.subspan(item * item_bytes);
    lines.push_back(painted(fmt::format("{}  {}", item < addresses.size() ? addresses[item] : "",
                                        to_hex(rest.first(item_bytes))),
                            Tone::kTitle, screen.colour));
    for (const Meaning& meaning : meanings) {
      if (auto text = value_at(meaning, item_bits, rest))
        lines.push_back(fmt::format("  {:<24} {}", meaning.name, printable(*text)));
    }
  }
  return lines;
}

}  // namespace fieldcast::cli
