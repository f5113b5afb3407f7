#include "bridge/port/serial_line.hpp"

// termios2: <termios.h> supports only fixed baud rates, and both headers cannot be included.
#include <asm/termbits.h>
#include <fmt/format.h>
#include <linux/serial.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <cerrno>
#include <utility>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast {
namespace {

// Unix98 pseudo-terminal slaves (Documentation/admin-guide/devices.txt).
constexpr unsigned kFirstPtyMajor = 136, kLastPtyMajor = 143;

std::string last_fault(const char* what) { return fmt::format("{}: {}", what, errno_text(errno)); }

constexpr tcflag_t kFormat = CSIZE | CSTOPB | PARENB | PARODD;

// A byte with wrong parity arrives as 00, so the check of the frame fails.
tcflag_t parity_check(const LineFormat& line) { return line.parity == Parity::kNone ? 0u : INPCK; }

termios2 raw_settings(const LineFormat& line) {
  termios2 settings{};
  // Breaks on an idle RS-485 line are ignored.
  settings.c_iflag = IGNBRK | parity_check(line);
  settings.c_cflag = CREAD | CLOCAL | BOTHER | format_flags(line);
  settings.c_cc[VMIN] = 1;
  settings.c_ispeed = settings.c_ospeed = line.baud;
  return settings;
}

// Reads the settings back, because drivers round or silently ignore values.
tl::expected<void, std::string> verify_settings(int fd, const LineFormat& line) {
  termios2 actual{};
  if (::ioctl(fd, TCGETS2, &actual) != 0)
    return tl::make_unexpected(last_fault("cannot read the line's settings back"));
  if ((actual.c_cflag & kFormat) != format_flags(line)) {
    return tl::make_unexpected(
        std::string("the driver does not support this number of data bits, parity or stop bits"));
  }
  // With an error over 3 %, a receiver reads the last bits of a character of 11 bits wrong.
  const double error = static_cast<double>(actual.c_ospeed) / line.baud - 1.0;
  if (error > 0.03 || error < -0.03) {
    return tl::make_unexpected(
        fmt::format("the driver cannot do {} baud, the nearest is {}", line.baud, actual.c_ospeed));
  }
  return {};
}

void set_low_latency(int fd, bool pty, std::vector<LineRemark>& remarks) {
  serial_struct settings{};
  if (::ioctl(fd, TIOCGSERIAL, &settings) == 0) {
    if ((settings.flags & ASYNC_LOW_LATENCY) != 0) return;
    settings.flags |= ASYNC_LOW_LATENCY;
    if (::ioctl(fd, TIOCSSERIAL, &settings) == 0) return;
  }
  // An adapter without this flag works, but some deliver only every 16 ms. See
  // docs/commissioning.md for the remedy.
  remarks.push_back({pty || errno == ENOTTY || errno == EINVAL, last_fault("no low-latency mode")});
}

void set_rs485(int fd, bool pty, std::vector<LineRemark>& remarks) {
  serial_rs485 settings{};
  settings.flags = SER_RS485_ENABLED | SER_RS485_RTS_ON_SEND;
  if (::ioctl(fd, TIOCSRS485, &settings) == 0) return;
  remarks.push_back({pty, last_fault("the driver has no RS-485 mode (rs485: true); the adapter "
                                     "must switch direction by itself")});
}

}  // namespace

bool is_pseudo_terminal(int fd) {
  struct stat file {};
  return ::fstat(fd, &file) == 0 && S_ISCHR(file.st_mode) &&
         major(file.st_rdev) >= kFirstPtyMajor && major(file.st_rdev) <= kLastPtyMajor;
}

tl::expected<std::vector<LineRemark>, std::string> set_up_line(int fd, const SerialPortSpec& spec) {
  const bool pty = is_pseudo_terminal(fd);
  termios2 settings = raw_settings(spec.line);
  if (::ioctl(fd, TCSETS2, &settings) != 0) {
    return tl::make_unexpected(errno == ENOTTY ? std::string("not a serial device")
                                               : last_fault("cannot set up the line"));
  }
  if (!pty) {
    if (auto verified = verify_settings(fd, spec.line); !verified)
      return tl::make_unexpected(verified.error());
  }
  std::vector<LineRemark> remarks;
  if (spec.rs485) set_rs485(fd, pty, remarks);
  if (spec.low_latency) set_low_latency(fd, pty, remarks);
  // Unsent bytes of a session are dropped, because they must not be sent later.
  int unsent = 0;
  const bool stuck = ::ioctl(fd, TIOCOUTQ, &unsent) == 0 && unsent > 0;
  ::ioctl(fd, TCFLSH, stuck ? TCIOFLUSH : TCIFLUSH);
  return remarks;
}

unsigned format_flags(const LineFormat& line) {
  tcflag_t flags = line.data_bits == 7 ? CS7 : CS8;
  if (line.stop_bits == 2) flags |= CSTOPB;
  if (line.parity != Parity::kNone) flags |= PARENB;
  if (line.parity == Parity::kOdd) flags |= PARODD;
  return flags;
}

tl::expected<void, std::string> change_line(int fd, const LineFormat& line) {
  termios2 before{};
  if (::ioctl(fd, TCGETS2, &before) != 0)
    return tl::make_unexpected(last_fault("cannot read the line's settings"));
  termios2 settings = before;
  settings.c_iflag = (settings.c_iflag & ~static_cast<tcflag_t>(INPCK)) | parity_check(line);
  settings.c_cflag = (settings.c_cflag & ~(kFormat | CBAUD)) | BOTHER | format_flags(line);
  settings.c_ispeed = settings.c_ospeed = line.baud;
  if (::ioctl(fd, TCSETS2, &settings) != 0)
    return tl::make_unexpected(last_fault("cannot set up the line"));
  if (is_pseudo_terminal(fd)) return {};
  auto verified = verify_settings(fd, line);
  if (!verified) ::ioctl(fd, TCSETS2, &before);  // the driver has set something else
  return verified;
}

std::optional<program::LineSettings> rate_of(int fd) {
  termios2 settings{};
  if (::ioctl(fd, TCGETS2, &settings) != 0) return std::nullopt;
  program::LineSettings rate;
  rate.baud = settings.c_ospeed;
  rate.stop_bits = (settings.c_cflag & CSTOPB) != 0 ? 2 : 1;
  return rate;
}

namespace {

bool set_flow(int fd, tcflag_t input, tcflag_t control) {
  termios2 settings{};
  if (::ioctl(fd, TCGETS2, &settings) != 0) return false;
  settings.c_iflag = (settings.c_iflag & ~static_cast<tcflag_t>(IXON | IXOFF)) | input;
  settings.c_cflag = (settings.c_cflag & ~static_cast<tcflag_t>(CRTSCTS)) | control;
  settings.c_cc[VSTART] = 0x11;  // XON
  settings.c_cc[VSTOP] = 0x13;   // XOFF
  return ::ioctl(fd, TCSETS2, &settings) == 0;
}

bool set_modem_line(int fd, int line, bool on) {
  const bool done = ::ioctl(fd, on ? TIOCMBIS : TIOCMBIC, &line) == 0;
  return done || errno == ENOTTY || errno == EINVAL;
}

}  // namespace

bool set_control(int fd, telnet::Control control) {
  using telnet::Control;
  switch (control) {
    case Control::kNoFlow: return set_flow(fd, 0, 0);
    case Control::kSoftwareFlow: return set_flow(fd, IXON | IXOFF, 0);
    case Control::kHardwareFlow: return set_flow(fd, 0, CRTSCTS);
    case Control::kBreakOn: return ::ioctl(fd, TIOCSBRK) == 0;
    case Control::kBreakOff: return ::ioctl(fd, TIOCCBRK) == 0;
    case Control::kDtrOn:
    case Control::kDtrOff: return set_modem_line(fd, TIOCM_DTR, control == Control::kDtrOn);
    case Control::kRtsOn:
    case Control::kRtsOff: return set_modem_line(fd, TIOCM_RTS, control == Control::kRtsOn);
    default: return false;
  }
}

std::uint8_t modem_state(int fd) {
  int lines = TIOCM_CAR | TIOCM_DSR | TIOCM_CTS;
  int found = 0;
  if (::ioctl(fd, TIOCMGET, &found) == 0) lines = found;
  return static_cast<std::uint8_t>(
      ((lines & TIOCM_CAR) != 0 ? 0x80 : 0) | ((lines & TIOCM_RNG) != 0 ? 0x40 : 0) |
      ((lines & TIOCM_DSR) != 0 ? 0x20 : 0) | ((lines & TIOCM_CTS) != 0 ? 0x10 : 0));
}

std::uint8_t line_errors(int fd, LineErrors& last) {
  serial_icounter_struct counts{};
  if (::ioctl(fd, TIOCGICOUNT, &counts) != 0) return 0;
  const LineErrors before =
      std::exchange(last, {counts.brk, counts.frame, counts.parity, counts.overrun});
  constexpr std::uint8_t kOverrun = 0x02, kParity = 0x04, kFraming = 0x08, kBreak = 0x10;
  return static_cast<std::uint8_t>((counts.overrun != before.overruns ? kOverrun : 0) |
                                   (counts.parity != before.parity ? kParity : 0) |
                                   (counts.frame != before.framing ? kFraming : 0) |
                                   (counts.brk != before.breaks ? kBreak : 0));
}

void purge(int fd, std::uint32_t what) {
  if (what >= 1 && what <= 3)
    ::ioctl(fd, TCFLSH, what == 1 ? TCIFLUSH : what == 2 ? TCOFLUSH : TCIOFLUSH);
}

void drop_unsent(int fd) { ::ioctl(fd, TCFLSH, TCOFLUSH); }

}  // namespace fieldcast
