// Function and exception codes (Modbus Application Protocol V1.1b3, 6 and 7).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/base/bytes.hpp"
#include "core/protocol/device_code.hpp"

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
  kMaskWrite = 22,
  kReadWrite = 23,
};

inline constexpr std::uint8_t kExceptionFlag = 0x80;
inline constexpr std::size_t kMaxPdu = 253;

// "read coils"; "unknown function".
[[nodiscard]] std::string_view function_text(std::uint8_t function);

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
[[nodiscard]] std::size_t answer_pdu_size(ByteView pdu);

// The same for requests.
[[nodiscard]] std::size_t request_pdu_size(ByteView pdu);

}  // namespace fieldcast::modbus
