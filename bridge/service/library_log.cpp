#include "bridge/service/library_log.hpp"

#include <fmt/format.h>

#include "bridge/dds/library/library.hpp"
#include "bridge/log/log.hpp"

namespace fieldcast {

void log_library_messages() {
  set_library_lines([](bool error, std::string_view kind, std::string_view text) {
    if (kind == kSecurityLine)
      return error ? log_error("security", text) : log_warning("security", text);
    log_counted(error ? LogLevel::kError : LogLevel::kWarning, "Fast DDS",
                fmt::format("messages of {}", kind), text);
  });
}

}  // namespace fieldcast
