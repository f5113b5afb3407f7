// Codes of refusals. Four digits, 3C and 4C frames: MELSEC-L serial communication module user's
// manual (SH-080894), 15.2.2, and QnUCPU user's manual (function explanation), 6.24. Two digits, 1C
// frames: 15.2.3 of the former. A code that reports wrong characters of the request is caused by
// the line, because the bridge sends valid ones.
#pragma once

#include <array>

#include "core/protocol/device_code.hpp"
#include "core/protocol/mitsubishi_mc/codes.hpp"

namespace fieldcast::mitsubishi_mc {

inline constexpr std::array kModuleCodes{
    DeviceCode{0x7153, "the length of the request is out of range"},
    DeviceCode{0x7155, "no monitor data is registered at the module"},
    DeviceCode{0x7157, "the addressed module does not support the request"},
    DeviceCode{0x7164, "wrong data or device in the request"},
    DeviceCode{0x7167, "writes while the CPU runs are disabled"},
    DeviceCode{0x7168, "the command is not possible while the CPU runs"},
    DeviceCode{0x7E40, "the command does not exist"},
    DeviceCode{0x7E41, "too many points in one random request"},
    DeviceCode{0x7E42, "too many points in one request"},
    DeviceCode{0x7E43, "the device does not exist, or not for this command"},
    DeviceCode{0x7E47, "a request arrived before the last response", Cause::kDeviceBusy},
    DeviceCode{0x7E4F, "the request exceeds the highest number of the device"},
    DeviceCode{0x7F01, "the receive buffer is full", Cause::kDeviceBusy},
    DeviceCode{0x7F20, "characters that are not digits", Cause::kChecksum},
    DeviceCode{0x7F21, "wrong header of the request", Cause::kChecksum},
    DeviceCode{0x7F22, "the command or the device does not exist"},
    DeviceCode{0x7F23, "wrong end of the request", Cause::kChecksum},
    DeviceCode{0x7F24, "wrong sum of the request", Cause::kChecksum},
    DeviceCode{0x7F31, "both sides sent at the same time", Cause::kDeviceBusy},
    DeviceCode{0x7F67, "overrun of the receiver", Cause::kChecksum},
    DeviceCode{0x7F69, "wrong parity", Cause::kChecksum},
    DeviceCode{0x7F6A, "characters lost: the receive buffer is full", Cause::kChecksum},
};
inline constexpr auto kSerialCodes = joined_codes(kCpuCodes, kModuleCodes);

inline constexpr std::array kShortCodes{
    DeviceCode{0x00, "writes while the CPU runs are disabled (1C)"},
    DeviceCode{0x01, "wrong parity (1C)", Cause::kChecksum},
    DeviceCode{0x02, "wrong sum of the request (1C)", Cause::kChecksum},
    DeviceCode{0x03, "the request has another form than set at the module", Cause::kChecksum},
    DeviceCode{0x04, "wrong stop bit", Cause::kChecksum},
    DeviceCode{0x05, "overrun of the receiver (1C)", Cause::kChecksum},
    DeviceCode{0x06, "the device or the command does not exist, or too many points"},
    DeviceCode{0x07, "characters that cannot be used", Cause::kChecksum},
    DeviceCode{0x08, "the CPU cannot be accessed", Cause::kDeviceBusy},
    DeviceCode{0x0A, "wrong PC number (FX)"},
    DeviceCode{0x10, "wrong PC number"},
    DeviceCode{0x11, "error at the access to the CPU", Cause::kDeviceBusy, true},
    DeviceCode{0x18, "remote run or stop is disabled (FX)"},
};

}  // namespace fieldcast::mitsubishi_mc
