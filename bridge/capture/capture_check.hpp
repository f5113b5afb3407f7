// Whether the folders of `capture:` can take what the configuration asks for: they exist, this user
// may write in them, and the disk has room. For `--check` and `fieldcast doctor`.
//
// Owns nothing. Looks at the file system of this machine; any thread. What it cannot find out, it
// says nothing about.
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
  std::string what;    // "no such folder: .."
  std::string remedy;  // one line
};
// Of each bus at most one, in the order of the buses. Buses on one disk share its room.
[[nodiscard]] std::vector<CaptureRemark> capture_remarks(const BridgeSpec& spec);

}  // namespace fieldcast
