// The bridge side of programming software that connects to the port of one device, without a client
// of its own: RFC 2217 or raw bytes. Login at a prompt, request for the device, pairing, end. Pure;
// it has the events and actions of Engineer.
#pragma once

#include <string>

#include "core/program/engineer.hpp"
#include "core/telnet/line_server.hpp"

namespace fieldcast::program {

class LineEngineer {
 public:
  static constexpr Duration kStuckWait = Engineer::kStuckWait;
  static constexpr std::size_t kMaxEarly = Engineer::kMaxEarly;
  static constexpr Duration kPromptWait = std::chrono::minutes{1};  // for user and password
  // More responses to a client whose queue is full end the connection.
  static constexpr std::size_t kMaxResponses = 65536;

  // REQUIRES: rules.port.
  LineEngineer(const EngineerRules& rules, Instant now);

  void on_event(const EngineerEvent& event, Instant now, EngineerActions& actions);

  [[nodiscard]] bool over() const { return state_ == State::kOver; }
  [[nodiscard]] std::uint64_t bytes_to_device() const { return to_device_; }
  [[nodiscard]] std::uint64_t bytes_from_device() const { return from_device_; }

 private:
  enum class State : std::uint8_t { kNew, kUser, kPassword, kChecking, kTaking, kPaired, kOver };
  using Actions = EngineerActions;

  template <typename Other>
  void handle(const Other&, Instant, Actions&) {}
  void handle(const FromClient& event, Instant now, Actions& actions);
  void handle(const ClientGone& event, Instant now, Actions& actions);
  void handle(const LoginChecked& event, Instant now, Actions& actions);
  void handle(const DeviceGiven& event, Instant now, Actions& actions);
  void handle(const DeviceRefused& event, Instant now, Actions& actions);
  void handle(const FromDevice& event, Instant now, Actions& actions);
  void handle(const LineChanged& event, Instant now, Actions& actions);
  void handle(const LineState& event, Instant now, Actions& actions);
  void handle(const DeviceLost& event, Instant now, Actions& actions);
  void handle(const ClientTakes& event, Instant now, Actions& actions);
  void handle(const DeviceTakes& event, Instant now, Actions& actions);
  void handle(const ClientDrains& event, Instant now, Actions& actions);
  void handle(const DeviceDrains& event, Instant now, Actions& actions);
  void handle(const TimerFired& event, Instant now, Actions& actions);
  void handle(const Ended& event, Instant now, Actions& actions);

  void begin(Actions& actions);
  void read(ByteView bytes, Instant now, Actions& actions);
  void execute(const telnet::LineChange& change, Actions& actions);
  void respond(Bytes response, Actions& actions);
  void type(ByteView bytes, Actions& actions);
  void entered(Actions& actions);
  void to_device(Bytes bytes, Instant now, Actions& actions);
  void say(std::string_view text, Actions& actions) const;
  void take(Actions& actions);
  // Ends the connection. `text`: for a client with a Telnet prompt.
  void close(Remark remark, std::string_view text, Actions& actions);
  [[nodiscard]] Instant next_wake() const;

  const EngineerRules rules_;
  State state_ = State::kNew;
  Bytes first_;  // requests of the server, for the client
  telnet::LineServer server_{first_};
  Bytes typed_ahead_;        // data behind the password, in the same piece
  Bytes early_;              // received before the device was given
  std::string line_, user_;  // typed at the prompt
  bool after_return_ = false;
  unsigned set_ = 0;        // bits by telnet::Kind: set before the device was given
  bool held_ = false;       // the client has suspended data
  std::size_t unread_ = 0;  // bytes of responses since the client's queue is full
  std::uint64_t to_device_ = 0, from_device_ = 0;
  Instant login_until_, worked_at_;
  Instant client_stuck_ = kNever, device_stuck_ = kNever;
  Instant timer_ = kNever;  // last value sent to the shell
};

}  // namespace fieldcast::program
