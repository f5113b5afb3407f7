// What an address tells by its notation alone: the topics do not say which protocol a device
// speaks. Where the built-in families that know the notation disagree, nothing is told. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace fieldcast::cli {

// The type of a value there: "bool" for coil:16 and for I0.3, "uint32" for VD204; nothing where the
// notation leaves it open.
[[nodiscard]] std::string implied_type(std::string_view at);

// With what a device refused such an address: "02 illegal data address", or "code 5A".
[[nodiscard]] std::string device_code_at(std::string_view at, std::uint16_t code);

}  // namespace fieldcast::cli
