// Finds the bridges that allow this user to capture, and requests captures
// (bridge/capture/capture_socket.hpp). Blocks, with a time limit. Main thread.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/capture/capture_socket.hpp"

namespace fieldcast::cli {

struct FoundBridge {
  CaptureSocketName socket;
  std::string name;
  std::vector<std::string> buses;
};
struct Bridges {
  std::vector<FoundBridge> found;
  std::vector<std::string> refused;  // names of bridges that refuse this user
};
[[nodiscard]] Bridges find_bridges();

// Returns a connection that sends pcapng. The error is one line.
[[nodiscard]] tl::expected<FileDescriptor, std::string> ask_for_capture(
    const CaptureSocketName& socket, const std::string& bus);

}  // namespace fieldcast::cli
