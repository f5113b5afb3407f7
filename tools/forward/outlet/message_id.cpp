#include "tools/forward/outlet/message_id.hpp"

#include <fmt/format.h>

#include "tools/forward/payload/json_payload.hpp"

namespace fieldcast::forward {

std::string message_id_of(std::string_view site, const Record& record) {
  return fmt::format("{}/{}/{}/{}", site, record.bus, hex_text(record.epoch),
                     hex_text(record.identity));
}

}  // namespace fieldcast::forward
