// Settings of a terminal device that termios lacks: any baud rate, RS-485 direction control, the
// low-latency flag. Stateless functions on an open descriptor. Linux only.
#pragma once

#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/model/bus_spec.hpp"
#include "core/program/frame.hpp"
#include "core/telnet/com_port.hpp"

namespace fieldcast {

// A setting that the driver refused, though the line works without it.
struct LineRemark {
  bool harmless = false;  // expected of this kind of device (a pseudo-terminal has no line)
  std::string text;
};

// Sets raw mode with the line's baud rate and format, and drops pending bytes. The error is one
// human-readable line: not a terminal, or the driver uses other settings.
[[nodiscard]] tl::expected<std::vector<LineRemark>, std::string> set_up_line(
    int fd, const SerialPortSpec& spec);

// A pseudo-terminal ignores format and baud rate, so its remarks need no warning.
[[nodiscard]] bool is_pseudo_terminal(int fd);

// Keeps bytes in flight. Fails with a human-readable text if the driver refuses or uses other
// settings; the line then keeps those from before.
[[nodiscard]] tl::expected<void, std::string> change_line(int fd, const LineFormat& line);

// Returns the bits of termios' c_cflag for data bits, parity and stop bits.
[[nodiscard]] unsigned format_flags(const LineFormat& line);

// Returns the present baud rate and stop bits; at the master of a pseudo-terminal, those set at its
// slave. Linux sets data bits and parity there to 8N (drivers/tty/pty.c, pty_set_termios).
[[nodiscard]] std::optional<program::LineSettings> rate_of(int fd);

// Flow control, break, DTR or RTS. Returns false if the driver refuses. A pseudo-terminal has no
// modem lines and accepts any value for them.
[[nodiscard]] bool set_control(int fd, telnet::Control control);

// State of the modem lines as in NOTIFY-MODEMSTATE of RFC 2217. Without modem lines: DCD, DSR, CTS.
[[nodiscard]] std::uint8_t modem_state(int fd);

// The driver's counts since it was loaded.
struct LineErrors {
  int breaks = 0, framing = 0, parity = 0, overruns = 0;
};
// Bits of NOTIFY-LINESTATE of RFC 2217 for the counts that differ from `last`, which it updates.
// Zero without a UART.
[[nodiscard]] std::uint8_t line_errors(int fd, LineErrors& last);

// PURGE-DATA of RFC 2217: 1 received, 2 unsent, 3 both.
void purge(int fd, std::uint32_t what);

// Drops unsent bytes; otherwise close() may wait long for a blocked line.
void drop_unsent(int fd);

}  // namespace fieldcast
