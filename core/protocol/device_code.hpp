// Codes of refusals (exception codes, end codes, return codes), one row each.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/base/cause.hpp"

namespace fieldcast {

struct DeviceCode {
  std::uint16_t code;  // four digits that end in 00 cover their whole class: 2100 for 21xx
  std::string_view text;
  // kDeviceError: refused; repeated only after a while. kDeviceBusy: temporary, like a missing
  // response. kChecksum: the request was damaged on the line.
  // kMalformed: the connection is unusable.
  Cause cause = Cause::kDeviceError;
  // With kDeviceBusy: a write may have taken effect although it brought this code.
  bool may_have_written = false;
};

template <std::size_t N, std::size_t M>
[[nodiscard]] constexpr auto joined_codes(const std::array<DeviceCode, N>& first,
                                          const std::array<DeviceCode, M>& second) {
  std::array<DeviceCode, N + M> all{};
  std::ranges::copy(second, std::ranges::copy(first, all.begin()).out);
  return all;
}

// kDeviceError for a code without a row.
[[nodiscard]] Cause device_code_cause(std::span<const DeviceCode> codes, std::uint16_t code);

// Returns true if the refused write may have taken effect. 0: the device gave no code.
[[nodiscard]] bool may_have_written(std::span<const DeviceCode> codes, std::uint16_t code);

// "illegal data address"; empty for a code without a row.
[[nodiscard]] std::string_view device_code_text(std::span<const DeviceCode> codes,
                                                std::uint16_t code);

// "02 illegal data address", "code 5A".
[[nodiscard]] std::string device_code_words(std::span<const DeviceCode> codes, std::uint16_t code);

// " (02 illegal data address)", to follow a fault; empty for 0.
[[nodiscard]] std::string device_code_note(std::span<const DeviceCode> codes, std::uint16_t code);

}  // namespace fieldcast
