#include "tools/cli/capture/block_cutter.hpp"

#include "core/capture/pcapng.hpp"

namespace fieldcast::cli {
namespace {

// Little-endian: the bridge runs on the same machine.
std::uint32_t number_at(ByteView bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at]) | static_cast<std::uint32_t>(bytes[at + 1]) << 8 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 16 |
         static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}

}  // namespace

std::vector<BlockCutter::Block> BlockCutter::take(ByteView bytes) {
  append(waiting_, bytes);
  std::vector<Block> blocks;
  std::size_t at = 0;
  while (!broken_ && waiting_.size() - at >= 8) {
    const std::uint32_t type = number_at(waiting_, at), length = number_at(waiting_, at + 4);
    broken_ = length < 12 || length % 4 != 0 || length > pcapng::kMaxBlock;
    if (broken_ || waiting_.size() - at < length) break;
    const ByteView block = ByteView(waiting_).subspan(at, length);
    blocks.push_back({type, Bytes(block.begin(), block.end())});
    at += length;
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(at));
  return blocks;
}

}  // namespace fieldcast::cli
