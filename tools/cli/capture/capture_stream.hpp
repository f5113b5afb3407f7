// Splits a pcapng stream into whole blocks. Pure; buffers an incomplete block.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/capture/capture_socket.hpp"
#include "core/base/bytes.hpp"

namespace fieldcast::cli {

class BlockCutter {
 public:
  struct Block {
    std::uint32_t type = 0;
    Bytes bytes;
  };
  [[nodiscard]] std::vector<Block> take(ByteView bytes);
  [[nodiscard]] bool broken() const { return broken_; }  // the stream is not pcapng

 private:
  Bytes waiting_;
  bool broken_ = false;
};

struct FoundBridge {
  CaptureSocketName socket;
  std::string name;
  std::vector<std::string> buses;
};
struct Bridges {
  std::vector<FoundBridge> found;
  std::vector<std::string> refused;  // names of bridges that refuse this user
};

// Finds the bridges that allow this user to capture, and requests captures
// (bridge/capture/capture_socket.hpp). Blocks, with a time limit. Main thread.
[[nodiscard]] Bridges find_bridges();

// Returns a connection that sends pcapng.
[[nodiscard]] tl::expected<FileDescriptor, std::string> ask_for_capture(
    const CaptureSocketName& socket, const std::string& bus);

}  // namespace fieldcast::cli
