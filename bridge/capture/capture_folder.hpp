// The folder of a bus that is always captured: what its files are called, which lie there, and how
// much room its disk has.
//
// Owns nothing; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast {

// "press-shop-20261122T142421Z.pcapng"; `number` from 2 on for more that begin in one second:
// "press-shop-20261122T142421Z-0002.pcapng".
[[nodiscard]] std::string ring_file_name(const std::string& bus, UtcTime begun, int number);

// Those of the bus among the names of a folder, by their time.
[[nodiscard]] std::vector<std::string> ring_files(const std::string& bus,
                                                  std::vector<std::string> names);
// The same of the names that a folder has now; none where it cannot be read.
[[nodiscard]] std::vector<std::string> ring_files_in(const std::string& folder,
                                                     const std::string& bus);

// Of the folder's disk, for users that are not root, in bytes. The error is one line that begins
// with the folder.
[[nodiscard]] tl::expected<std::uint64_t, std::string> free_bytes_at(const std::string& folder);

}  // namespace fieldcast
