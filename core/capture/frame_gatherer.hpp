// Makes frames of what a bus says of its wire: joins the pieces of an answer, sets an echo of the
// request apart, and puts what is known of an exchange into comments.
//
// A request is given out when its answer begins or its exchange ends, so that its comment can say
// that nobody answered. Pure; owned by whoever writes a capture, on that thread. Nothing can fail.
#pragma once

#include <optional>
#include <vector>

#include "core/capture/capture_record.hpp"

namespace fieldcast {

class FrameGatherer {
 public:
  static constexpr std::size_t kMaxFrame = 16384;   // bytes; more become another frame
  static constexpr std::size_t kMaxComment = 1000;  // bytes; what is beyond is cut
  // Bytes that nobody asked for are one frame until the wire was silent for this long.
  static constexpr Duration kQuiet = std::chrono::milliseconds{50};

  void take(CaptureRecord record, std::vector<CapturedFrame>& out);
  // Records are missing here.
  void lost(std::uint64_t records, std::vector<CapturedFrame>& out);
  // Gives out what waits, if nothing came for kQuiet.
  void look(UtcTime now, std::vector<CapturedFrame>& out);
  // Gives out everything: the capture ends.
  void flush(std::vector<CapturedFrame>& out);

 private:
  void take_received(CaptureRecord record, std::vector<CapturedFrame>& out);
  void remark(const std::string& text, std::vector<CapturedFrame>& out);
  void give_request(std::vector<CapturedFrame>& out);
  void give_answer(std::vector<CapturedFrame>& out);
  void give(CapturedFrame frame, std::vector<CapturedFrame>& out);

  std::optional<CapturedFrame> request_;  // that has no answer yet
  std::optional<CapturedFrame> answer_;   // as far as it came
  Bytes echo_;                            // the last request: it may come back before the answer
  std::size_t device_ = 0;
  bool asked_ = false;  // an exchange is under way
  bool begun_ = false;  // an exchange has begun or ended
  std::string note_;    // for the next frame
};

}  // namespace fieldcast
