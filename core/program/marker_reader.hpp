// Cuts a stream of marker frames, however it arrives in pieces. Pure; owned by one end of a
// connection.
//
// In transmission a frame of program bytes ends at CR FEFF and a control frame is one whose whole
// code is in the table, so that an instruction may hold the markers: `@00WD0000FEFF..` is no end.
// Sometimes later bytes show whether a frame has ended: until then it waits.
//
// An instruction may even begin like a control frame: the continuation of a Host Link answer begins
// with any words, `0003FEFF12..`. The bytes behind FEFF show which of the two it is:
//
//     @@0003FEFF @@ ..               control: the next frame begins
//     @@0003FEFF .. CR FEFF          an instruction: it ends as instructions do
//     @@0003FEFF .. CR other bytes   control, and noise behind it: CR is an instruction's last byte
//     @@0003FEFF                     control when kCodeWait brings nothing more
#pragma once

#include <optional>
#include <variant>

#include "core/base/time.hpp"
#include "core/program/frame.hpp"

namespace fieldcast::program {

// A whole frame's code: a device number, a reply, ED, HB.
struct ControlCode {
  std::string code;
};
// One instruction, with its CR.
struct Instruction {
  Bytes bytes;
};
struct BrokenFrame {
  FrameFault fault;
  std::size_t bytes = 0;  // that were dropped
};
using MarkerFrame = std::variant<ControlCode, Instruction, BrokenFrame>;

class MarkerReader {
 public:
  enum class Phase : std::uint8_t {
    kHandshake,     // every frame is a control frame
    kTransmission,  // program bytes, and the codes that its sender has in transmission
  };
  // For the rest of an instruction, and for what may still follow a control frame: the sender
  // writes an instruction in one piece.
  static constexpr Duration kHalfWait = std::chrono::seconds{2},
                            kCodeWait = std::chrono::milliseconds{200};

  explicit MarkerReader(Sender sender) : sender_(sender) {}

  void feed(ByteView bytes) { append(buffer_, bytes); }
  // Call until it gives nothing. Then it holds little more than kMaxInstruction bytes at most.
  [[nodiscard]] std::optional<MarkerFrame> next(Phase phase);
  // Whether a frame has begun that did not end.
  [[nodiscard]] bool partial() const { return !buffer_.empty() || skipping_; }
  [[nodiscard]] std::size_t held() const { return buffer_.size(); }
  // How long what has begun may wait, since the last bytes.
  [[nodiscard]] Duration patience() const;
  // No more bytes come, or not in time: the control frame that nothing followed, if there is one.
  // The stream goes on behind it.
  [[nodiscard]] std::optional<ControlCode> take_code();
  // Its rest did not come in time. Nothing when there is none.
  [[nodiscard]] std::optional<BrokenFrame> give_up();
  // What came behind the last frame, when the stream goes on in another framing.
  [[nodiscard]] Bytes take_rest();

 private:
  [[nodiscard]] std::optional<MarkerFrame> skip();
  [[nodiscard]] std::optional<MarkerFrame> noise();
  [[nodiscard]] std::optional<MarkerFrame> control(Phase phase);
  [[nodiscard]] ControlCode taken(std::string_view code);
  void drop(std::size_t count);

  Sender sender_;
  Bytes buffer_;
  std::size_t searched_ = 0;  // of the buffer: no end before
  bool skipping_ = false;     // a frame that is too long, up to its end
  std::size_t skipped_ = 0;
};

}  // namespace fieldcast::program
