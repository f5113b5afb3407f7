#include "core/program/marker_framing.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast::program {

namespace {

constexpr std::size_t kStart = kFrameStart.size(), kEnd = kFrameEnd.size();

}  // namespace

ControlCode MarkerReader::taken(std::string_view code) {
  drop(kStart + code.size() + kEnd);
  return {std::string(code)};
}

Duration MarkerReader::patience() const {
  const auto text = as_text(buffer_);
  if (!text.starts_with(kFrameStart)) return kHalfWait;
  const FrameOpening opening = opening_of(text.substr(kStart), sender_);
  const bool whole = text.size() <= kStart + opening.code.size() + kEnd + 1;  // except for one `@`
  return opening.what == Opening::kUndecided && !opening.code.empty() && whole ? kCodeWait
                                                                               : kHalfWait;
}

std::optional<ControlCode> MarkerReader::take_code() {
  const auto text = as_text(buffer_);
  if (skipping_ || !text.starts_with(kFrameStart)) return std::nullopt;
  const FrameOpening opening = opening_of(text.substr(kStart), sender_);
  if (opening.what != Opening::kUndecided || opening.code.empty()) return std::nullopt;
  return taken(opening.code);
}

void MarkerReader::drop(std::size_t count) {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(count));
  searched_ = 0;
}

// Keeps the last bytes, which may be part of the end mark.
std::optional<MarkerFrame> MarkerReader::skip() {
  const auto text = as_text(buffer_);
  const auto end = text.find(kInstructionEnd);
  if (end == text.npos) {
    const std::size_t keep = std::min(text.size(), kInstructionEnd.size() - 1);
    skipped_ += text.size() - keep;
    drop(text.size() - keep);
    return std::nullopt;
  }
  skipped_ += end + kInstructionEnd.size();
  drop(end + kInstructionEnd.size());
  skipping_ = false;
  return BrokenFrame{FrameFault::kTooLong, std::exchange(skipped_, 0)};
}

// Empty if a frame begins, or if too few bytes have arrived.
std::optional<MarkerFrame> MarkerReader::noise() {
  const auto text = as_text(buffer_);
  const auto start = text.find(kFrameStart);
  std::size_t foreign = start;
  if (start == text.npos) foreign = text.ends_with('@') ? text.size() - 1 : text.size();
  if (foreign == 0) return std::nullopt;
  drop(foreign);
  return BrokenFrame{FrameFault::kNoise, foreign};
}

std::optional<MarkerFrame> MarkerReader::control(Phase phase) {
  const auto text = as_text(buffer_);
  if (phase == Phase::kTransmission) {
    const FrameOpening opening = opening_of(text.substr(kStart), sender_);
    if (opening.what != Opening::kControl) return std::nullopt;
    return taken(opening.code);
  }
  const auto end = text.find(kFrameEnd, kStart);
  const std::size_t length = (end == text.npos ? text.size() : end) - kStart;
  if (length > kMaxHandshakeCode) {
    const std::size_t dropped = std::min(text.size(), kStart + length);
    drop(dropped);
    return BrokenFrame{FrameFault::kTooLong, dropped};
  }
  if (end == text.npos) return std::nullopt;
  std::string code(text.substr(kStart, length));
  drop(end + kEnd);
  return ControlCode{std::move(code)};
}

std::optional<MarkerFrame> MarkerReader::next(Phase phase) {
  if (skipping_) return skip();
  if (auto foreign = noise()) return foreign;
  if (buffer_.size() < kStart) return std::nullopt;
  if (auto code = control(phase)) return code;
  if (phase == Phase::kHandshake) return std::nullopt;

  const auto text = as_text(buffer_);
  const auto end = text.find(kInstructionEnd, std::max(searched_, kStart));
  const std::size_t length = (end == text.npos ? text.size() : end + 1) - kStart;
  if (length > kMaxInstruction + (end == text.npos ? kEnd : 0)) {
    skipping_ = true;
    return skip();
  }
  if (end == text.npos) {
    searched_ = text.size() - std::min(text.size(), kInstructionEnd.size() - 1);
    return std::nullopt;
  }
  Instruction instruction{Bytes(buffer_.begin() + kStart,
                                buffer_.begin() + static_cast<std::ptrdiff_t>(kStart + length))};
  drop(end + kInstructionEnd.size());
  return instruction;
}

std::optional<BrokenFrame> MarkerReader::give_up() {
  if (!partial()) return std::nullopt;
  const std::size_t dropped = std::exchange(skipped_, 0) + buffer_.size();
  skipping_ = false;
  drop(buffer_.size());
  return BrokenFrame{FrameFault::kHalf, dropped};
}

Bytes MarkerReader::take_rest() {
  searched_ = 0;
  return std::exchange(buffer_, {});
}

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
    const auto end = std::ranges::find(bytes, kCr);
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
