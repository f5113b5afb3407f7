// Settings of a terminal device that plain termios cannot express portably: any baud rate, RS-485
// direction control by the kernel, the driver's low-latency flag. Stateless functions on an open
// descriptor. Linux only.
#pragma once

#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/model/spec.hpp"
#include "core/program/frame.hpp"

namespace fieldcast {

// What the driver would not do, though the line works without it.
struct LineRemark {
  bool harmless = false;  // expected of this kind of device (a pseudo-terminal has no line)
  std::string text;
};

// Raw 8-bit-clean mode at the line's baud rate and format, nothing pending either way. The error is
// one line for people: not a terminal, or a driver that took other settings than those asked for.
[[nodiscard]] tl::expected<std::vector<LineRemark>, std::string> set_up_line(
    int fd, const SerialPortSpec& spec);

// A pseudo-terminal keeps no format and no baud rate: nothing about it is worth a warning.
[[nodiscard]] bool is_pseudo_terminal(int fd);

// Another baud rate and format, without losing what is on its way. An error for people when the
// driver refuses.
[[nodiscard]] tl::expected<void, std::string> change_line(int fd, const LineFormat& line);

// Those bits of termios' c_cflag that are the format: data bits, parity, stop bits.
[[nodiscard]] unsigned format_flags(const LineFormat& line);

// Baud rate and stop bits as they are now; from the master side of a pseudo-terminal those that the
// program at its slave has set. Of a pseudo-terminal data bits and parity cannot be told: Linux
// makes every one 8N (drivers/tty/pty.c, pty_set_termios).
[[nodiscard]] std::optional<program::LineSettings> rate_of(int fd);

// Throws away what is unsent: else close() may wait long for a line that takes nothing.
void drop_unsent(int fd);

}  // namespace fieldcast
