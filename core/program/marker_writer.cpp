#include "core/program/marker_writer.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast::program {
namespace {

constexpr std::uint8_t kCr = '\r';

// "HBFEFF..\r": a reader would treat the beginning as a control frame.
bool looks_like_control(std::string_view instruction, Sender sender) {
  return opening_of(std::string(instruction) += kFrameEnd, sender).what == Opening::kControl;
}

}  // namespace

std::vector<BrokenFrame> MarkerWriter::write(ByteView bytes, Bytes& out) {
  std::vector<BrokenFrame> broken;
  while (!bytes.empty()) {
    const auto end = std::find(bytes.begin(), bytes.end(), kCr);
    const bool whole = end != bytes.end();
    const auto count = static_cast<std::size_t>(end - bytes.begin()) + (whole ? 1 : 0);
    if (skipped_ > 0 || instruction_.size() + count > kMaxInstruction) {
      skipped_ += std::exchange(instruction_, {}).size() + count;
      if (whole) broken.push_back({FrameFault::kTooLong, std::exchange(skipped_, 0)});
    } else {
      append(instruction_, bytes.first(count));
      if (whole && looks_like_control(as_text(instruction_), sender_)) {
        broken.push_back({FrameFault::kAmbiguous, instruction_.size()});
        instruction_.clear();
      } else if (whole) {
        append(out, as_bytes(kFrameStart));
        append(out, instruction_);
        append(out, as_bytes(kFrameEnd));
        instruction_.clear();
      }
    }
    bytes = bytes.subspan(count);
  }
  return broken;
}

std::optional<BrokenFrame> MarkerWriter::give_up() {
  if (!partial()) return std::nullopt;
  return BrokenFrame{FrameFault::kHalf,
                     std::exchange(skipped_, 0) + std::exchange(instruction_, {}).size()};
}

}  // namespace fieldcast::program
