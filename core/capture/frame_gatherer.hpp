// Builds frames from the records of a bus: joins the pieces of a response, separates an echo of the
// request, and adds comments. A request is written when its response begins or its exchange ends,
// so that its comment can report a missing response. Pure; owned by the writer of a capture, on its
// thread.
#pragma once

#include <optional>
#include <vector>

#include "core/capture/capture_record.hpp"

namespace fieldcast {

class FrameGatherer {
 public:
  static constexpr std::size_t kMaxFrame = 16384;   // bytes; longer data become several frames
  static constexpr std::size_t kMaxComment = 1000;  // bytes; longer comments are cut
  // Unsolicited bytes form one frame until this silence.
  static constexpr Duration kQuiet = std::chrono::milliseconds{50};

  void take(CaptureRecord record, std::vector<CapturedFrame>& out);
  void lost(std::uint64_t records, std::vector<CapturedFrame>& out);
  // Writes waiting frames if no byte arrived for kQuiet.
  void look(UtcTime now, std::vector<CapturedFrame>& out);
  void flush(std::vector<CapturedFrame>& out);

 private:
  void take_received(CaptureRecord record, std::vector<CapturedFrame>& out);
  void remark(const std::string& text, std::vector<CapturedFrame>& out);
  void give_request(std::vector<CapturedFrame>& out);
  void give_answer(std::vector<CapturedFrame>& out);
  void give(CapturedFrame frame, std::vector<CapturedFrame>& out);

  std::optional<CapturedFrame> request_;  // without a response so far
  std::optional<CapturedFrame> answer_;   // received part
  Bytes echo_;                            // last request, whose echo may precede the response
  std::size_t device_ = 0;
  bool asked_ = false;  // an exchange is in flight
  bool begun_ = false;  // an exchange has begun or ended
  std::string note_;    // for the next frame
};

}  // namespace fieldcast
