// The words of the system for an error number, from any thread (strerror() need not be safe).
#pragma once

#include <string>
#include <system_error>

namespace fieldcast {

[[nodiscard]] inline std::string errno_text(int error) {
  return std::generic_category().message(error);
}

}  // namespace fieldcast
