// Checks the folders of `capture:`: the folder exists, this user may write in it, and the disk has
// enough space. For `--check` and `fieldcast doctor`.
//
// Reads the file system of this machine; any thread. A check that cannot be done gives no remark.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/model/spec.hpp"

namespace fieldcast {

struct CaptureRemark {
  std::size_t index = 0;  // of the bus in the configuration
  std::string bus;
  std::string folder;
  std::string what;  // "no such folder: .."
  std::string remedy;
};
// At most one remark per bus, in the order of the buses. Buses on one disk share its free space.
[[nodiscard]] std::vector<CaptureRemark> capture_remarks(const BridgeSpec& spec);

}  // namespace fieldcast
