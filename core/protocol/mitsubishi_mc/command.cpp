#include "core/protocol/mitsubishi_mc/command.hpp"

#include <algorithm>
#include <string>

#include "core/codec/digits.hpp"

namespace fieldcast::mitsubishi_mc {
namespace {

constexpr std::uint32_t kRead = 0x0401, kWrite = 0x1401, kRandomRead = 0x0403;
constexpr std::uint32_t kBitUnits = 1, kWideUnits = 2;  // of the subcommand
constexpr std::size_t kPoints = 2, kRandomCounts = 2, kWord = 2;

const DeviceRow& row_of(const Format& format, const Range& range) {
  return *reached_by(format).rows[range.area];
}
bool is_bits(const Format& format, const Range& range) {
  return row_of(format, range).item_bits == 1;
}

std::size_t device_size(const Format& format) {
  return format.ascii ? (format.wide ? 12 : 8) : (format.wide ? 6 : 4);
}
std::size_t bits_size(const Format& format, std::size_t count) {
  return format.ascii ? count : (count + 1) / 2;
}
std::size_t data_size(const Format& format, const Range& range) {
  return is_bits(format, range) ? bits_size(format, range.count)
                                : range.count * kWord * format.width();
}

// A random read returns bits in whole words, from a multiple of 16 on: the PLC has them all.
constexpr std::uint32_t kWordBits = 16;
std::uint32_t first_point(const Format& format, const Range& range) {
  return is_bits(format, range) ? range.first / kWordBits * kWordBits : range.first;
}
std::uint32_t point_count(const Format& format, const Range& range) {
  if (!is_bits(format, range)) return range.count;
  return (range.end() + kWordBits - 1) / kWordBits - range.first / kWordBits;
}

void append_device(Bytes& out, const Format& format, const DeviceRow& row, std::uint32_t number) {
  if (!format.ascii) {
    append_number(out, format, number, format.wide ? 4 : 3);
    return append_number(out, format, row.code, format.wide ? 2 : 1);
  }
  std::string name(format.wide && !row.other.empty() ? row.other : row.name);
  name.resize(format.wide ? 4 : 2, '*');
  out.insert(out.end(), name.begin(), name.end());
  append_digits(out, number, format.wide ? 8 : 6, row.ascii_base);
}

void append_points(Bytes& out, const Format& format, const Range& range) {
  append_device(out, format, row_of(format, range), range.first);
  append_number(out, format, range.count, kPoints);
}

void append_bits_in_units(Bytes& out, const Format& format, ByteView bits) {
  for (std::size_t i = 0; i < bits.size(); ++i) {
    const unsigned bit = bits[i] != 0 ? 1 : 0;
    if (format.ascii)
      append_digits(out, bit, 1);
    else if (i % 2 == 0)
      out.push_back(static_cast<std::uint8_t>(bit << 4));
    else
      out.back() = static_cast<std::uint8_t>(out.back() | bit);
  }
}

std::optional<Bytes> read_bits_in_units(ByteView data, const Format& format, std::size_t count) {
  Bytes bits(count);
  for (std::size_t i = 0; i < count; ++i) {
    const int bit = format.ascii ? hex_digit(data[i])
                    : i % 2 == 0 ? data[i / 2] >> 4
                                 : data[i / 2] & 0x0F;
    if (bit != 0 && bit != 1) return std::nullopt;
    bits[i] = static_cast<std::uint8_t>(bit);
  }
  return bits;
}

std::optional<Bytes> read_words(ByteView data, const Format& format, std::size_t count) {
  Bytes image;
  for (std::size_t i = 0; i < count; ++i) {
    const auto word = read_number(data.subspan(i * kWord * format.width()), format, kWord);
    if (!word) return std::nullopt;
    append_u16(image, static_cast<std::uint16_t>(*word));
  }
  return image;
}

// The bits of a range in the words of a random read.
Bytes bits_in(ByteView words, const Range& range) {
  Bytes bits(range.count);
  for (std::uint32_t i = 0; i < range.count; ++i) {
    const std::uint32_t at = range.first % kWordBits + i;
    bits[i] = read_u16(words, at / kWordBits * kWord) >> at % kWordBits & 1;
  }
  return bits;
}

std::optional<CommandSizes> sizes_of(const Format& format, const ReadRequest& read) {
  const auto& areas = reached_by(format).areas;
  if (read.ranges.empty() || read.ranges.size() > max_random(format)) return std::nullopt;
  std::size_t points = 0;
  for (const Range& range : read.ranges) {
    if (!fits(areas, range, false)) return std::nullopt;
    points += point_count(format, range);
  }
  if (read.ranges.size() == 1) {
    return CommandSizes{(kCommand + kPoints) * format.width() + device_size(format),
                        data_size(format, read.ranges[0])};
  }
  if (points > max_random(format)) return std::nullopt;
  return CommandSizes{(kCommand + kRandomCounts) * format.width() + points * device_size(format),
                      points * kWord * format.width()};
}

std::optional<CommandSizes> sizes_of(const Format& format, const WriteRequest& write) {
  const Range& range = write.range;
  if (!fits(reached_by(format).areas, range, true)) return std::nullopt;
  const unsigned item_bits = row_of(format, range).item_bits;
  if ((write.bit && item_bits != 1) || write.items.size() != image_bytes(item_bits, range.count))
    return std::nullopt;
  return CommandSizes{
      (kCommand + kPoints) * format.width() + device_size(format) + data_size(format, range), 0};
}

}  // namespace

std::optional<CommandSizes> command_sizes(const Format& format, const Request& request) {
  if (const auto* read = std::get_if<ReadRequest>(&request)) return sizes_of(format, *read);
  const auto* write = std::get_if<WriteRequest>(&request);
  return write == nullptr ? std::nullopt : sizes_of(format, *write);
}

std::uint32_t command_of(const Format& format, const Request& request) {
  const auto* read = std::get_if<ReadRequest>(&request);
  const bool random = read != nullptr && read->ranges.size() > 1;
  const Range& range =
      read != nullptr ? read->ranges.front() : std::get<WriteRequest>(request).range;
  const std::uint32_t command = random ? kRandomRead : read != nullptr ? kRead : kWrite;
  return command << 16 | (!random && is_bits(format, range) ? kBitUnits : 0) |
         (format.wide ? kWideUnits : 0);
}

void append_command(Bytes& out, const Format& format, const Request& request) {
  const std::uint32_t command = command_of(format, request);
  append_number(out, format, command >> 16, 2);
  append_number(out, format, command & 0xFFFF, 2);
  if (const auto* write = std::get_if<WriteRequest>(&request)) {
    append_points(out, format, write->range);
    if (is_bits(format, write->range)) return append_bits_in_units(out, format, write->items);
    for (std::size_t at = 0; at < write->items.size(); at += kWord)
      append_number(out, format, read_u16(write->items, at), kWord);
    return;
  }
  const auto& ranges = std::get<ReadRequest>(request).ranges;
  if (ranges.size() == 1) return append_points(out, format, ranges[0]);
  std::uint32_t points = 0;
  for (const Range& range : ranges) points += point_count(format, range);
  append_number(out, format, points, 1);
  append_number(out, format, 0, 1);  // no double words
  for (const Range& range : ranges) {
    const std::uint32_t step = is_bits(format, range) ? kWordBits : 1;
    for (std::uint32_t i = 0; i < point_count(format, range); ++i)
      append_device(out, format, row_of(format, range), first_point(format, range) + i * step);
  }
}

std::optional<Reply> unpack(ByteView data, const Format& format, const Request& request) {
  if (data.size() != command_sizes(format, request)->response) return std::nullopt;
  const auto* read = std::get_if<ReadRequest>(&request);
  if (read == nullptr) return Reply(1);
  const bool random = read->ranges.size() > 1;
  Reply reply;
  for (const Range& range : read->ranges) {
    const bool bits = is_bits(format, range);
    const std::uint32_t count = random ? point_count(format, range) : range.count;
    auto items =
        bits && !random ? read_bits_in_units(data, format, count) : read_words(data, format, count);
    if (!items) return std::nullopt;
    if (random) data = data.subspan(items->size() * format.width());
    reply.push_back({.items = bits && random ? bits_in(*items, range) : std::move(*items)});
  }
  return reply;
}

}  // namespace fieldcast::mitsubishi_mc
