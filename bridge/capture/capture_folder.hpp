// The folder of a bus with a permanent capture: file names and free disk space. Any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/base/time.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

// "press-shop-20261122T142421Z.pcapng". More files that begin in the same second have a `number`
// from 2 on: "press-shop-20261122T142421Z-0002.pcapng".
[[nodiscard]] std::string ring_file_name(const std::string& bus, UtcTime begun, int number);

// Returns the files of the bus among `names`, sorted by time.
[[nodiscard]] std::vector<std::string> ring_files(const std::string& bus,
                                                  std::vector<std::string> names);
// The same for the present files of a folder; empty if the folder cannot be read.
[[nodiscard]] std::vector<std::string> ring_files_in(const std::string& folder,
                                                     const std::string& bus);

// Free bytes of the disk for users other than root. The error is one line with the folder.
[[nodiscard]] tl::expected<std::uint64_t, std::string> free_bytes_at(const std::string& folder);

// Checks the folders of `capture:` for `--check` and `fieldcast doctor`: each exists, this user may
// write, and the disk has enough space. Any thread. A check that cannot be done gives no remark.
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
