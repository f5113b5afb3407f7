#include "core/protocol/omron_hostlink/fins_command.hpp"

#include <algorithm>
#include <cstdlib>

#include "core/protocol/omron_hostlink/fins.hpp"

namespace fieldcast::omron {
namespace {

constexpr std::uint16_t kRead = 0x0101, kWrite = 0x0102, kReadMany = 0x0104;
constexpr std::size_t kCommandSize = 2, kEndSize = 2, kItemSize = 4, kCountSize = 2;

const AreaRow& row_of(Mode mode, const Range& range) { return *reached_in(mode).rows[range.area]; }
std::size_t item_bytes(const AreaRow& row) { return row.flags ? 1 : 2; }

bool fits_fins(Mode mode, const Range& range, bool write) {
  const auto& areas = reached_in(mode).areas;
  // Each bank of EM has its own area code.
  return fieldcast::fits(areas, range, write) &&
         in_one_bank(areas[range.area], range.first, range.end());
}

void append_address(Bytes& out, const AreaRow& row, std::uint32_t item,
                    std::optional<std::uint8_t> bit = {}) {
  std::uint32_t first = item + row.fins_offset;
  std::uint8_t code = bit || row.flags ? row.bit_code : row.word_code;
  if (is_extended(row)) {
    code = static_cast<std::uint8_t>(code + first / kBankWords);
    first %= kBankWords;
  }
  out.push_back(code);
  append_u16(out, static_cast<std::uint16_t>(first));
  out.push_back(bit.value_or(0));
}

// Bytes of command and parameters, and of data.
std::optional<FinsSizes> sizes_of(const FinsLimits& limits, const ReadRequest& read) {
  if (read.ranges.empty() || read.ranges.size() > limits.items) return std::nullopt;
  for (const Range& range : read.ranges) {
    if (!fits_fins(limits.mode, range, false)) return std::nullopt;
  }
  const auto bytes = [&](const Range& range) { return item_bytes(row_of(limits.mode, range)); };
  if (read.ranges.size() == 1) {
    return FinsSizes{kCommandSize + kItemSize + kCountSize,
                     read.ranges[0].count * bytes(read.ranges[0])};
  }
  FinsSizes sizes{kCommandSize, 0};
  std::size_t items = 0;
  for (const Range& range : read.ranges) {
    items += range.count;
    sizes.request += range.count * kItemSize;
    sizes.response += range.count * (1 + bytes(range));
  }
  if (items > limits.items) return std::nullopt;
  return sizes;
}

std::optional<FinsSizes> sizes_of(const FinsLimits& limits, const WriteRequest& write) {
  if (!fits_fins(limits.mode, write.range, true) ||
      write.items.size() != image_bytes(16, write.range.count))
    return std::nullopt;
  if (write.bit &&
      (write.range.count != 1 || *write.bit > 15 || row_of(limits.mode, write.range).bit_code == 0))
    return std::nullopt;
  return FinsSizes{kCommandSize + kItemSize + kCountSize + (write.bit ? 1 : write.items.size()), 0};
}

bool are_bits(ByteView items) {
  return std::ranges::all_of(items, [](auto item) { return item <= 1; });
}

}  // namespace

std::optional<FinsSizes> fins_sizes(const FinsLimits& limits, std::size_t header,
                                    const Request& request) {
  std::optional<FinsSizes> sizes;
  if (const auto* read = std::get_if<ReadRequest>(&request)) sizes = sizes_of(limits, *read);
  if (const auto* write = std::get_if<WriteRequest>(&request)) sizes = sizes_of(limits, *write);
  if (!sizes) return std::nullopt;
  sizes->request += header;
  sizes->response += header + kCommandSize + kEndSize;
  if (sizes->request > limits.request_bytes || sizes->response > limits.response_bytes)
    return std::nullopt;
  return sizes;
}

FinsCommand::FinsCommand(const FinsLimits& limits, Bytes header, const Request& request)
    : mode_(limits.mode), header_size_(header.size()), message_(std::move(header)) {
  const auto sizes = fins_sizes(limits, header_size_, request);
  if (!sizes) std::abort();  // see REQUIRES
  response_size_ = sizes->response;
  if (const auto* write = std::get_if<WriteRequest>(&request)) {
    append_write(*write);
  } else {
    ranges_ = std::get<ReadRequest>(request).ranges;
    append_read();
  }
}

void FinsCommand::append_read() {
  if (ranges_.size() == 1) {
    append_u16(message_, kRead);
    append_address(message_, row_of(mode_, ranges_[0]), ranges_[0].first);
    append_u16(message_, static_cast<std::uint16_t>(ranges_[0].count));
    return;
  }
  append_u16(message_, kReadMany);
  for (const Range& range : ranges_) {
    for (std::uint32_t i = 0; i < range.count; ++i)
      append_address(message_, row_of(mode_, range), range.first + i);
  }
}

void FinsCommand::append_write(const WriteRequest& write) {
  append_u16(message_, kWrite);
  append_address(message_, row_of(mode_, write.range), write.range.first, write.bit);
  append_u16(message_, static_cast<std::uint16_t>(write.range.count));
  if (write.bit)
    message_.push_back((read_u16(write.items) >> *write.bit & 1) != 0 ? 1 : 0);
  else
    append(message_, write.items);
}

bool FinsCommand::is_foreign(ByteView message) const {
  return message.size() >= header_size_ && (message[0] & kResponseFlag) != 0 &&
         message[header_size_ - 1] != message_[header_size_ - 1];
}

Step FinsCommand::judge(ByteView message, Cause& silence) {
  silence = Cause::kMalformed;
  if (message.size() < header_size_ + kCommandSize + kEndSize) return Step::need_response();
  const std::uint8_t flags = message[0];
  if ((flags & kResponseFlag) == 0 || ((flags ^ message_[0]) & kRelayedFlag) != 0)
    return Step::need_response();
  if (!std::ranges::equal(message.subspan(header_size_, kCommandSize),
                          ByteView(message_).subspan(header_size_, kCommandSize))) {
    silence = Cause::kForeign;
    return Step::need_response();
  }
  // Bit 7 of the first byte: a relay failed. Bits 7 and 6 of the second byte only report errors of
  // the CPU.
  const std::uint16_t end = read_u16(message, header_size_ + kCommandSize) & 0xFF3F;
  const ByteView data = message.subspan(header_size_ + kCommandSize + kEndSize);
  if (end != 0) {
    // Only a relay adds data (the failed node). The XOR of Host Link does not detect the loss of
    // two equal characters.
    const bool shaped = data.empty() || ((end & 0x8000) != 0 && data.size() == 2);
    const std::uint16_t code = end & 0x7FFF;
    return shaped ? Step::failed(device_code_cause(kFinsCodes, code), code) : Step::need_response();
  }
  if (message.size() != response_size_) return Step::need_response();
  return ranges_.size() > 1 ? unpack_many(data) : unpack(data);
}

Step FinsCommand::unpack(ByteView data) {
  RangeReply reply{.items = Bytes(data.begin(), data.end())};
  if (!ranges_.empty() && row_of(mode_, ranges_[0]).flags && !are_bits(reply.items))
    return Step::need_response();
  reply_.push_back(std::move(reply));
  return Step::done();
}

// Each item repeats its area code.
Step FinsCommand::unpack_many(ByteView data) {
  Reply reply(ranges_.size());
  ByteView requested = ByteView(message_).subspan(header_size_ + kCommandSize);
  for (std::size_t r = 0; r < ranges_.size(); ++r) {
    const AreaRow& row = row_of(mode_, ranges_[r]);
    const std::size_t size = item_bytes(row);
    for (std::uint32_t i = 0; i < ranges_[r].count; ++i) {
      if (data[0] != requested[0]) return Step::need_response();
      append(reply[r].items, data.subspan(1, size));
      data = data.subspan(1 + size);
      requested = requested.subspan(kItemSize);
    }
    if (row.flags && !are_bits(reply[r].items)) return Step::need_response();
  }
  reply_ = std::move(reply);
  return Step::done();
}

}  // namespace fieldcast::omron
