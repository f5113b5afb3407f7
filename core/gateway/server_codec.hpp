// Requests of Modbus TCP clients and their responses, byte by byte. Pure; any thread.
//
//     transaction(2) protocol(2)=0 length(2) unit function data..    length: from the unit on
//
// (Modbus Messaging on TCP/IP V1.0b, 3.1.3; Modbus Application Protocol V1.1b3, 6 and 7)
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/base/bytes.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/command.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::gateway {

inline constexpr std::size_t kMaxFrame = 260;  // header and the largest PDU

enum class Exception : std::uint8_t {
  kIllegalFunction = 0x01,
  kIllegalAddress = 0x02,
  kIllegalValue = 0x03,
  kDeviceFailure = 0x04,
  kBusy = 0x06,
  kNoPath = 0x0A,      // no device has the unit, or the bus is stopping
  kNoResponse = 0x0B,  // the device does not respond
};

struct RequestFrame {
  std::uint16_t transaction = 0;
  std::uint8_t unit = 0;
  ByteView pdu;          // refers to the given bytes; never empty
  std::size_t size = 0;  // bytes of the whole frame
};

// Where the bytes of a client cannot be the start of a frame.
enum class FrameFault : std::uint8_t { kProtocol, kLength };
[[nodiscard]] std::string_view to_text(FrameFault fault);

// The frame at the start of `received`; empty if more bytes are needed.
[[nodiscard]] tl::expected<std::optional<RequestFrame>, FrameFault> first_frame(ByteView received);

// Functions 1-6, 15, 16, 22 and 23.
struct ClientRequest {
  std::uint8_t function = 0;
  Range range;  // the area is a modbus::Table
  Bytes items;  // the image of a write; empty for a read
  // Function 22: the bits that change. The response repeats both masks.
  std::optional<std::uint16_t> mask{};
  std::optional<Range> then_read{};  // function 23: `range` is written before
  const GatewayRow* row = nullptr;   // that contains the range; null: of the device's own Modbus

  [[nodiscard]] bool is_write() const { return !items.empty(); }
  // REQUIRES: then_read.
  [[nodiscard]] ClientRequest second() const { return {function, *then_read, {}}; }
};
[[nodiscard]] tl::expected<ClientRequest, Exception> decode(ByteView pdu);

// The row that contains whole values at the range of the request, or null.
[[nodiscard]] const GatewayRow* row_of(const std::vector<GatewayRow>& rows,
                                       const ClientRequest& request);

// The request as a command to addresses of the device; the caller sets requester and limits. Fails
// if the written registers are no value of the row.
[[nodiscard]] tl::expected<Command, Exception> command_of(const ClientRequest& request,
                                                          const std::string& device);

// The whole frame that responds to `frame`.
[[nodiscard]] Bytes exception_response(const RequestFrame& frame, std::uint8_t code);
[[nodiscard]] inline Bytes exception_response(const RequestFrame& frame, Exception exception) {
  return exception_response(frame, static_cast<std::uint8_t>(exception));
}
// `result`: of command_of(request). `frame.pdu` is only used for its function.
[[nodiscard]] Bytes response(const RequestFrame& frame, const ClientRequest& request,
                             const CommandResult& result);

// Code for a result that is not a success. `modbus`: the code of the device is an exception, which
// is passed on unchanged.
[[nodiscard]] std::uint8_t exception_code(const CommandResult& result, bool modbus = true);

}  // namespace fieldcast::gateway
