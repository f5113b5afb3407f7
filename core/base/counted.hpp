// "1 device", "2 devices": a number with its noun. Pure.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace fieldcast {

[[nodiscard]] inline std::string counted(std::size_t count, std::string_view one,
                                         std::string_view many) {
  return std::to_string(count) + ' ' + std::string(count == 1 ? one : many);
}

}  // namespace fieldcast
