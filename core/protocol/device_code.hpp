// What the codes mean with which devices refuse: exception codes, end codes, return codes. One row
// for each, in the table of its family. The row also says what the code means for the next read.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/base/cause.hpp"

namespace fieldcast {

struct DeviceCode {
  std::uint16_t code;  // four digits that end in 00 stand for their whole class: 2100 for 21xx
  std::string_view text;
  // kDeviceError: the address, the value or the function is refused, and is requested again only
  // after a while. kDeviceBusy: a state of the moment, handled like a missed answer. kChecksum: the
  // line garbled the request.
  Cause cause = Cause::kDeviceError;
  // With kDeviceBusy: a write may have taken effect although it brought this code.
  bool may_have_written = false;
};

// The cause of the code's row; kDeviceError for a code that the table does not know.
[[nodiscard]] Cause device_code_cause(std::span<const DeviceCode> codes, std::uint16_t code);

// Whether a write that brought this momentary code may have taken effect. 0: the device gave no
// code.
[[nodiscard]] bool may_have_written(std::span<const DeviceCode> codes, std::uint16_t code);

// "illegal data address", or nothing for a code that the table does not know.
[[nodiscard]] std::string_view device_code_text(std::span<const DeviceCode> codes,
                                                std::uint16_t code);

// "02 illegal data address", "code 5A": the code in hexadecimal, as the standards write them.
[[nodiscard]] std::string device_code_words(std::span<const DeviceCode> codes, std::uint16_t code);

// " (02 illegal data address)", to stand behind a fault; nothing for 0, which is no code.
[[nodiscard]] std::string device_code_note(std::span<const DeviceCode> codes, std::uint16_t code);

}  // namespace fieldcast
