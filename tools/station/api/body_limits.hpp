// Limits of request bodies that may be longer than usual, in bytes.
#pragma once

#include <cstddef>

namespace fieldcast::web {

// A text escaped as JSON, or a file in base64, with the members beside it.
inline constexpr std::size_t kMaxConfigurationBody = 5 * 1024 * 1024;
inline constexpr std::size_t kMaxDashboardBody = 192 * 1024;
inline constexpr std::size_t kMaxPictureBody = 384 * 1024;

}  // namespace fieldcast::web
