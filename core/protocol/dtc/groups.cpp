#include "core/protocol/dtc/groups.hpp"

#include "core/protocol/dtc/message.hpp"
#include "core/protocol/dtc/types.hpp"

namespace fieldcast::dtc {

std::size_t group_size(ByteView bytes, bool with_data) {
  if (bytes.size() < kGroupHead || bytes[2] >= kTypeCount) return 0;
  const std::size_t data = with_data ? data_bytes(bytes[2], read_u16(bytes, 3)) : 0;
  return kGroupHead + data <= bytes.size() ? kGroupHead + data : 0;
}

bool inside(ByteView group) {
  return read_u16(group) + std::size_t{read_u16(group, 3)} <= kVariables;
}

bool all_groups(ByteView bytes, bool with_data) {
  if (bytes.empty()) return false;
  while (!bytes.empty()) {
    const std::size_t size = group_size(bytes, with_data);
    if (size == 0 || read_u16(bytes, 3) == 0) return false;
    if (!with_data && !inside(bytes)) return false;
    bytes = bytes.subspan(size);
  }
  return true;
}

}  // namespace fieldcast::dtc
