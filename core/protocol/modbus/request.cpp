#include "core/protocol/modbus/request.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "core/protocol/modbus/areas.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::modbus {

namespace {

constexpr std::uint8_t kReadFifo = 24;
constexpr PduSize kNone{}, kOne{1}, kFive{5}, kSeven{7}, kByteCounted{0, 1};

constexpr auto kFunctions = [] {
  std::array<FunctionRow, 44> rows{};
  rows[1] = {"read coils", kFive, kByteCounted, "coil", kMaxReadBits};
  rows[2] = {"read discrete inputs", kFive, kByteCounted, "input", kMaxReadBits};
  rows[3] = {"read holding registers", kFive, kByteCounted, "holding", kMaxReadRegisters};
  rows[4] = {"read input registers", kFive, kByteCounted, "input-register", kMaxReadRegisters};
  rows[5] = {"write single coil", kFive, kFive, "coil"};
  rows[6] = {"write single register", kFive, kFive};
  rows[7] = {"read exception status", kOne, {2}};
  rows[8] = {"diagnostics", kFive, kFive};  // its common sub-functions echo two bytes
  rows[11] = {"get comm event counter", kOne, kFive};
  rows[12] = {"get comm event log", kOne, kByteCounted};
  rows[15] = {"write multiple coils", {0, 5}, kFive, "coil", kMaxWriteBits};
  rows[16] = {"write multiple registers", {0, 5}, kFive, "holding", kMaxWriteRegisters};
  rows[17] = {"report server id", kOne, kByteCounted};
  rows[20] = {"read file record", kByteCounted, kByteCounted};
  rows[21] = {"write file record", kByteCounted, kByteCounted};
  rows[22] = {"mask write register", kSeven, kSeven};
  rows[23] = {"read/write multiple registers", {0, 9}, kByteCounted};
  rows[kReadFifo] = {"read fifo queue", {3}, kNone};  // its response counts in two bytes
  rows[43] = {"encapsulated interface transport", {4}, kNone};
  return rows;
}();

std::size_t size_in(ByteView pdu, const PduSize& size) {
  if (size.count_at == 0) return size.fixed;
  const std::size_t head = size.count_at + std::size_t{1};
  return pdu.size() < head ? head : head + pdu[size.count_at];
}

}  // namespace

const FunctionRow& row_of_function(std::uint8_t function) {
  return kFunctions[function < kFunctions.size() ? function : 0];
}

std::string_view exception_text(std::uint8_t code) {
  const auto text = device_code_text(kExceptions, code);
  return text.empty() ? "unknown exception" : text;
}

std::size_t response_pdu_size(ByteView pdu) {
  if (pdu.empty()) return 0;
  if ((pdu[0] & kExceptionFlag) != 0) {
    const auto refused = static_cast<std::uint8_t>(pdu[0] & ~kExceptionFlag);
    return response_pdu_size({&refused, 1}) != 0 ? 2 : 0;
  }
  if (pdu[0] == kReadFifo) return pdu.size() < 3 ? 3 : std::size_t{3} + read_u16(pdu, 1);
  return size_in(pdu, row_of_function(pdu[0]).response);
}

std::size_t request_pdu_size(ByteView pdu) {
  return pdu.empty() ? 0 : size_in(pdu, row_of_function(pdu[0]).request);
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
  const bool single = write.range.count == 1 && !options.write_multiple && !write.distinct_response;
  if (coil) return single ? Function::kWriteCoil : Function::kWriteCoils;
  return single ? Function::kWriteRegister : Function::kWriteRegisters;
}

// Areas are in the order of functions 1..4.
Function function_of(const Range& read) { return static_cast<Function>(read.area + 1); }

void append_range(Bytes& pdu, const Range& range) {
  append_u16(pdu, static_cast<std::uint16_t>(range.first));
  append_u16(pdu, static_cast<std::uint16_t>(range.count));
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
  response_size_ = sizes->response;
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

Verdict RequestPdu::judge(ByteView response) const {
  if (response.empty()) return Verdict::kMismatch;
  if (response[0] == (function() | kExceptionFlag)) {
    return response.size() == 2 && response[1] != 0 ? Verdict::kException : Verdict::kMismatch;
  }
  if (response[0] != function()) return Verdict::kForeign;
  if (response.size() != response_size_) return Verdict::kMismatch;
  const bool right = read_count_ != 0 ? response[1] == response_size_ - 2
                                      : std::equal(response.begin(), response.end(), pdu_.begin());
  return right ? Verdict::kResponse : Verdict::kMismatch;
}

Reply RequestPdu::unpack(ByteView response) const {
  Reply reply(writes_and_reads_ ? 2 : 1);
  if (read_count_ == 0) return reply;
  const ByteView data = response.subspan(2);
  Bytes& items = reply.back().items;
  if (bits_)
    items = unpack_bits(data, read_count_);
  else
    items.assign(data.begin(), data.end());
  return reply;
}

}  // namespace fieldcast::modbus
