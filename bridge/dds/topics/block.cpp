#include "bridge/dds/topics/block.hpp"

#include <algorithm>
#include <bit>

#include "bridge/dds/topics/columns.hpp"
#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

namespace {

// Bytes of a block without rows: names, counters, the lengths and paddings of its columns.
constexpr std::size_t kEmptyBytes = 192;
// Bytes of one row in all columns except texts: 4 + 1 + 1 + 2 + 8 + 8 + 8.
constexpr std::size_t kRowBytes = 32;
constexpr std::size_t kTextBytes = 8;

}  // namespace

void to_last_value(const Sample& sample, const UtcMapping& mapping, LastValue& out) {
  out.quality = to_idl(sample.quality);
  out.device_code = sample.device_code;
  out.acquired_at = mapping.to_utc(sample.acquired).nanoseconds;
  out.sequence = sample.sequence;
  to_last_value(sample.value, out);
}

void to_last_value(const Value& value, LastValue& out) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    out.kind = idl::ValueKind::VALUE_STRING;
    const bool fits = text->size() <= kMaxTextValue && text->find('\0') == std::string::npos;
    out.text = fits ? *text : std::string();
    if (!fits) out.quality = idl::Quality::BAD_RANGE;
  } else if (const auto* on = std::get_if<bool>(&value)) {
    out.kind = idl::ValueKind::VALUE_BOOLEAN;
    out.bits = *on ? 1 : 0;
  } else if (const auto* whole = std::get_if<std::int64_t>(&value)) {
    out.kind = idl::ValueKind::VALUE_INT64;
    out.bits = static_cast<std::uint64_t>(*whole);
  } else if (const auto* natural = std::get_if<std::uint64_t>(&value)) {
    out.kind = idl::ValueKind::VALUE_UINT64;
    out.bits = *natural;
  } else {
    out.kind = idl::ValueKind::VALUE_DOUBLE;
    out.bits = std::bit_cast<std::uint64_t>(std::get<double>(value));
  }
}

BlockFiller::BlockFiller(idl::SampleBlock& block, std::size_t most_bytes)
    : block_(&block), most_bytes_(most_bytes), bytes_(kEmptyBytes) {
  clear_columns(block);
}

bool BlockFiller::add(ChannelIndex channel, const LastValue& value) {
  const bool text = value.kind == idl::ValueKind::VALUE_STRING;
  const std::size_t bytes = kRowBytes + (text ? kTextBytes + value.text.size() : 0);
  const bool first = block_->channels().empty();
  if (!first && (block_->channels().size() == kMaxRows || bytes_ + bytes > most_bytes_))
    return false;
  bytes_ += bytes;
  any_device_code_ |= value.device_code != 0;
  one_instant_ &= first || value.acquired_at == block_->acquired_at().front();
  add_columns(channel, value, *block_);
  return true;
}

void BlockFiller::finish() {
  if (!any_device_code_) block_->device_codes().clear();
  if (one_instant_ && !block_->acquired_at().empty()) block_->acquired_at().resize(1);
}

bool is_whole(const idl::SampleBlock& block) {
  return has_whole_columns(block) &&
         (block.acquired_at().size() == block.channels().size() || block.acquired_at().size() == 1);
}

std::optional<Value> value_of(std::uint8_t kind, std::uint64_t bits, const BlockTexts& texts) {
  switch (static_cast<idl::ValueKind>(kind)) {
    case idl::ValueKind::VALUE_BOOLEAN: return bits != 0;
    case idl::ValueKind::VALUE_INT64: return static_cast<std::int64_t>(bits);
    case idl::ValueKind::VALUE_UINT64: return bits;
    case idl::ValueKind::VALUE_DOUBLE: return std::bit_cast<double>(bits);
    case idl::ValueKind::VALUE_STRING:
      if (bits >= texts.size()) return std::nullopt;
      return std::string(texts[bits].c_str());
  }
  return std::nullopt;
}

bool read_row(const idl::SampleBlock& block, std::size_t row, StationSample& out) {
  if (!read_columns(block, row, out)) return false;
  out.acquired_at = {block.acquired_at()[block.acquired_at().size() == 1 ? 0 : row]};
  out.sequence = block.sequences()[row];
  return true;
}

void to_idl(const idl::Channel& channel, idl::CatalogueEntry& out) {
  out.device() = channel.device();
  out.channel() = channel.channel();
  out.type() = channel.type();
  out.unit() = channel.unit();
  out.at() = channel.at();
  out.access(channel.access());
  out.mode(channel.mode());
  out.refresh(channel.refresh());
  out.limits() = channel.limits();
  out.description() = channel.description();
}

bool is_whole(const idl::CatalogueBlock& block) {
  return block.channels() <= static_cast<std::uint32_t>(kMaxChannels) &&
         block.first() <= block.channels() &&
         block.entries().size() <= block.channels() - block.first() &&
         block.entries().size() <= static_cast<std::size_t>(kEntriesPerBlock);
}

StationChannel from_idl(const idl::CatalogueBlock& block, const idl::CatalogueEntry& entry) {
  idl::Channel channel;
  channel.bus() = block.bus();
  channel.bridge() = block.bridge();
  channel.device() = entry.device();
  channel.channel() = entry.channel();
  channel.type() = entry.type();
  channel.unit() = entry.unit();
  channel.at() = entry.at();
  channel.access(entry.access());
  channel.mode(entry.mode());
  channel.refresh(entry.refresh());
  channel.limits() = entry.limits();
  channel.description() = entry.description();
  return from_idl(channel);
}

}  // namespace fieldcast
