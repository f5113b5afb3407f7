#include "core/protocol/modbus/request.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "core/protocol/modbus/areas.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::modbus {

namespace {

constexpr std::uint8_t kReadFifo = 24, kIdentity = 43;
constexpr std::uint8_t kMeiType = 0x0E;     // of function 43, for the identification
constexpr std::size_t kObjectsAt = 7;       // its header in a response
constexpr std::size_t kQueueAt = 5;         // the first register in a response of function 24
constexpr std::size_t kMaxFileBytes = 245;  // byte count of function 20 (V1.1b3, 6.14)
constexpr std::uint8_t kReferenceType = 6;  // of each group of functions 20 and 21
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
  rows[20] = {"read file record", kByteCounted, kByteCounted, "file"};
  rows[21] = {"write file record", kByteCounted, kByteCounted, "file"};
  rows[22] = {"mask write register", kSeven, kSeven};
  rows[23] = {"read/write multiple registers", {0, 9}, kByteCounted};
  rows[kReadFifo] = {"read fifo queue", {3}, kNone, "fifo"};  // its response counts in two bytes
  rows[kIdentity] = {"encapsulated interface transport", {4}, kNone};  // see identity_size
  return rows;
}();

std::size_t size_in(ByteView pdu, const PduSize& size) {
  if (size.count_at == 0) return size.fixed;
  const std::size_t head = size.count_at + std::size_t{1};
  return pdu.size() < head ? head : head + pdu[size.count_at];
}

// Of a response of function 43/14: follows the lengths of its texts.
std::size_t identity_size(ByteView pdu) {
  if (pdu.size() > 1 && pdu[1] != kMeiType) return 0;
  std::size_t size = kObjectsAt;
  if (pdu.size() < size) return size;
  for (unsigned objects = pdu[kObjectsAt - 1]; objects > 0; --objects) {
    size += 2;
    if (pdu.size() < size) return size;
    size += pdu[size - 1];
  }
  return size;
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
  if (pdu[0] == kIdentity) return identity_size(pdu);
  return size_in(pdu, row_of_function(pdu[0]).response);
}

std::size_t request_pdu_size(ByteView pdu) {
  return pdu.empty() ? 0 : size_in(pdu, row_of_function(pdu[0]).request);
}

namespace {

constexpr std::size_t kEchoSize = 5;      // function, address, value or quantity
constexpr std::size_t kMaskEchoSize = 7;  // function, address, two masks
constexpr auto kAreas = areas(false);

Table table_of(const Range& range) { return static_cast<Table>(range.area); }
bool holds_bits(const Range& range) {
  return table_of(range) == Table::kCoil || table_of(range) == Table::kInput;
}
std::size_t packed_size(const Range& range) {
  return holds_bits(range) ? (range.count + 7) / 8 : range.count * 2;
}

bool fits(const Range& range, bool write) {
  return fieldcast::fits(kAreas, range, write) &&
         in_one_bank(kAreas[range.area], range.first, range.end());
}

std::optional<Function> function_of(const WriteRequest& write, const Options& options) {
  if (!fits(write.range, true)) return std::nullopt;
  const bool coil = table_of(write.range) == Table::kCoil;
  if (write.items.size() != image_bytes(coil ? 1 : 16, write.range.count)) return std::nullopt;
  if (table_of(write.range) == Table::kFile)
    return write.bit || write.mask ? std::nullopt : std::optional(Function::kWriteFile);
  if (write.mask) {
    const bool one = table_of(write.range) == Table::kHolding && write.range.count == 1;
    return one ? std::optional(Function::kMaskWrite) : std::nullopt;
  }
  if (write.bit && !coil) {
    if (!options.mask_write || write.range.count != 1 || *write.bit + write.bits > 16)
      return std::nullopt;
    return Function::kMaskWrite;
  }
  const bool single = write.range.count == 1 && !options.write_multiple && !write.distinct_response;
  if (coil) return single ? Function::kWriteCoil : Function::kWriteCoils;
  return single ? Function::kWriteRegister : Function::kWriteRegisters;
}

// The first areas are in the order of functions 1..4.
Function function_of(const Range& read) {
  if (table_of(read) == Table::kFile) return Function::kReadFile;
  if (table_of(read) == Table::kIdentity) return Function::kIdentification;
  if (table_of(read) == Table::kFifo) return Function::kReadFifo;
  return static_cast<Function>(read.area + 1);
}

void append_range(Bytes& pdu, const Range& range) {
  append_u16(pdu, static_cast<std::uint16_t>(range.first));
  append_u16(pdu, static_cast<std::uint16_t>(range.count));
}

// A group of functions 20 and 21, without registers.
void append_group(Bytes& pdu, const Range& range) {
  pdu.push_back(kReferenceType);
  append_u16(pdu, static_cast<std::uint16_t>(range.first / kRecords));
  append_u16(pdu, static_cast<std::uint16_t>(range.first % kRecords));
  append_u16(pdu, static_cast<std::uint16_t>(range.count));
}

void append_identity(Bytes& pdu, IdentityCode code, std::uint32_t object) {
  pdu.push_back(kIdentity);
  pdu.push_back(kMeiType);
  pdu.push_back(static_cast<std::uint8_t>(code));
  pdu.push_back(static_cast<std::uint8_t>(object));
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
      const std::uint16_t items = read_u16(write.items);
      const auto mask = write.mask
                            ? *write.mask
                            : static_cast<std::uint16_t>(((1u << write.bits) - 1) << *write.bit);
      append_u16(pdu, address);
      append_u16(pdu, static_cast<std::uint16_t>(~mask));
      append_u16(pdu, static_cast<std::uint16_t>(write.mask ? items : items & mask));
      break;
    }
    case Function::kWriteFile:
      pdu.push_back(static_cast<std::uint8_t>(kGroupBytes + write.items.size()));
      append_group(pdu, write.range);
      append(pdu, write.items);
      break;
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
  if (read.ranges.empty()) return std::nullopt;
  const Table table = table_of(read.ranges.front());
  if (read.ranges.size() != 1 && table != Table::kFile) return std::nullopt;
  std::size_t file_bytes = 0;
  for (const Range& range : read.ranges) {
    if (table_of(range) != table || !fits(range, false)) return std::nullopt;
    file_bytes += 2 + packed_size(range);
  }
  if (table == Table::kIdentity) return PduSizes{4, kMaxPdu};
  if (table == Table::kFifo) return PduSizes{3, kQueueAt + 2 * kMaxQueued};
  if (table != Table::kFile) return PduSizes{5, 2 + packed_size(read.ranges.front())};
  const std::size_t groups = kGroupBytes * read.ranges.size();
  if (groups > kMaxFileBytes || file_bytes > kMaxFileBytes) return std::nullopt;
  return PduSizes{2 + groups, 2 + file_bytes};
}

std::optional<PduSizes> sizes_of(const WriteRequest& write, const Options& options) {
  const auto function = function_of(write, options);
  if (!function) return std::nullopt;
  switch (*function) {
    case Function::kWriteCoil:
    case Function::kWriteRegister: return PduSizes{kEchoSize, kEchoSize};
    case Function::kMaskWrite: return PduSizes{kMaskEchoSize, kMaskEchoSize};
    case Function::kWriteFile: {
      const std::size_t size = 2 + kGroupBytes + write.items.size();
      return PduSizes{size, size};
    }
    default: return PduSizes{6 + packed_size(write.range), kEchoSize};
  }
}

std::optional<PduSizes> sizes_of(const WriteReadRequest& both) {
  const Range& written = both.write.range;
  if (table_of(written) != Table::kHolding || table_of(both.read) != Table::kHolding ||
      both.write.bit || both.write.mask)
    return std::nullopt;
  if (!fits(written, true) || written.count > kMaxReadWriteRegisters || !fits(both.read, false))
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
    append_read(*read);
  } else if (const auto* write = std::get_if<WriteRequest>(&request)) {
    append_write(pdu_, *function_of(*write, options), *write);
  } else {
    const auto& both = std::get<WriteReadRequest>(request);
    pdu_.push_back(static_cast<std::uint8_t>(Function::kReadWrite));
    append_range(pdu_, both.read);
    append_range(pdu_, both.write.range);
    pdu_.push_back(static_cast<std::uint8_t>(both.write.items.size()));
    append(pdu_, both.write.items);
    read_ = both.read;
  }
}

void RequestPdu::append_read(const ReadRequest& read) {
  read_ = read.ranges.back();
  const Function function = function_of(read_);
  if (function == Function::kIdentification) {
    const std::uint32_t object = read_.first / kObjectCharacters;
    return object == kBasicObjects ? append_identity(pdu_, IdentityCode::kBasic, 0)
                                   : append_identity(pdu_, IdentityCode::kIndividual, object);
  }
  pdu_.push_back(static_cast<std::uint8_t>(function));
  if (function == Function::kReadFifo)
    return append_u16(pdu_, static_cast<std::uint16_t>(read_.first / kQueueItems));
  if (function != Function::kReadFile) return append_range(pdu_, read_);
  pdu_.push_back(static_cast<std::uint8_t>(kGroupBytes * read.ranges.size()));
  for (const Range& range : read.ranges) append_group(pdu_, range);
}

std::size_t RequestPdu::registers_of_group(std::size_t group) const {
  return read_u16(pdu_, 2 + kGroupBytes * group + 5);
}

// REQUIRES: response_size() bytes.
bool RequestPdu::fits_groups(ByteView response) const {
  if (response[1] != response_size_ - 2) return false;
  std::size_t at = 2;
  for (std::size_t group = 0; group < groups(); ++group) {
    const std::size_t bytes = 2 * registers_of_group(group);
    if (response[at] != 1 + bytes || response[at + 1] != kReferenceType) return false;
    at += 2 + bytes;
  }
  return true;
}

bool RequestPdu::fits_objects(ByteView response) const {
  if (response.size() < kObjectsAt || identity_size(response) != response.size()) return false;
  if (response[2] != pdu_[2]) return false;
  const bool basic = read_.first / kObjectCharacters == kBasicObjects;
  return basic || (response[kObjectsAt - 1] == 1 && response[kObjectsAt] == pdu_[3]);
}

namespace {

// The byte count includes the two bytes of the other count (V1.1b3, 6.18).
bool fits_queue(ByteView response) {
  if (response.size() < kQueueAt || response.size() != response_pdu_size(response)) return false;
  const std::size_t queued = read_u16(response, 3);
  return queued <= kMaxQueued && response.size() == kQueueAt + 2 * queued;
}

}  // namespace

Verdict RequestPdu::judge(ByteView response) const {
  if (response.empty()) return Verdict::kMismatch;
  if (response[0] == (function() | kExceptionFlag)) {
    return response.size() == 2 && response[1] != 0 ? Verdict::kException : Verdict::kMismatch;
  }
  if (response[0] != function()) return Verdict::kForeign;
  if (varies()) {
    const bool fits = is_fifo() ? fits_queue(response) : fits_objects(response);
    return fits ? Verdict::kResponse : Verdict::kMismatch;
  }
  if (response.size() != response_size_) return Verdict::kMismatch;
  const bool right = is(Function::kReadFile) ? fits_groups(response)
                     : read_.count != 0
                         ? response[1] == response_size_ - 2
                         : std::equal(response.begin(), response.end(), pdu_.begin());
  return right ? Verdict::kResponse : Verdict::kMismatch;
}

Reply RequestPdu::unpack(ByteView response) const {
  if (is(Function::kReadFile)) return unpack_groups(response);
  if (is(Function::kIdentification)) return unpack_objects(response);
  if (is_fifo()) return unpack_queue(response);
  Reply reply(is(Function::kReadWrite) ? 2 : 1);
  if (read_.count == 0) return reply;
  const ByteView data = response.subspan(2);
  Bytes& items = reply.back().items;
  if (holds_bits(read_))
    items = unpack_bits(data, read_.count);
  else
    items.assign(data.begin(), data.end());
  return reply;
}

Reply RequestPdu::unpack_groups(ByteView response) const {
  Reply reply(groups());
  std::size_t at = 2;
  for (std::size_t group = 0; group < reply.size(); ++group) {
    const ByteView registers = response.subspan(at + 2, 2 * registers_of_group(group));
    reply[group].items.assign(registers.begin(), registers.end());
    at += 2 + registers.size();
  }
  return reply;
}

// The items behind the end of a text are 0.
Reply RequestPdu::unpack_objects(ByteView response) const {
  Reply reply(1);
  Bytes& items = reply.front().items;
  for (std::size_t at = kObjectsAt; at < response.size(); at += std::size_t{2} + response[at + 1]) {
    const ByteView text = response.subspan(at + 2, response[at + 1]);
    if (!items.empty() && !text.empty()) append(items, Bytes{',', ' '});
    append(items, text);
  }
  items.resize(kObjectCharacters);
  const auto from = items.begin() + read_.first % kObjectCharacters;
  items = Bytes(from, from + read_.count);
  return reply;
}

// The registers behind the end of the queue are absent.
Reply RequestPdu::unpack_queue(ByteView response) const {
  const std::uint32_t at = read_.first % kQueueItems;
  Bytes queue(response.begin() + 3, response.end());
  const auto present = static_cast<std::uint32_t>(queue.size() / 2);
  queue.resize(2 * std::size_t{kQueueItems});
  const auto from = queue.begin() + 2 * at;
  Reply reply(1);
  reply[0].items.assign(from, from + 2 * read_.count);
  if (at + read_.count > present) {
    const std::uint32_t there = std::max(present, at) - at;
    reply[0].absent = {{read_.area, read_.first + there, read_.count - there}};
  }
  return reply;
}

}  // namespace fieldcast::modbus
