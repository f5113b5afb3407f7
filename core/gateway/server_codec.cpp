#include "core/gateway/server_codec.hpp"

#include <array>
#include <vector>

#include "core/protocol/modbus/framing.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::gateway {
namespace {

using modbus::Function;

constexpr std::size_t kHeader = 7;  // with the unit
constexpr std::uint16_t kCoilOn = 0xFF00;

tl::unexpected<Exception> fault(Exception exception) { return tl::make_unexpected(exception); }

bool holds_bits(std::uint8_t function) {
  return function == 1 || function == 2 || function == 5 || function == 15;
}

bool is_single(std::uint8_t function) { return function == 5 || function == 6; }

// The packed bits or registers of a write, as an image. Empty if they are not valid.
Bytes image_of(std::uint8_t function, std::uint32_t count, ByteView data) {
  if (function == static_cast<std::uint8_t>(Function::kWriteCoil)) {
    const std::uint16_t value = read_u16(data);
    if (value != 0 && value != kCoilOn) return {};
    return {static_cast<std::uint8_t>(value == 0 ? 0 : 1)};
  }
  if (!holds_bits(function))
    return data.size() == count * std::size_t{2} ? Bytes(data.begin(), data.end()) : Bytes{};
  return data.size() == (count + 7) / 8 ? unpack_bits(data, count) : Bytes{};
}

// REQUIRES: pdu fits a frame.
Bytes framed(const RequestFrame& frame, ByteView pdu) {
  Bytes out;
  modbus::tcp_framing().wrap({frame.unit, frame.transaction}, pdu, out);
  return out;
}

ValueType type_of(const ClientRequest& request) {
  if (request.row != nullptr) return request.row->type;
  return holds_bits(request.function) ? ValueType::kBool : ValueType::kUint16;
}

std::uint32_t width_of(const ClientRequest& request) {
  return request.row == nullptr ? 1 : request.row->width();
}

// Empty if a value is missing or does not fit.
std::optional<Bytes> packed(const ClientRequest& request, const std::vector<Value>& values) {
  if (values.size() * width_of(request) != request.range.count) return std::nullopt;
  const bool bits = holds_bits(request.function);
  Bytes image;
  for (const Value& value : values) {
    const auto items = encode_value({.type = type_of(request)}, bits ? 1 : 16, value);
    if (!items) return std::nullopt;
    append(image, *items);
  }
  if (!bits) return image;
  Bytes packed_bits;
  append_bits(packed_bits, image);
  return packed_bits;
}

}  // namespace

std::string_view to_text(FrameFault fault) {
  return fault == FrameFault::kProtocol ? "the protocol identifier is not 0"
                                        : "the length is not that of a Modbus frame";
}

tl::expected<std::optional<RequestFrame>, FrameFault> first_frame(ByteView received) {
  const auto size = modbus::first_tcp_frame(received);
  if (!size) {
    const bool protocol = received[2] != 0 || (received.size() > 3 && received[3] != 0);
    return tl::make_unexpected(protocol ? FrameFault::kProtocol : FrameFault::kLength);
  }
  if (*size == 0) return std::optional<RequestFrame>{};
  return RequestFrame{read_u16(received), received[6], received.first(*size).subspan(kHeader),
                      *size};
}

namespace {

constexpr std::uint8_t kMaskWrite = static_cast<std::uint8_t>(Function::kMaskWrite);
constexpr std::uint8_t kReadWrite = static_cast<std::uint8_t>(Function::kReadWrite);
constexpr AreaIndex kHolding = 2;  // of modbus::Table

// 16 address(2) and-mask(2) or-mask(2)
ClientRequest decode_mask_write(ByteView pdu) {
  ClientRequest request{kMaskWrite, {kHolding, read_u16(pdu, 1), 1}, {pdu.begin() + 5, pdu.end()}};
  request.mask = static_cast<std::uint16_t>(~read_u16(pdu, 3));
  return request;
}

// 17 first(2) quantity(2) first(2) quantity(2) count(1) registers..
tl::expected<ClientRequest, Exception> decode_read_write(ByteView pdu) {
  const Range read{kHolding, read_u16(pdu, 1), read_u16(pdu, 3)};
  const Range written{kHolding, read_u16(pdu, 5), read_u16(pdu, 7)};
  ClientRequest request{kReadWrite, written, {pdu.begin() + 10, pdu.end()}};
  // A frame has room for 121 written registers, which is their limit.
  const std::uint16_t most = modbus::row_of_function(3).most;
  if (read.count == 0 || read.count > most || written.count == 0 ||
      request.items.size() != written.count * std::size_t{2})
    return fault(Exception::kIllegalValue);
  if (read.end() > 65536 || written.end() > 65536) return fault(Exception::kIllegalAddress);
  request.then_read = read;
  return request;
}

}  // namespace

tl::expected<ClientRequest, Exception> decode(ByteView pdu) {
  const std::uint8_t function = pdu[0];
  const bool write = is_single(function) || function == 15 || function == 16;
  const bool both = function == kMaskWrite || function == kReadWrite;
  if (!write && !both && (function < 1 || function > 4)) return fault(Exception::kIllegalFunction);
  if (pdu.size() < 5 || pdu.size() != modbus::request_pdu_size(pdu))
    return fault(Exception::kIllegalValue);
  if (function == kMaskWrite) return decode_mask_write(pdu);
  if (function == kReadWrite) return decode_read_write(pdu);
  ClientRequest request{function, {}, {}};
  // Areas are in the order of functions 1..4; writes are of coils and holding registers.
  request.range.area = static_cast<AreaIndex>(!write ? function - 1 : holds_bits(function) ? 0 : 2);
  request.range.first = read_u16(pdu, 1);
  request.range.count = is_single(function) ? 1 : read_u16(pdu, 3);
  const std::uint16_t most = modbus::row_of_function(function).most;
  if (request.range.count == 0 || (most != 0 && request.range.count > most))
    return fault(Exception::kIllegalValue);
  if (write) {
    request.items =
        image_of(function, request.range.count, pdu.subspan(is_single(function) ? 3 : 6));
    if (request.items.empty()) return fault(Exception::kIllegalValue);
  }
  if (request.range.end() > 65536) return fault(Exception::kIllegalAddress);
  return request;
}

const GatewayRow* row_of(const std::vector<GatewayRow>& rows, const ClientRequest& request) {
  const Range& range = request.range;
  for (const GatewayRow& row : rows) {
    const bool inside = row.bits == holds_bits(request.function) && range.first >= row.first &&
                        range.end() <= row.end();
    if (inside && (range.first - row.first) % row.width() == 0 && range.count % row.width() == 0)
      return &row;
  }
  return nullptr;
}

tl::expected<Command, Exception> command_of(const ClientRequest& request,
                                            const std::string& device) {
  const Encoding encoding{.type = type_of(request)};
  const std::uint32_t width = width_of(request);
  Command command;
  command.device = device;
  command.operation = request.is_write() ? Operation::kWrite : Operation::kAcquire;
  command.count = request.range.count / width;
  command.gateway = true;
  if (request.row != nullptr) {
    command.target = AddressTarget{request.row->at, encoding,
                                   (request.range.first - request.row->first) / width};
  } else {
    const std::string area(modbus::row_of_function(request.function).area);
    command.target = AddressTarget{area + ':' + std::to_string(request.range.first), encoding};
  }
  command.mask = request.mask;
  if (!request.is_write()) return command;
  const unsigned item_bits = holds_bits(request.function) ? 1 : 16;
  const std::size_t size = image_bytes(item_bits, width);
  for (std::size_t i = 0; i < command.count; ++i) {
    auto value = decode_value(encoding, item_bits, ByteView(request.items).subspan(i * size, size));
    if (!value) return fault(Exception::kIllegalValue);
    command.values.push_back(*std::move(value));
  }
  return command;
}

Bytes exception_response(const RequestFrame& frame, std::uint8_t code) {
  const std::array pdu{static_cast<std::uint8_t>(frame.pdu[0] | modbus::kExceptionFlag), code};
  return framed(frame, pdu);
}

Bytes response(const RequestFrame& frame, const ClientRequest& request,
               const CommandResult& result) {
  if (result.state != CommandState::kDone && result.state != CommandState::kVerified)
    return exception_response(frame, exception_code(result, request.row == nullptr));
  Bytes pdu{request.function};
  if (request.is_write()) {
    append_u16(pdu, static_cast<std::uint16_t>(request.range.first));
    if (request.mask) {
      append_u16(pdu, static_cast<std::uint16_t>(~*request.mask));
      append(pdu, request.items);
    } else if (request.function == static_cast<std::uint8_t>(Function::kWriteCoil))
      append_u16(pdu, request.items[0] != 0 ? kCoilOn : 0);
    else if (is_single(request.function))
      append(pdu, request.items);
    else
      append_u16(pdu, static_cast<std::uint16_t>(request.range.count));
    return framed(frame, pdu);
  }
  const auto data = packed(request, result.values);
  if (!data) return exception_response(frame, Exception::kDeviceFailure);
  pdu.push_back(static_cast<std::uint8_t>(data->size()));
  append(pdu, *data);
  return framed(frame, pdu);
}

std::uint8_t exception_code(const CommandResult& result, bool modbus) {
  const auto code = [](Exception exception) { return static_cast<std::uint8_t>(exception); };
  switch (result.cause) {
    case Cause::kDeviceError:
    case Cause::kDeviceBusy:
      if (!modbus)
        return code(result.cause == Cause::kDeviceBusy ? Exception::kBusy
                                                       : Exception::kDeviceFailure);
      return result.device_code >= 1 && result.device_code <= 0xFF
                 ? static_cast<std::uint8_t>(result.device_code)
                 : code(Exception::kDeviceFailure);
    case Cause::kRawNotAllowed:
    case Cause::kReadOnly:
    case Cause::kUnsupported: return code(Exception::kIllegalFunction);
    case Cause::kBadAddress: return code(Exception::kIllegalAddress);
    case Cause::kRange:
    case Cause::kWrongType: return code(Exception::kIllegalValue);
    case Cause::kExpired:
    case Cause::kQueueFull:
    case Cause::kRateLimited:
    case Cause::kLeased:
    case Cause::kForeignMaster: return code(Exception::kBusy);
    case Cause::kUnknownDevice:
    case Cause::kShutdown: return code(Exception::kNoPath);
    case Cause::kNoResponse:
    case Cause::kTruncated:
    case Cause::kChecksum:
    case Cause::kMalformed:
    case Cause::kForeign:
    case Cause::kOverlong:
    case Cause::kPortClosed:
    case Cause::kOffline: return code(Exception::kNoResponse);
    default: return code(Exception::kDeviceFailure);
  }
}

}  // namespace fieldcast::gateway
