#include "tools/sim/device/item_memory.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fieldcast::sim {

namespace {

bool is_signed(ValueType type) {
  return type == ValueType::kInt8 || type == ValueType::kInt16 || type == ValueType::kInt32 ||
         type == ValueType::kInt64;
}

bool is_byte(const Encoding& encoding) {
  return !encoding.is_text() && waveform_bits(encoding) == 8;
}

std::uint32_t items_for(const Encoding& encoding, unsigned width) {
  return (waveform_bits(encoding) + width - 1) / width;
}

// Bit items have no byte order.
Encoding in_bits(Encoding encoding) {
  encoding.word_order = WordOrder::kBigEndian;
  encoding.byte_order = ByteOrder::kBigEndian;
  return encoding;
}

// Pads to whole items: a text at the end, a number at the front with its sign.
Bytes image_of(const Encoding& encoding, const std::vector<std::uint16_t>& registers,
               unsigned width) {
  Bytes image;
  for (const std::uint16_t each : registers) append_u16(image, each);
  if (is_byte(encoding)) image.erase(image.begin());
  const std::size_t whole = std::size_t{items_for(encoding, width)} * width / 8;
  if (encoding.is_text()) {
    image.resize(whole);
  } else if (image.size() < whole) {
    const bool negative = is_signed(encoding.type) && (image[0] & 0x80u) != 0;
    image.insert(image.begin(), whole - image.size(), negative ? 0xFF : 0x00);
  }
  return image;
}

}  // namespace

ItemMemory::ItemMemory(std::vector<ItemArea> areas, const DeviceSetup& setup)
    : areas_(std::move(areas)),
      refused_(setup.refused),
      only_configured_(setup.only_configured),
      start_(setup.start),
      parts_(areas_.size()),
      written_(areas_.size()) {}

bool ItemMemory::add_channel(const ItemAddress& at, const Encoding& encoding,
                             const Waveform& waveform) {
  const ItemArea& area = areas_[at.area];
  const std::uint32_t count = items_for(encoding, area.bits);
  if (at.first >= area.items || count > area.items - at.first) return false;
  if (area.bits == 1 && (encoding.is_text() || at.bit)) return false;
  if (area.only_bools && encoding.type != ValueType::kBool) return false;
  ItemAddress address = at;
  if (!address.bit && area.bits > 1) address.bit = encoding.bit;
  const bool part = encoding.type == ValueType::kBool || (is_byte(encoding) && area.bits > 8);
  if (address.bit && (!part || *address.bit + waveform_bits(encoding) > area.bits)) return false;
  channels_.push_back({address, area.bits == 1 ? in_bits(encoding) : encoding, waveform});
  for (unsigned i = 0; i < count; ++i)
    parts_[at.area].emplace(at.first + i, Part{channels_.size() - 1, i});
  return true;
}

tl::expected<void, std::string> ItemMemory::add_channels(
    const DeviceSetup& setup,
    const std::function<std::optional<ItemAddress>(std::string_view at)>& parse) {
  for (const ChannelSpec& channel : setup.spec.channels) {
    const auto at = parse(channel.at);
    if (!at || !add_channel(*at, channel.encoding, waveform_for(channel, setup.seed))) {
      return tl::unexpected(fmt::format("{}/{}: '{}' is not an address for its type",
                                        setup.spec.name, channel.name, channel.at));
    }
    if (channel.exponent_from.empty()) continue;
    const auto exponent = parse(channel.exponent_from);
    const Encoding encoding = exponent_encoding(channel);
    if (!exponent || !add_channel(*exponent, encoding, exponent_waveform())) {
      return tl::unexpected(fmt::format("{}/{}: '{}' is not an address of an exponent",
                                        setup.spec.name, channel.name, channel.exponent_from));
    }
    // If a channel has the same register, the exponent's value wins.
    write(exponent->area, exponent->first,
          waveform_items(exponent_waveform(), encoding, Duration{}).front());
  }
  return {};
}

std::uint64_t ItemMemory::bits_of(const Part& part, unsigned width, Instant now) const {
  const Channel& channel = channels_[part.channel];
  const auto registers = waveform_items(channel.waveform, channel.encoding, now - start_);
  if (channel.encoding.type == ValueType::kBool)
    return std::uint64_t{registers[0] != 0} << channel.at.bit.value_or(0);
  if (channel.at.bit) return std::uint64_t{registers[0] & 0xFFu} << *channel.at.bit;
  if (width == 1) return registers[registers.size() - 1 - part.index / 16] >> part.index % 16 & 1u;
  const Bytes image = image_of(channel.encoding, registers, width);
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < width / 8; ++i)
    bits = bits << 8 | image[part.index * (width / 8) + i];
  return bits;
}

std::uint64_t ItemMemory::read(std::size_t area, std::uint32_t item, Instant now) const {
  if (const auto found = written_[area].find(item); found != written_[area].end())
    return found->second;
  std::uint64_t bits = 0;  // several channels may be single bits of the item
  const auto [begin, end] = parts_[area].equal_range(item);
  for (auto part = begin; part != end; ++part)
    bits |= bits_of(part->second, areas_[area].bits, now);
  return bits;
}

void ItemMemory::write(std::size_t area, std::uint32_t item, std::uint64_t bits,
                       DeviceStatistics& statistics) {
  write(area, item, bits);
  ++statistics.writes[fmt::format("{}:{}", areas_[area].name, item)];
}

std::optional<std::size_t> ItemMemory::find(std::string_view area, std::uint32_t item) const {
  const auto found = std::ranges::find(areas_, area, &ItemArea::name);
  if (found == areas_.end() || item >= found->items) return std::nullopt;
  return static_cast<std::size_t>(found - areas_.begin());
}

std::optional<std::uint64_t> ItemMemory::peek(std::string_view area, std::uint32_t item,
                                              Instant now) const {
  const auto found = find(area, item);
  return found ? std::optional(read(*found, item, now)) : std::nullopt;
}

bool ItemMemory::poke(std::string_view area, std::uint32_t item, std::uint64_t bits) {
  const auto found = find(area, item);
  if (found) write(*found, item, bits);
  return found.has_value();
}

std::uint8_t ItemMemory::refusal(std::size_t area, std::uint32_t first, std::uint32_t count,
                                 std::uint8_t missing) const {
  if (first >= areas_[area].items || count > areas_[area].items - first) return missing;
  for (const RefusedRange& range : refused_) {
    if (range.area == areas_[area].name && range.from < first + count && range.to >= first)
      return range.code;
  }
  for (std::uint32_t at = first; only_configured_ && at < first + count; ++at) {
    if (!configured(area, at)) return missing;
  }
  return 0;
}

}  // namespace fieldcast::sim
