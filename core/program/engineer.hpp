// The bridge side of an engineer's connection: login, request for a device, pairing, end. Pure. The
// shell assigns devices (TakeDevice gives DeviceGiven or DeviceRefused), lists them (ListDevices
// gives DevicesListed) and owns the byte queues (ClientTakes and DeviceTakes report when one is
// full).
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "core/base/time.hpp"
#include "core/program/device_list.hpp"
#include "core/program/frame.hpp"
#include "core/program/marker_framing.hpp"
#include "core/telnet/line_server.hpp"

namespace fieldcast::program {

// A listening port of one device, for software without a client of its own (LineEngineer).
struct LinePort {
  std::string number;
  bool telnet = true;  // RFC 2217; false: raw bytes
  std::string user;    // the only user that may log in; empty: any programmer
};

struct EngineerRules {
  bool login_needed = false;
  // The shell checks the user of a certificate: LoginChecked arrives without CheckLogin.
  bool by_certificate = false;
  Duration heartbeat = std::chrono::seconds{5};
  Duration idle = std::chrono::minutes{10};  // without program bytes in either direction
  // Limit from the connection, or from the end of a pairing, to the next pairing.
  Duration handshake = std::chrono::seconds{10};
  std::optional<LinePort> port{};  // empty: clients speak the frames of frame.hpp
};

struct FromClient {
  ByteView bytes;  // valid during the call
};
struct ClientGone {
  std::string reason;
};
struct LoginChecked {
  bool allowed = false;
  std::string reason;  // reason for a rejection
};
struct DeviceGiven {
  LineFormat line{};  // in force
};
struct DeviceRefused {
  Reply why = Reply::kNotOnline;
  std::string reason;
};
struct DevicesListed {
  std::vector<ListedDevice> devices;
};
struct FromDevice {
  ByteView bytes;
};
struct DeviceLost {
  std::string reason;
};
struct ClientTakes {
  bool takes = true;  // false if its queue is full
};
struct DeviceTakes {
  bool takes = true;
};
struct ClientDrains {};  // bytes of its queue were sent
struct DeviceDrains {};
// Result of ChangeLine.
struct LineChanged {
  telnet::LineChange change;
  bool done = false;
};
struct LineState {  // as in RFC 2217
  std::uint8_t modem = 0;
  std::uint8_t errors = 0;  // since the last event
};
struct TimerFired {};
struct Ended {  // the bridge stops
  std::string reason;
};
using EngineerEvent =
    std::variant<FromClient, ClientGone, LoginChecked, DeviceGiven, DeviceRefused, DevicesListed,
                 FromDevice, DeviceLost, ClientTakes, DeviceTakes, ClientDrains, DeviceDrains,
                 LineChanged, LineState, TimerFired, Ended>;

struct ToClient {
  Bytes bytes;
};
struct ToDevice {
  Bytes bytes;
};
struct CheckLogin {
  std::string user, password;
};
struct TakeDevice {
  std::string number;
};
struct ListDevices {};
struct SetLine {
  LineSettings settings;
};
// Of LineEngineer; its result is LineChanged.
struct ChangeLine {
  telnet::LineChange change;
};
struct HoldDevice {
  bool hold = false;  // true: do not read the device
};
struct FreeDevice {};
struct HangUp {};  // after all queued bytes were sent
struct SetTimer {
  Instant at;  // replaces the previous one
};
struct Remark {
  enum class Kind : std::uint8_t {
    kLogin,
    kLoginFailed,
    kRefused,
    kListed,
    kPaired,
    kEnded,
    kDropped
  };
  Kind kind;
  std::string text;
};
using EngineerAction =
    std::variant<ToClient, ToDevice, CheckLogin, TakeDevice, ListDevices, SetLine, ChangeLine,
                 HoldDevice, FreeDevice, HangUp, SetTimer, Remark>;
using EngineerActions = std::vector<EngineerAction>;

class Engineer {
 public:
  static constexpr unsigned kMissed = 3;                          // consecutive heartbeats
  static constexpr Duration kHalfWait = MarkerReader::kHalfWait;  // for the rest of an instruction
  // A side whose queue is full is given up if no byte is sent for this time. A slow reader opens
  // its TCP window in steps of several kilobytes, more than half a minute apart at 1200 baud.
  static constexpr Duration kStuckWait = std::chrono::seconds{60};
  // More noise closes the connection.
  static constexpr std::size_t kMaxNoise = 256, kMaxNoiseLater = 8192;
  static constexpr unsigned kMaxRefused = 10;      // consecutive refused requests
  static constexpr unsigned kMaxLists = 10;        // requests for the list without a pairing
  static constexpr std::size_t kMaxEarly = 65536;  // bytes before the response to a request

  Engineer(const EngineerRules& rules, Instant now);

  void on_event(const EngineerEvent& event, Instant now, EngineerActions& actions);

  [[nodiscard]] bool paired() const { return state_ == State::kPaired; }
  [[nodiscard]] bool over() const { return state_ == State::kOver; }
  // Counted for the current or last pairing.
  [[nodiscard]] std::uint64_t bytes_to_device() const { return to_device_; }
  [[nodiscard]] std::uint64_t bytes_from_device() const { return from_device_; }

 private:
  enum class State : std::uint8_t { kHandshake, kLogin, kListing, kTaking, kPaired, kOver };
  using Actions = EngineerActions;

  void handle(const FromClient& event, Instant now, Actions& actions);
  void handle(const ClientGone& event, Instant now, Actions& actions);
  void handle(const LoginChecked& event, Instant now, Actions& actions);
  void handle(const DeviceGiven& event, Instant now, Actions& actions);
  void handle(const DeviceRefused& event, Instant now, Actions& actions);
  void handle(const DevicesListed& event, Instant now, Actions& actions);
  void handle(const FromDevice& event, Instant now, Actions& actions);
  void handle(const DeviceLost& event, Instant now, Actions& actions);
  void handle(const ClientTakes& event, Instant now, Actions& actions);
  void handle(const DeviceTakes& event, Instant now, Actions& actions);
  void handle(const ClientDrains& event, Instant now, Actions& actions);
  void handle(const DeviceDrains& event, Instant now, Actions& actions);
  void handle(const LineChanged&, Instant, Actions&) {}
  void handle(const LineState&, Instant, Actions&) {}
  void handle(const TimerFired& event, Instant now, Actions& actions);
  void handle(const Ended& event, Instant now, Actions& actions);

  // See engineer_frames.cpp:
  void read_frames(Instant now, Actions& actions);
  void take_frame(MarkerFrame frame, Instant now, Actions& actions);
  void read_chunks(ByteView bytes, Instant now, Actions& actions);
  void handshake_code(const std::string& code, Instant now, Actions& actions);
  void transmission_code(const std::string& code, Instant now, Actions& actions);
  void request_list(Actions& actions);
  void login(std::string_view code, Actions& actions);
  void broken(const BrokenFrame& frame, Actions& actions);
  void program_bytes(Bytes bytes, Instant now, Actions& actions);

  [[nodiscard]] bool give_up_client_half(Instant now, Actions& actions);
  void send_heartbeat(Instant now, Actions& actions);
  void reply(Reply reply, Actions& actions);
  void refuse(Reply why, const std::string& reason, Instant now, Actions& actions);
  void end_pairing(const std::string& reason, bool notify, Instant now, Actions& actions);
  void refuse_login(const std::string& reason, Actions& actions);
  void close(const std::string& reason, Actions& actions);
  [[nodiscard]] Instant next_wake() const;
  [[nodiscard]] Instant silence_limit() const;

  EngineerRules rules_;
  State state_ = State::kHandshake;
  bool logged_in_ = false;
  bool was_paired_ = false;
  bool by_length_ = false;  // for the pending request, or the pairing
  MarkerReader reader_{Sender::kClient};
  MarkerWriter writer_{Sender::kBridge};
  LengthReader lengths_;
  unsigned refused_ = 0;
  unsigned listed_ = 0;  // requests for the list since the connection, or since the last pairing
  std::size_t noise_ = 0;
  std::uint64_t to_device_ = 0, from_device_ = 0;
  Instant handshake_until_;
  Instant received_at_{};  // last bytes of the client
  Instant worked_at_{};    // last program bytes received, or sent from a queue
  Instant half_from_client_ = kNever, half_from_device_ = kNever;
  Instant client_stuck_ = kNever, device_stuck_ = kNever;
  Instant heartbeat_at_ = kNever;  // next heartbeat of the bridge
  Instant timer_ = kNever;         // last value sent to the shell
};

}  // namespace fieldcast::program
