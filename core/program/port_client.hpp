// The client side of a pairing, used by `fieldcast-port`. Pure: events and `now` in, actions out.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "core/base/time.hpp"
#include "core/program/frame.hpp"
#include "core/program/marker_framing.hpp"

namespace fieldcast::program {

struct PortClientRules {
  std::string number;
  std::string user, password;  // without a user no login is sent
  bool by_length = true;       // carries any bytes; otherwise instructions in marker frames
  // Settings of the real line, only with framing by length. The program sets its baud rate.
  std::optional<LineFormat> format;
  std::uint32_t baud = 0;  // with a format; 0: as the program sets it, else as configured
  Duration heartbeat = std::chrono::seconds{5};
  // Timeout of the bridge's reply; a delayed login needs time.
  Duration reply = std::chrono::seconds{30};
};

// The frame of a login; empty without a user.
[[nodiscard]] Bytes login_frame(const std::string& user, const std::string& password);

struct PortEnd {
  enum class Kind : std::uint8_t { kStopped, kRefused, kDeviceLost, kBridgeGone, kProtocol };
  Kind kind = Kind::kStopped;
  std::optional<Reply> reply;  // for kRefused
  std::string text;
};

// Human-readable. `user`: of the login that was sent; empty: none.
[[nodiscard]] std::string refusal_text(Reply reply, const std::string& user);

class PortClient {
 public:
  struct Connected {};
  struct FromBridge {
    ByteView bytes;
  };
  struct FromProgram {
    ByteView bytes;
  };
  struct ProgramTakes {
    bool takes = true;  // false if its queue is full; then the bridge is not read
  };
  struct LineChanged {
    LineSettings settings;
  };
  struct BridgeGone {
    std::string reason;
  };
  struct StopAsked {};
  struct TimerFired {};
  using Event = std::variant<Connected, FromBridge, FromProgram, ProgramTakes, LineChanged,
                             BridgeGone, StopAsked, TimerFired>;

  struct ToBridge {
    Bytes bytes;
  };
  struct ToProgram {
    Bytes bytes;
  };
  struct SetTimer {
    Instant at;
  };
  struct Paired {};
  struct Dropped {  // a human-readable description of dropped data
    std::string text;
  };
  struct Finish {  // send the remaining bytes and exit
    PortEnd end;
  };
  using Action = std::variant<ToBridge, ToProgram, SetTimer, Paired, Dropped, Finish>;
  using Actions = std::vector<Action>;

  static constexpr unsigned kMissed = 3;
  static constexpr Duration kHalfWait = MarkerReader::kHalfWait;

  explicit PortClient(PortClientRules rules) : rules_(std::move(rules)) {}
  void on_event(const Event& event, Instant now, Actions& actions);

  [[nodiscard]] bool paired() const { return state_ == State::kPaired; }
  [[nodiscard]] bool over() const { return state_ == State::kOver; }
  [[nodiscard]] std::uint64_t bytes_to_device() const { return to_device_; }
  [[nodiscard]] std::uint64_t bytes_from_device() const { return from_device_; }

 private:
  enum class State : std::uint8_t { kIdle, kAsking, kPaired, kOver };

  void greet(Instant now, Actions& actions);
  void receive(ByteView bytes, Instant now, Actions& actions);
  void read_frames(Instant now, Actions& actions);
  void take_frame(MarkerFrame frame, Instant now, Actions& actions);
  void read_chunks(ByteView bytes, Actions& actions);
  void pass_to_program(Bytes bytes, Actions& actions);
  void code(const std::string& code, Instant now, Actions& actions);
  void set_line(LineSettings settings, Actions& actions) const;
  void send_program(ByteView bytes, Instant now, Actions& actions);
  void stop(Actions& actions);
  // Called also in response to the bridge's heartbeats, whose period may be shorter.
  void send_heartbeat(Actions& actions) const;
  void timer(Instant now, Actions& actions);
  void finish(PortEnd::Kind kind, std::string text, Actions& actions,
              std::optional<Reply> reply = {});
  void bridge_gone(const std::string& reason, Instant now, Actions& actions);
  [[nodiscard]] Instant next_wake() const;
  [[nodiscard]] Instant silence_limit() const;

  PortClientRules rules_;
  State state_ = State::kIdle;
  MarkerReader reader_{Sender::kBridge};
  MarkerWriter writer_{Sender::kClient};
  LengthReader lengths_;
  std::uint64_t to_device_ = 0, from_device_ = 0;
  Instant received_at_{}, heartbeat_at_ = kNever, reply_until_ = kNever;
  Instant half_from_program_ = kNever, half_from_bridge_ = kNever;
  bool program_takes_ = true;
  Instant timer_ = kNever;
};

// Warns of a network whose round trip (of the connection to the bridge) may be longer than the
// programming software waits for a response. Empty if it is short.
[[nodiscard]] std::string slow_path_text(Duration round_trip);

}  // namespace fieldcast::program
