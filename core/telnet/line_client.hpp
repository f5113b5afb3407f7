// Opens a line at a server of RFC 2217: negotiates, sets the line, checks the values in force.
// Pure.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/base/time.hpp"
#include "core/telnet/com_port.hpp"
#include "core/telnet/options.hpp"

namespace fieldcast::telnet {

class LineClient {
 public:
  // From the connection until the server has confirmed all settings.
  static constexpr Duration kLimit = std::chrono::seconds{3};

  // `to_server` gets the first requests.
  LineClient(const LineFormat& line, Instant now, Bytes& to_server);

  // Appends the line's bytes to `data`. Bytes before open() are dropped, as stale. No effect after
  // a fault.
  void on_bytes(ByteView received, Bytes& data, Bytes& to_server);
  void on_time(Instant now);
  // kNever after open() or a fault.
  [[nodiscard]] Instant deadline() const;

  [[nodiscard]] bool open() const { return state_ == State::kOpen; }
  // One line; empty while there is no fault.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  // The server has no space for data (FLOWCONTROL-SUSPEND).
  [[nodiscard]] bool suspended() const { return suspended_; }

 private:
  enum class State : std::uint8_t { kNegotiating, kSetting, kOpen, kFailed };
  void on_options(Bytes& to_server);
  [[nodiscard]] bool com_port() const;
  void on_message(const Message& message, Bytes& to_server);
  void on_setting(const Message& message);
  void set_line(Bytes& to_server);
  void fail(std::string fault);

  LineFormat line_;
  Instant deadline_;
  State state_ = State::kNegotiating;
  bool suspended_ = false;
  std::string fault_;
  Parser parser_;
  Options options_{End::kThere};
  std::array<bool, 4> confirmed_{};  // kBaud to kStopBits
};

}  // namespace fieldcast::telnet
