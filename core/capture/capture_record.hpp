// Records of a bus during a capture, and the resulting frames. Plain values, any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

// The comment of each request of a programming session begins with it; the user follows.
inline constexpr std::string_view kSessionComment = "programming session of ";

// The comment of a sent frame that the line gave back ends with it. The frame is not a request.
inline constexpr std::string_view kEchoComment = "the line gave the request back (echo)";

struct CaptureRecord {
  enum class Kind : std::uint8_t {
    kSent,      // bytes; the text is their purpose
    kReceived,  // bytes: one piece as received from the port
    kRemark,    // text: outcome of an exchange, or state of the port
    kEnded,     // the exchange ended: later bytes do not belong to it
  };
  Kind kind = Kind::kReceived;
  UtcTime at;              // kReceived: arrival of the last byte
  std::size_t device = 0;  // kSent: index in the bus's list
  Bytes bytes;
  std::string text;
  // Bytes of an engineer to whom the line is leased, in pieces, or bytes for that engineer.
  bool session = false;
};

enum class Direction : std::uint8_t { kSent, kReceived };

struct CapturedFrame {
  UtcTime at;
  Direction direction = Direction::kReceived;
  std::size_t device = 0;  // last polled device
  Bytes bytes;             // never empty
  std::string comment;     // text lines; may be empty
  bool session = false;
};

// Builds frames from the records of a bus: joins the pieces of a response, separates an echo, and
// adds comments. A request is written when its response begins or its exchange ends, so that its
// comment can report a missing response. Pure; owned by the writer of a capture, on its thread.
class FrameGatherer {
 public:
  static constexpr std::size_t kMaxFrame = 16384;   // bytes; longer data become several frames
  static constexpr std::size_t kMaxComment = 1000;  // bytes; longer comments are cut
  // Unsolicited bytes form one frame until this silence, and bytes of a programming session in one
  // direction until a longer one: software writes a request in pieces, and networks delay them.
  static constexpr Duration kQuiet = std::chrono::milliseconds{50};
  static constexpr Duration kQuietOfSession = std::chrono::milliseconds{250};

  void take(CaptureRecord record, std::vector<CapturedFrame>& out);
  void lost(std::uint64_t records, std::vector<CapturedFrame>& out);
  // Writes waiting frames if no byte arrived for kQuiet.
  void look(UtcTime now, std::vector<CapturedFrame>& out);
  void flush(std::vector<CapturedFrame>& out);

 private:
  void take_sent(CaptureRecord record, std::vector<CapturedFrame>& out);
  void take_received(CaptureRecord record, std::vector<CapturedFrame>& out);
  void remark(const std::string& text, std::vector<CapturedFrame>& out);
  // Whether the bytes at `now` do not belong to the frame.
  [[nodiscard]] static bool is_over(const CapturedFrame& frame, UtcTime now);
  void give_request(std::vector<CapturedFrame>& out);
  void give_response(std::vector<CapturedFrame>& out);
  void give(CapturedFrame frame, std::vector<CapturedFrame>& out);

  std::optional<CapturedFrame> request_;   // without a response so far
  std::optional<CapturedFrame> response_;  // received part
  Bytes echo_;                             // last request, whose echo may precede the response
  std::size_t device_ = 0;
  bool in_flight_ = false;  // an exchange is in flight
  bool begun_ = false;      // an exchange has begun or ended
  std::string note_;        // for the next frame
};

}  // namespace fieldcast
