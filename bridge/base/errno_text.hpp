// The system's text of an error number. Any thread (strerror() need not be thread-safe).
#pragma once

#include <string>
#include <system_error>

namespace fieldcast {

[[nodiscard]] inline std::string errno_text(int error) {
  return std::generic_category().message(error);
}

}  // namespace fieldcast
