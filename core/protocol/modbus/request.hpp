// Function and exception codes (Modbus Application Protocol V1.1b3, 6 and 7).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/bytes.hpp"
#include "core/protocol/device_code.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::modbus {

enum class Function : std::uint8_t {
  kReadCoils = 1,
  kReadInputs = 2,
  kReadHolding = 3,
  kReadInputRegisters = 4,
  kWriteCoil = 5,
  kWriteRegister = 6,
  kWriteCoils = 15,
  kWriteRegisters = 16,
  kReadFile = 20,
  kWriteFile = 21,
  kMaskWrite = 22,
  kReadWrite = 23,
  kReadFifo = 24,
  kIdentification = 43,
};

inline constexpr std::uint8_t kExceptionFlag = 0x80;
inline constexpr std::size_t kMaxPdu = 253;
inline constexpr std::size_t kGroupBytes = 7;  // of functions 20 and 21, without registers

// Size of a PDU: fixed, or up to a byte that counts the rest.
struct PduSize {
  std::uint8_t fixed = 0;     // 0: unknown, or counted
  std::uint8_t count_at = 0;  // 0: none
};
struct FunctionRow {
  std::string_view text = "unknown function";
  PduSize request, response;
  std::string_view area = "holding";  // of its addresses
  std::uint16_t most = 0;             // items in its first quantity; 0: no limit
};
[[nodiscard]] const FunctionRow& row_of_function(std::uint8_t function);
// "read coils"; "unknown function".
[[nodiscard]] inline std::string_view function_text(std::uint8_t function) {
  return row_of_function(function).text;
}

// Modbus Application Protocol V1.1b3, 7. A device fails (04) while it carries out a request, 05
// says that it carries it out, and behind a gateway (0B) it may have: only its response was lost.
inline constexpr std::array kExceptions{
    DeviceCode{0x01, "illegal function"},
    DeviceCode{0x02, "illegal data address"},
    DeviceCode{0x03, "illegal data value"},
    DeviceCode{0x04, "server device failure", Cause::kDeviceBusy, true},
    DeviceCode{0x05, "acknowledge: still at work", Cause::kDeviceBusy, true},
    DeviceCode{0x06, "server device busy", Cause::kDeviceBusy},
    DeviceCode{0x07, "negative acknowledgement"},  // PI-MBUS-300; older devices still send it
    DeviceCode{0x08, "memory parity error", Cause::kDeviceBusy},
    DeviceCode{0x0A, "gateway path unavailable", Cause::kDeviceBusy},
    DeviceCode{0x0B, "gateway target did not respond", Cause::kDeviceBusy, true},
};
// "illegal data address"; "unknown exception".
[[nodiscard]] std::string_view exception_text(std::uint8_t code);

// Size of the response PDU that begins with `pdu`, function first; or the bytes needed to read its
// length. 0 if the function has no length field, or `pdu` is empty.
[[nodiscard]] std::size_t response_pdu_size(ByteView pdu);

// The same for requests.
[[nodiscard]] std::size_t request_pdu_size(ByteView pdu);

// One Modbus request as a PDU, and the check of its response; used by all framings.
//
//     function  request                                              response
//     01 02     first(2) quantity(2)                                 count(1) bits..
//     03 04     first(2) quantity(2)                                 count(1) registers..
//     05 06     address(2) value(2)                                  the request
//     0F        first(2) quantity(2) count(1) bits..                 first(2) quantity(2)
//     10        first(2) quantity(2) count(1) registers..            first(2) quantity(2)
//     14        count(1) [06 file(2) record(2) quantity(2)]..        count(1) [count(1) 06
//                                                                    registers..]..
//     15        count(1) 06 file(2) record(2) quantity(2)
//               registers..                                          the request
//     16        address(2) and-mask(2) or-mask(2)                    the request
//     17        first(2) quantity(2) first(2) quantity(2) count(1)
//               registers..                                          count(1) registers..
//     18        pointer(2)                                           count(2) queued(2)
//                                                                    registers..
//     2B        0E code(1) object(1)                                 0E code(1) conformity(1)
//                                                                    more(1) next(1) objects(1)
//                                                                    [object(1) count(1) text..]..
//     fn | 80   -                                                    exception code(1)
//
// Bits are sent least significant first, registers big-endian.
// (Modbus Application Protocol V1.1b3, 6)
struct Options {
  // Functions 15 and 16 also for single items, as some devices do not support 5 and 6.
  bool write_multiple = false;
  bool mask_write = false;  // function 22 for one bit or byte of a register
  bool read_write = false;  // function 23 for a write with read-back
};

struct PduSizes {
  std::size_t request = 0;
  std::size_t response = 0;  // of the longest response, if they differ in length
};

// Read Device ID code of function 43/14: three objects in one response, or the requested one. A
// device without individual access supports only the first one (V1.1b3, 6.21).
enum class IdentityCode : std::uint8_t { kBasic = 1, kIndividual = 4 };

// Empty if the request exceeds a limit or these functions do not support it. Does not allocate.
[[nodiscard]] std::optional<PduSizes> pdu_sizes(const Request& request, const Options& options);

enum class Verdict : std::uint8_t {
  kResponse,
  kException,  // of the requested function
  // A wrong byte count or echo: a response to an earlier request, or a faulty device.
  kMismatch,
  kForeign,  // another function
};

// Plain value, used on the thread of its exchange.
class RequestPdu {
 public:
  // REQUIRES: pdu_sizes(request, options) holds a value.
  RequestPdu(const Request& request, const Options& options);

  [[nodiscard]] ByteView pdu() const { return pdu_; }
  [[nodiscard]] std::size_t response_size() const { return response_size_; }
  [[nodiscard]] std::uint8_t function() const { return pdu_[0]; }
  // Whether responses have different lengths.
  [[nodiscard]] bool varies() const { return is(Function::kIdentification) || is_fifo(); }
  [[nodiscard]] bool is_fifo() const { return is(Function::kReadFifo); }

  // REQUIRES: `response` is one whole PDU, checked by its framing.
  [[nodiscard]] Verdict judge(ByteView response) const;
  // REQUIRES: judge(response) == kResponse.
  [[nodiscard]] Reply unpack(ByteView response) const;

 private:
  void append_read(const ReadRequest& read);
  [[nodiscard]] bool is(Function function) const { return pdu_[0] == static_cast<int>(function); }
  // The groups of function 20.
  [[nodiscard]] std::size_t groups() const { return pdu_[1] / kGroupBytes; }
  [[nodiscard]] std::size_t registers_of_group(std::size_t group) const;
  [[nodiscard]] bool fits_groups(ByteView response) const;
  [[nodiscard]] bool fits_objects(ByteView response) const;
  [[nodiscard]] Reply unpack_groups(ByteView response) const;
  [[nodiscard]] Reply unpack_objects(ByteView response) const;
  [[nodiscard]] Reply unpack_queue(ByteView response) const;

  Bytes pdu_;
  std::size_t response_size_ = 0;
  // The last range read; without items if the response echoes the start of the request.
  Range read_{.count = 0};
};

}  // namespace fieldcast::modbus
