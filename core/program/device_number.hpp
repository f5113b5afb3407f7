// Number of a device for engineers and dial-in modules: 1 to 16 letters or digits.
#pragma once

#include <string_view>

namespace fieldcast::program {

inline constexpr std::size_t kMaxDeviceNumber = 16;

// Returns true if no frame can confuse it with another code: not `ED`, `HB` or a reply (four digits
// that begin with 000), without the marker `FEFF`, and not beginning with `V2`, which requests
// framing by length.
[[nodiscard]] bool is_device_number(std::string_view text);

inline constexpr std::string_view kDeviceNumberForm =
    "1 to 16 letters or digits; not ED, not HB, not 000 and a digit, not beginning with V2, "
    "without FEFF";

}  // namespace fieldcast::program
