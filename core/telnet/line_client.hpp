// Opens a line at a server of RFC 2217: negotiates, sets the line, checks the values in force. An
// engineer to whom the line is leased may change them. Pure.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/time.hpp"
#include "core/telnet/com_port.hpp"
#include "core/telnet/options.hpp"

namespace fieldcast::telnet {

class LineClient {
 public:
  // From the connection until the server has confirmed all settings, and of a change.
  static constexpr Duration kLimit = std::chrono::seconds{3};
  static constexpr std::size_t kMaxAwaited = 64;  // changes; further ones are refused

  // `to_server` gets the first requests.
  LineClient(const LineFormat& line, Instant now, Bytes& to_server);

  // Appends the line's bytes to `data`. Bytes before open() are dropped, as stale. No effect after
  // a fault.
  void on_bytes(ByteView received, Bytes& data, Bytes& to_server);
  void on_time(Instant now);
  // kNever if nothing is awaited.
  [[nodiscard]] Instant deadline() const;

  // Requests a change of the open line; a Changed follows. From then on the line no longer has to
  // have the settings of the constructor.
  void change(const LineChange& change, Instant now, Bytes& to_server);
  struct Changed {
    LineChange change;
    std::optional<std::uint32_t> in_force{};  // see LineChangeDone
    friend bool operator==(const Changed&, const Changed&) = default;
  };
  // Those that have ended since the last call, in the order of the requests for each kind.
  [[nodiscard]] std::vector<Changed> take_changed() { return std::exchange(changed_, {}); }
  [[nodiscard]] bool changes_line() const { return changes_; }

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
  void on_changed(const Message& message);
  void fail(std::string fault);

  LineFormat line_;
  Instant deadline_;
  State state_ = State::kNegotiating;
  bool suspended_ = false;
  bool changes_ = false;
  std::vector<LineChange> awaited_;
  std::vector<Changed> changed_;
  std::string fault_;
  Parser parser_;
  Options options_{End::kThere};
  std::array<bool, 4> confirmed_{};  // kBaud to kStopBits
};

}  // namespace fieldcast::telnet
