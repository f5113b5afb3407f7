// End codes of responses. Ethernet and CPU codes: MELSEC-L CPU module user's manual (built-in
// Ethernet function), 5.4, and the SLMP manual of FX5 (JY997D56001). Others: SLMP specification of
// the CC-Link Partner Association.
#pragma once

#include <array>

#include "core/protocol/device_code.hpp"

namespace fieldcast::mitsubishi_mc {

// Of the CPU, in responses of any module.
inline constexpr std::array kCpuCodes{
    DeviceCode{0x4000, "the CPU module refused the request"},
    DeviceCode{0x4010, "not possible while the CPU runs", Cause::kDeviceBusy},
    DeviceCode{0x4013, "not possible in the present state of the CPU", Cause::kDeviceBusy},
    DeviceCode{0x4030, "the CPU does not have this device"},
    DeviceCode{0x4031, "the number of the device is out of range"},
};
inline constexpr std::array kEthernetCodes{
    DeviceCode{0x0055, "the PLC does not permit writes while it runs"},
    DeviceCode{0xC035, "the other station could not be reached", Cause::kDeviceBusy, true},
    DeviceCode{0xC050, "ASCII digits that are not a number"},
    DeviceCode{0xC051, "too many bits in one request"},
    DeviceCode{0xC052, "too many words in one request"},
    DeviceCode{0xC053, "too many bits in one random request"},
    DeviceCode{0xC054, "too many words in one random request"},
    DeviceCode{0xC056, "the request exceeds the highest address"},
    DeviceCode{0xC058, "the length of the request differs from its ASCII text"},
    DeviceCode{0xC059, "command or subcommand not supported"},
    DeviceCode{0xC05B, "the CPU cannot read or write this device"},
    DeviceCode{0xC05C, "the request contains an error, for example bit units for words"},
    DeviceCode{0xC05D, "no monitor data is registered"},
    DeviceCode{0xC05F, "the request is not possible for this station"},
    DeviceCode{0xC060, "invalid value for a bit"},
    DeviceCode{0xC061, "the length of the request differs from its contents"},
    DeviceCode{0xC06F, "ASCII code received, but binary code is set, or the reverse"},
    DeviceCode{0xC0D8, "too many blocks in one request"},
    DeviceCode{0xC200, "wrong remote password"},
    DeviceCode{0xC201, "the port is locked by the remote password"},
    DeviceCode{0xC204, "another client unlocked the port"},
    DeviceCode{0xC810, "remote password refused"},
    DeviceCode{0xC815, "remote password refused ten times"},
    DeviceCode{0xC816, "remote password locked out"},
    DeviceCode{0xCEE0, "busy with another request", Cause::kDeviceBusy},
    DeviceCode{0xCEE1, "the request is too long"},
    DeviceCode{0xCEE2, "the response would be too long"},
    DeviceCode{0xCF70, "error on the way to the other station", Cause::kDeviceBusy, true},
    DeviceCode{0xCF71, "the other station did not respond in time", Cause::kDeviceBusy, true},
};
inline constexpr auto kCodes = joined_codes(kCpuCodes, kEthernetCodes);

}  // namespace fieldcast::mitsubishi_mc
