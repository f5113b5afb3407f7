// Serves a line to a client of RFC 2217: negotiates, forwards data and changes of the line, sends
// the values in force and the states of modem and line. The shell owns the line. Pure.
#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "core/telnet/com_port.hpp"
#include "core/telnet/options.hpp"

namespace fieldcast::telnet {

struct LineData {
  Bytes bytes;
};
// In the order of the client. A change is to be executed; then on_changed().
using LineAction = std::variant<LineData, LineChange>;
using LineActions = std::vector<LineAction>;

class LineServer {
 public:
  // `to_client` gets the first requests.
  explicit LineServer(Bytes& to_client);

  // Settings in force.
  void on_line(const LineFormat& line) { line_ = line; }
  // Appends data and changes to `actions`, and the responses to requests to `to_client`.
  void on_bytes(ByteView received, LineActions& actions, Bytes& to_client);
  // Response to a LineChange. `done`: the value is in force.
  void on_changed(const LineChange& change, bool done, Bytes& to_client);
  // States as in RFC 2217. That of the modem is sent if bits of the client's mask have changed,
  // that of the line if bits of its mask are set.
  void on_modem_state(std::uint8_t state, Bytes& to_client);
  void on_line_state(std::uint8_t state, Bytes& to_client);

  [[nodiscard]] const LineFormat& line() const { return line_; }
  // The client speaks RFC 2217.
  [[nodiscard]] bool com_port() const;
  // The client accepts no data (FLOWCONTROL-SUSPEND).
  [[nodiscard]] bool suspended() const { return suspended_; }
  [[nodiscard]] Options& options() { return options_; }

 private:
  void on_message(const Message& message, LineActions& actions, Bytes& to_client);
  void on_control(std::uint32_t value, LineActions& actions, Bytes& to_client);
  void respond(Kind kind, std::uint32_t value, Bytes& to_client) const;
  [[nodiscard]] std::uint32_t control_in_force(std::uint32_t value) const;

  LineFormat line_;
  Parser parser_;
  Options options_{End::kHere};
  bool one_byte_ = false;  // the client sends baud rates in one byte
  bool suspended_ = false;
  // Last values of flow, break, DTR and RTS.
  Control controls_[4] = {Control::kNoFlow, Control::kBreakOff, Control::kDtrOn, Control::kRtsOn};
  std::uint8_t line_mask_ = 0, modem_mask_ = 0xFF;  // the initial values of RFC 2217
  std::uint8_t modem_state_ = 0;
};

}  // namespace fieldcast::telnet
