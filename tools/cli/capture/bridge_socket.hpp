// Finds the bridges of this machine that let this user capture, and asks one of them
// (bridge/capture/capture_socket.hpp). Blocking, with a limit. Main thread.
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
  std::vector<std::string> refused;  // names of bridges that this user may not capture
};
// Those that answer within a second.
[[nodiscard]] Bridges find_bridges();

// A connection that brings pcapng from now on. The error is one line.
[[nodiscard]] tl::expected<FileDescriptor, std::string> ask_for_capture(
    const CaptureSocketName& socket, const std::string& bus);

}  // namespace fieldcast::cli
