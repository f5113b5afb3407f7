#include "core/protocol/mitsubishi_mc_serial/short_command.hpp"

#include <string>

#include "core/codec/digits.hpp"

namespace fieldcast::mitsubishi_mc {
namespace {

constexpr auto kInt16 = ValueType::kInt16;
// A row of DeviceRow without a code: base of numbers in addresses and in commands, bits, items.
constexpr DeviceRow short_row(std::string_view name, std::uint8_t base, unsigned bits,
                              std::uint32_t items, bool writable = true,
                              std::optional<ValueType> type = std::nullopt) {
  return {name, "", 0, base, base, bits, items, writable, type};
}
constexpr DeviceRow kARows[] = {
    short_row("D", 10, 16, 10000),
    short_row("W", 16, 16, 0x2000),
    short_row("R", 10, 16, 8192),
    short_row("TN", 10, 16, 1000, true, kInt16),
    short_row("CN", 10, 16, 1000, true, kInt16),
    short_row("M", 10, 1, 10000),
    short_row("F", 10, 1, 2048),
    short_row("B", 16, 1, 0x2000),
    short_row("X", 16, 1, 0x2000),
    short_row("Y", 16, 1, 0x2000),
    short_row("TS", 10, 1, 1000, false),
    short_row("TC", 10, 1, 1000, false),
    short_row("CS", 10, 1, 1000, false),
    short_row("CC", 10, 1, 1000, false),
};
constexpr DeviceRow kAnaRows[] = {
    short_row("D", 10, 16, 32768),
    short_row("W", 16, 16, 0x8000),
    short_row("R", 10, 16, 32768),
    short_row("TN", 10, 16, 2048, true, kInt16),
    short_row("CN", 10, 16, 2048, true, kInt16),
    short_row("M", 10, 1, 32768),
    short_row("F", 10, 1, 32768),
    short_row("B", 16, 1, 0x8000),
    short_row("X", 16, 1, 0x2000),
    short_row("Y", 16, 1, 0x2000),
    short_row("TS", 10, 1, 2048, false),
    short_row("TC", 10, 1, 2048, false),
    short_row("CS", 10, 1, 2048, false),
    short_row("CC", 10, 1, 2048, false),
};
// Counters from C200 on have 32 bits and cannot be written with words: they are left out.
constexpr DeviceRow kFxRows[] = {
    short_row("D", 10, 16, 8512),
    short_row("TN", 10, 16, 512, true, kInt16),
    short_row("CN", 10, 16, 200, true, kInt16),
    short_row("M", 10, 1, 8512),
    short_row("S", 10, 1, 4096),
    short_row("X", 8, 1, 256),
    short_row("Y", 8, 1, 256),
    short_row("TS", 10, 1, 512, false),
    short_row("TC", 10, 1, 512, false),
    short_row("CS", 10, 1, 256, false),
    short_row("CC", 10, 1, 256, false),
};

// SH-080008, appendix 5.
constexpr AreaLimits kLimits{.words = 64, .read_bits = 256, .write_bits = 160};

constexpr AddressFaults kFault{
    "D100, D100.5, W1A0, R5, TN5, CN5 (values), M14, F3, B1F, X1F, Y20, TS5, CS5 (contacts), TC5, "
    "CC5 (coils); W, B, X and Y are hexadecimal"};
constexpr AddressFaults kFxFault{
    "D100, D100.5, TN5, CN5 (values), M14, S3, X17, Y20, TS5, CS5 (contacts), TC5, CC5 (coils); X "
    "and Y are octal"};

constexpr std::size_t kFixed = 5;  // command, wait, points
constexpr std::size_t kWordDigits = 4;

std::size_t device_size(ShortCommands set) { return set == ShortCommands::kAna ? 7 : 5; }

const DeviceRow& row_of(ShortCommands set, const Range& range) {
  return *reached_by(set).rows[range.area];
}

std::size_t data_size(const DeviceRow& row, const Range& range) {
  return row.item_bits == 1 ? range.count : range.count * kWordDigits;
}

}  // namespace

const Reached& reached_by(ShortCommands set) {
  static const Reached a = reached_from(kARows, kLimits), ana = reached_from(kAnaRows, kLimits),
                       fx = reached_from(kFxRows, kLimits);
  return set == ShortCommands::kA ? a : set == ShortCommands::kAna ? ana : fx;
}

ParsedOrFault parse_address(ShortCommands set, std::string_view at) {
  return parse_device(reached_by(set), set == ShortCommands::kFx ? kFxFault : kFault, at);
}

std::optional<CommandSizes> command_sizes(ShortCommands set, const Request& request) {
  const auto& areas = reached_by(set).areas;
  const std::size_t fixed = kFixed + device_size(set);
  if (const auto* read = std::get_if<ReadRequest>(&request)) {
    if (read->ranges.size() != 1 || !fits(areas, read->ranges[0], false)) return std::nullopt;
    return CommandSizes{fixed, data_size(row_of(set, read->ranges[0]), read->ranges[0])};
  }
  const auto* write = std::get_if<WriteRequest>(&request);
  if (write == nullptr || !fits(areas, write->range, true)) return std::nullopt;
  const DeviceRow& row = row_of(set, write->range);
  if ((write->bit && row.item_bits != 1) ||
      write->items.size() != image_bytes(row.item_bits, write->range.count))
    return std::nullopt;
  return CommandSizes{fixed + data_size(row, write->range), 0};
}

void append_command(Bytes& out, ShortCommands set, const Request& request) {
  const auto* read = std::get_if<ReadRequest>(&request);
  const Range& range =
      read != nullptr ? read->ranges.front() : std::get<WriteRequest>(request).range;
  const DeviceRow& row = row_of(set, range);
  const bool bits = row.item_bits == 1, wide = set == ShortCommands::kAna;
  out.push_back(static_cast<std::uint8_t>(bits ? (wide ? 'J' : 'B') : (wide ? 'Q' : 'W')));
  out.push_back(read != nullptr ? 'R' : 'W');
  out.push_back('0');  // no wait
  out.insert(out.end(), row.name.begin(), row.name.end());
  append_digits(out, range.first, static_cast<unsigned>(device_size(set) - row.name.size()),
                row.ascii_base);
  append_digits(out, range.count & 0xFF, 2);
  if (read != nullptr) return;
  const Bytes& items = std::get<WriteRequest>(request).items;
  if (!bits) return append_hex_bytes(out, items);
  for (const std::uint8_t bit : items) out.push_back(bit != 0 ? '1' : '0');
}

std::optional<Reply> unpack(ByteView data, ShortCommands set, const Request& request) {
  if (data.size() != command_sizes(set, request)->response) return std::nullopt;
  const auto* read = std::get_if<ReadRequest>(&request);
  if (read == nullptr) return Reply(1);
  if (row_of(set, read->ranges[0]).item_bits != 1) {
    auto items = read_hex_bytes(data);
    return items ? std::optional(Reply{{.items = std::move(*items)}}) : std::nullopt;
  }
  Bytes bits(data.begin(), data.end());
  for (std::uint8_t& bit : bits) {
    if (bit != '0' && bit != '1') return std::nullopt;
    bit = bit == '1' ? 1 : 0;
  }
  return Reply{{.items = std::move(bits)}};
}

}  // namespace fieldcast::mitsubishi_mc
