// Splits a stream of marker frames, which may arrive in any pieces. Pure; owned by one end of a
// connection.
//
// In transmission, program bytes end at CR FEFF, and a control frame is one of the known codes. So
// an instruction may contain the markers: `@00WD0000FEFF..` does not end there. Sometimes later
// bytes are needed to detect the end of a frame.
//
// An instruction may even begin like a control frame: the continuation of a Host Link response
// begins with any words, `0003FEFF12..`. The bytes after FEFF distinguish them:
//
//     @@0003FEFF @@ ..               control: the next frame begins
//     @@0003FEFF .. CR FEFF          an instruction with its end
//     @@0003FEFF .. CR other bytes   control, and noise after it: CR is an instruction's last byte
//     @@0003FEFF                     control, if no byte follows within kCodeWait
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "core/base/time.hpp"
#include "core/program/frame.hpp"

namespace fieldcast::program {

struct ControlCode {
  std::string code;
};
// Includes the CR.
struct Instruction {
  Bytes bytes;
};
struct BrokenFrame {
  FrameFault fault;
  std::size_t bytes = 0;  // dropped bytes
};
using MarkerFrame = std::variant<ControlCode, Instruction, BrokenFrame>;

class MarkerReader {
 public:
  enum class Phase : std::uint8_t {
    kHandshake,     // every frame is a control frame
    kTransmission,  // program bytes, and the sender's codes for transmission
  };
  // Timeouts: kHalfWait for the rest of an instruction, kCodeWait after a control frame.
  static constexpr Duration kHalfWait = std::chrono::seconds{2},
                            kCodeWait = std::chrono::milliseconds{200};

  explicit MarkerReader(Sender sender) : sender_(sender) {}

  void feed(ByteView bytes) { append(buffer_, bytes); }
  // Call until it returns empty. Then it holds little more than kMaxInstruction bytes at most.
  [[nodiscard]] std::optional<MarkerFrame> next(Phase phase);
  [[nodiscard]] bool partial() const { return !buffer_.empty() || skipping_; }
  [[nodiscard]] std::size_t held() const { return buffer_.size(); }
  // How long an incomplete frame may wait after its last byte.
  [[nodiscard]] Duration patience() const;
  // Call if no more bytes arrive in time. Returns a control frame that no bytes followed.
  [[nodiscard]] std::optional<ControlCode> take_code();
  [[nodiscard]] std::optional<BrokenFrame> give_up();
  // Bytes after the last frame, if the stream changes to another framing.
  [[nodiscard]] Bytes take_rest();

 private:
  [[nodiscard]] std::optional<MarkerFrame> skip();
  [[nodiscard]] std::optional<MarkerFrame> noise();
  [[nodiscard]] std::optional<MarkerFrame> control(Phase phase);
  [[nodiscard]] ControlCode taken(std::string_view code);
  void drop(std::size_t count);

  Sender sender_;
  Bytes buffer_;
  std::size_t searched_ = 0;  // the buffer has no end mark before it
  bool skipping_ = false;     // within a frame that is too long
  std::size_t skipped_ = 0;
};

// Packs the bytes of a serial line into marker frames, one per instruction: CR is always its last
// character. Pure; owned by one end of a connection.
class MarkerWriter {
 public:
  explicit MarkerWriter(Sender sender) : sender_(sender) {}

  // An instruction without its CR waits. Returns the dropped data.
  [[nodiscard]] std::vector<BrokenFrame> write(ByteView bytes, Bytes& out);
  [[nodiscard]] bool partial() const { return !instruction_.empty() || skipped_ > 0; }
  [[nodiscard]] std::optional<BrokenFrame> give_up();

 private:
  Sender sender_;
  Bytes instruction_;
  std::size_t skipped_ = 0;  // of an instruction that is too long, so far
};

}  // namespace fieldcast::program
