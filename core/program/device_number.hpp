// The number under which a device is known to engineers and to modules that dial in: 1 to 16
// letters or digits.
#pragma once

#include <string_view>

namespace fieldcast::program {

inline constexpr std::size_t kMaxDeviceNumber = 16;

// Whether no frame could take it for something else: not `ED`, not `HB`, not a reply (four digits
// that begin with 000), not with the marker `FEFF` inside, and not beginning with `V2`, which asks
// for the framing by length.
[[nodiscard]] bool is_device_number(std::string_view text);

inline constexpr std::string_view kDeviceNumberForm =
    "1 to 16 letters or digits; not ED, not HB, not 000 and a digit, not beginning with V2, "
    "without FEFF";

}  // namespace fieldcast::program
