#include "core/protocol/modbus/request.hpp"

#include <algorithm>
#include <cstdlib>

#include "core/protocol/modbus/areas.hpp"

namespace fieldcast::modbus {

std::string_view function_text(std::uint8_t function) {
  switch (function) {
    case 1: return "read coils";
    case 2: return "read discrete inputs";
    case 3: return "read holding registers";
    case 4: return "read input registers";
    case 5: return "write single coil";
    case 6: return "write single register";
    case 7: return "read exception status";
    case 8: return "diagnostics";
    case 11: return "get comm event counter";
    case 12: return "get comm event log";
    case 15: return "write multiple coils";
    case 16: return "write multiple registers";
    case 17: return "report server id";
    case 20: return "read file record";
    case 21: return "write file record";
    case 22: return "mask write register";
    case 23: return "read/write multiple registers";
    case 24: return "read fifo queue";
    case 43: return "encapsulated interface transport";
    default: return "unknown function";
  }
}

std::string_view exception_text(std::uint8_t code) {
  const auto text = device_code_text(kExceptions, code);
  return text.empty() ? "unknown exception" : text;
}

namespace {

// Function, then a byte that counts the rest.
std::size_t counted(ByteView pdu) { return pdu.size() < 2 ? 2 : std::size_t{2} + pdu[1]; }

}  // namespace

std::size_t answer_pdu_size(ByteView pdu) {
  if (pdu.empty()) return 0;
  if ((pdu[0] & kExceptionFlag) != 0) {
    const auto refused = static_cast<std::uint8_t>(pdu[0] & ~kExceptionFlag);
    return answer_pdu_size({&refused, 1}) != 0 ? 2 : 0;
  }
  switch (pdu[0]) {
    case 1:
    case 2:
    case 3:
    case 4:
    case 12:
    case 17:
    case 20:
    case 21:
    case 23: return counted(pdu);
    case 7: return 2;
    case 5:
    case 6:
    case 8:  // its common sub-functions echo two bytes
    case 11:
    case 15:
    case 16: return 5;
    case 22: return 7;
    case 24: return pdu.size() < 3 ? 3 : std::size_t{3} + read_u16(pdu, 1);
    default: return 0;
  }
}

std::size_t request_pdu_size(ByteView pdu) {
  if (pdu.empty()) return 0;
  switch (pdu[0]) {
    case 1:
    case 2:
    case 3:
    case 4:
    case 5:
    case 6:
    case 8: return 5;
    case 7:
    case 11:
    case 12:
    case 17: return 1;
    case 15:
    case 16: return pdu.size() < 6 ? 6 : std::size_t{6} + pdu[5];
    case 20:
    case 21: return counted(pdu);
    case 22: return 7;
    case 23: return pdu.size() < 10 ? 10 : std::size_t{10} + pdu[9];
    case 24: return 3;
    case 43: return 4;
    default: return 0;
  }
}

namespace {

constexpr std::size_t kEchoSize = 5;      // function, address, value or quantity
constexpr std::size_t kMaskEchoSize = 7;  // function, address, two masks
constexpr std::uint32_t kItems = 65536;   // of each table

Table table_of(const Range& range) { return static_cast<Table>(range.area); }
bool holds_bits(const Range& range) {
  return table_of(range) == Table::kCoil || table_of(range) == Table::kInput;
}
std::size_t packed_size(const Range& range) {
  return holds_bits(range) ? (range.count + 7) / 8 : range.count * 2;
}

bool fits(const Range& range, std::uint32_t limit) {
  return range.area < 4 && range.count >= 1 && range.count <= limit && range.first < kItems &&
         range.end() <= kItems;
}

std::optional<Function> function_of(const WriteRequest& write, const Options& options) {
  const Table table = table_of(write.range);
  if (table != Table::kCoil && table != Table::kHolding) return std::nullopt;
  const bool coil = table == Table::kCoil;
  if (!fits(write.range, coil ? kMaxWriteBits : kMaxWriteRegisters)) return std::nullopt;
  if (write.items.size() != image_bytes(coil ? 1 : 16, write.range.count)) return std::nullopt;
  if (write.bit && !coil) {
    if (!options.mask_write || write.range.count != 1 || *write.bit + write.bits > 16)
      return std::nullopt;
    return Function::kMaskWrite;
  }
  const bool single = write.range.count == 1 && !options.write_multiple && !write.distinct_answer;
  if (coil) return single ? Function::kWriteCoil : Function::kWriteCoils;
  return single ? Function::kWriteRegister : Function::kWriteRegisters;
}

// Areas are in the order of functions 1..4.
Function function_of(const Range& read) { return static_cast<Function>(read.area + 1); }

void append_range(Bytes& pdu, const Range& range) {
  append_u16(pdu, static_cast<std::uint16_t>(range.first));
  append_u16(pdu, static_cast<std::uint16_t>(range.count));
}

// The first item is the least significant bit of the first byte; unused bits are 0.
void append_bits(Bytes& pdu, ByteView items) {
  for (std::size_t at = 0; at < items.size(); at += 8) {
    unsigned byte = 0;
    for (std::size_t i = at; i < std::min(at + 8, items.size()); ++i)
      byte |= (items[i] != 0 ? 1u : 0u) << (i - at);
    pdu.push_back(static_cast<std::uint8_t>(byte));
  }
}

Bytes unpack_bits(ByteView packed, std::size_t count) {
  Bytes items(count);
  for (std::size_t i = 0; i < count; ++i)
    items[i] = static_cast<std::uint8_t>(packed[i / 8] >> i % 8 & 1);
  return items;
}

void append_write(Bytes& pdu, Function function, const WriteRequest& write) {
  const auto address = static_cast<std::uint16_t>(write.range.first);
  pdu.push_back(static_cast<std::uint8_t>(function));
  switch (function) {
    case Function::kWriteCoil:
      append_u16(pdu, address);
      append_u16(pdu, write.items[0] != 0 ? 0xFF00 : 0x0000);
      break;
    case Function::kWriteRegister:
      append_u16(pdu, address);
      append(pdu, write.items);
      break;
    case Function::kMaskWrite: {  // new = (old AND and) OR (or AND NOT and)
      const auto mask = static_cast<std::uint16_t>(((1u << write.bits) - 1) << *write.bit);
      append_u16(pdu, address);
      append_u16(pdu, static_cast<std::uint16_t>(~mask));
      append_u16(pdu, read_u16(write.items) & mask);
      break;
    }
    default:
      append_range(pdu, write.range);
      pdu.push_back(static_cast<std::uint8_t>(packed_size(write.range)));
      if (holds_bits(write.range))
        append_bits(pdu, write.items);
      else
        append(pdu, write.items);
  }
}

std::optional<PduSizes> sizes_of(const ReadRequest& read) {
  if (read.ranges.size() != 1) return std::nullopt;
  const Range& range = read.ranges.front();
  if (!fits(range, holds_bits(range) ? kMaxReadBits : kMaxReadRegisters)) return std::nullopt;
  return PduSizes{5, 2 + packed_size(range)};
}

std::optional<PduSizes> sizes_of(const WriteRequest& write, const Options& options) {
  const auto function = function_of(write, options);
  if (!function) return std::nullopt;
  switch (*function) {
    case Function::kWriteCoil:
    case Function::kWriteRegister: return PduSizes{kEchoSize, kEchoSize};
    case Function::kMaskWrite: return PduSizes{kMaskEchoSize, kMaskEchoSize};
    default: return PduSizes{6 + packed_size(write.range), kEchoSize};
  }
}

std::optional<PduSizes> sizes_of(const WriteReadRequest& both) {
  const Range& written = both.write.range;
  if (table_of(written) != Table::kHolding || table_of(both.read) != Table::kHolding ||
      both.write.bit)
    return std::nullopt;
  if (!fits(written, kMaxReadWriteRegisters) || !fits(both.read, kMaxReadRegisters))
    return std::nullopt;
  if (both.write.items.size() != packed_size(written)) return std::nullopt;
  return PduSizes{10 + packed_size(written), 2 + packed_size(both.read)};
}

}  // namespace

std::optional<PduSizes> pdu_sizes(const Request& request, const Options& options) {
  if (const auto* read = std::get_if<ReadRequest>(&request)) return sizes_of(*read);
  if (const auto* write = std::get_if<WriteRequest>(&request)) return sizes_of(*write, options);
  return sizes_of(std::get<WriteReadRequest>(request));
}

RequestPdu::RequestPdu(const Request& request, const Options& options) {
  const auto sizes = pdu_sizes(request, options);
  if (!sizes) std::abort();  // see REQUIRES of the constructor
  pdu_.reserve(sizes->request);
  answer_size_ = sizes->answer;
  if (const auto* read = std::get_if<ReadRequest>(&request)) {
    const Range& range = read->ranges.front();
    pdu_.push_back(static_cast<std::uint8_t>(function_of(range)));
    append_range(pdu_, range);
    read_count_ = static_cast<std::uint16_t>(range.count);
    bits_ = holds_bits(range);
  } else if (const auto* write = std::get_if<WriteRequest>(&request)) {
    append_write(pdu_, *function_of(*write, options), *write);
  } else {
    const auto& both = std::get<WriteReadRequest>(request);
    pdu_.push_back(static_cast<std::uint8_t>(Function::kReadWrite));
    append_range(pdu_, both.read);
    append_range(pdu_, both.write.range);
    pdu_.push_back(static_cast<std::uint8_t>(both.write.items.size()));
    append(pdu_, both.write.items);
    read_count_ = static_cast<std::uint16_t>(both.read.count);
    writes_and_reads_ = true;
  }
}

Verdict RequestPdu::judge(ByteView answer) const {
  if (answer.empty()) return Verdict::kMismatch;
  if (answer[0] == (function() | kExceptionFlag)) {
    return answer.size() == 2 && answer[1] != 0 ? Verdict::kException : Verdict::kMismatch;
  }
  if (answer[0] != function()) return Verdict::kForeign;
  if (answer.size() != answer_size_) return Verdict::kMismatch;
  const bool right = read_count_ != 0 ? answer[1] == answer_size_ - 2
                                      : std::equal(answer.begin(), answer.end(), pdu_.begin());
  return right ? Verdict::kAnswer : Verdict::kMismatch;
}

Reply RequestPdu::unpack(ByteView answer) const {
  Reply reply(writes_and_reads_ ? 2 : 1);
  if (read_count_ == 0) return reply;
  const ByteView data = answer.subspan(2);
  Bytes& items = reply.back().items;
  if (bits_)
    items = unpack_bits(data, read_count_);
  else
    items.assign(data.begin(), data.end());
  return reply;
}

}  // namespace fieldcast::modbus
