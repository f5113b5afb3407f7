#include "tools/forward/outlet/undecodable.hpp"

#include <fmt/format.h>

#include "bridge/log/log.hpp"

namespace fieldcast::forward {

void log_undecodable(const Record& record) {
  log_counted(LogLevel::kError, "queue", "records that cannot be decoded",
              fmt::format("record {} of {}/{} cannot be decoded; it is removed", record.id,
                          record.bus, record.device));
}

}  // namespace fieldcast::forward
