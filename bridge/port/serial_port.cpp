#include "bridge/port/serial_port.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/log/log.hpp"
#include "bridge/net/byte_stream.hpp"
#include "bridge/port/serial_line.hpp"

namespace fieldcast {

namespace {

namespace asio = boost::asio;

// A shorter sleep saves no wake-up: most UARTs deliver pieces of 8 or 14 characters.
constexpr double kWorthSleeping = 8;  // characters

Stream::End open_fault(const std::string& path) {
  const int fault = errno;
  switch (fault) {
    case EBUSY: {
      const std::string user = port_user(path);
      return {user.empty() ? "in use by another program" : "in use by " + user, Cause::kPortInUse};
    }
    case EACCES:
    case EPERM:
      return {
          "permission denied (is the user in the group that owns the device, often 'dialout', "
          "and may that group read and write it? ls -lL says so)",
          Cause::kPortDenied};
    case ENOENT:
    case ENODEV:
    case ENXIO: return {errno_text(fault), Cause::kPortMissing};
    default: return {errno_text(fault)};
  }
}

class SerialStream final : public Stream {
 public:
  SerialStream(asio::io_context& io, const SerialPortSpec& spec, PortListener& listener)
      : Stream(io, listener, Unsent::Kind::kTerminal), spec_(spec), change_(io) {}
  ~SerialStream() override { close(); }

  // A device takes some time before it responds at the other rate.
  void receive_at(std::uint32_t baud, std::size_t characters) {
    other_baud_ = baud;
    change_after(characters);
  }
  [[nodiscard]] LineFormat response_line() const {
    LineFormat line = spec_.line;
    if (other_baud_ != 0) line.baud = other_baud_;
    return line;
  }

 private:
  void change_after(std::size_t characters) {
    change_.expires_after(spec_.line.characters(static_cast<double>(characters)));
    change_.async_wait([self = std::static_pointer_cast<SerialStream>(shared_from_this()),
                        turn = turn_](boost::system::error_code fault) {
      if (!fault && turn == self->turn_ && self->usable()) self->change();
    });
  }
  void change() {
    if (const std::size_t unsent = queued_at(fd()); unsent > 0) return change_after(unsent);
    if (const auto changed = change_line(fd(), response_line()); !changed)
      fail_later({changed.error()});
  }
  void before_write(int fd) override {
    ++turn_;  // a change that is due does nothing
    if (std::exchange(other_baud_, 0) == 0) return;
    if (const auto changed = change_line(fd, spec_.line); !changed) fail_later({changed.error()});
  }

  std::optional<End> restore(int fd) override {
    using telnet::Control;
    (void)set_control(fd, Control::kBreakOff);
    // With `rs485` the kernel switches RTS.
    if (!spec_.rs485) (void)(set_control(fd, Control::kDtrOn) && set_control(fd, Control::kRtsOn));
    if (const auto remarks = set_up_line(fd, spec_); !remarks) return End{remarks.error()};
    return std::nullopt;
  }
  End end_of(int error) const override {
    const bool gone = error == 0 || error == EIO || error == ENXIO || error == ENODEV;
    if (gone) return {"the device was unplugged", Cause::kPortMissing};
    return {errno_text(error)};
  }
  void before_close(int fd) override { drop_unsent(fd); }
  bool can_wait() const override { return other_baud_ == 0; }

  SerialPortSpec spec_;
  asio::steady_timer change_;
  std::uint32_t other_baud_ = 0;  // of the response to the last request; 0: that of the line
  unsigned turn_ = 0;             // counts requests
};

class SerialOpening final : public PortOpening {
 public:
  SerialOpening(asio::io_context& io, const SerialPortSpec& spec, PortListener& listener)
      : PortOpening(io, listener), spec_(spec) {}

  void begin() override {
    asio::post(io_, [self = self_as<SerialOpening>(), fault = try_open()] {
      if (self->over_) return;
      if (fault) return self->fail(fault->reason, fault->cause);
      self->opened(self->line_);
    });
  }

 private:
  void cancel() override {
    if (line_) line_->close();
  }

  std::optional<Stream::End> try_open() {
    // O_NONBLOCK: no wait for a carrier or for bytes. O_NOCTTY: not the controlling terminal.
    FileDescriptor fd(::open(spec_.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (!fd.valid()) return open_fault(spec_.path);
    if (spec_.exclusive) {
      if (auto user = lock_port(fd.get(), spec_.path)) return Stream::End{*user, Cause::kPortInUse};
    }
    auto remarks = set_up_line(fd.get(), spec_);
    if (!remarks) return Stream::End{remarks.error()};
    for (const LineRemark& remark : *remarks) {
      log_counted(remark.harmless ? LogLevel::kDebug : LogLevel::kWarning, spec_.path,
                  "remarks about " + spec_.path, remark.text);
    }
    line_ = std::make_shared<SerialStream>(io_, spec_, listener_);
    if (!line_->assign(std::move(fd))) return Stream::End{"it cannot be waited for"};
    return std::nullopt;
  }

  SerialPortSpec spec_;
  std::shared_ptr<SerialStream> line_;
};

}  // namespace

void SerialPort::receive_at(std::uint32_t baud, std::size_t characters) {
  if (stream() != nullptr) static_cast<SerialStream*>(stream())->receive_at(baud, characters);
}

void SerialPort::sleep_until(Instant until) {
  const Instant now = steady_now();
  if (until <= now || stream() == nullptr) return;
  const LineFormat line = static_cast<SerialStream*>(stream())->response_line();
  if (until - now >= line.characters(kWorthSleeping)) stream()->sleep_for(until - now);
}

std::shared_ptr<PortOpening> SerialPort::make_opening(PortListener& listener) {
  return std::make_shared<SerialOpening>(io_, spec_, listener);
}

namespace {

namespace fs = std::filesystem;

// The kernel stores the first 15 bytes of a program's name (proc(5), /proc/pid/comm). The command
// line has the complete name, unless the program has changed it.
std::string name_of_process(long pid) {
  constexpr std::size_t kKept = 15;
  std::string name, command;
  std::getline(std::ifstream(fmt::format("/proc/{}/comm", pid)), name);
  if (name.size() < kKept) return name;
  std::getline(std::ifstream(fmt::format("/proc/{}/cmdline", pid)), command, '\0');
  const std::string whole = fs::path(command).filename();
  return whole.compare(0, kKept, name) == 0 ? whole : name;
}

std::string describe_process(long pid) {
  const std::string name = name_of_process(pid);
  return name.empty() ? fmt::format("process {}", pid) : fmt::format("{} (process {})", name, pid);
}

// Returns the process that holds a flock on this file: "1: FLOCK  ADVISORY  WRITE 1234 08:01:5678 0
// EOF" (proc(5), /proc/locks).
std::optional<long> lock_holder(const struct stat& file) {
  const std::string wanted =
      fmt::format("{:02x}:{:02x}:{}", major(file.st_dev), minor(file.st_dev), file.st_ino);
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    std::istringstream fields(line);
    std::string number, kind, advisory, access, identity;
    long pid = 0;
    if (fields >> number >> kind >> advisory >> access >> pid >> identity && kind == "FLOCK" &&
        identity == wanted && pid > 0)
      return pid;
  }
  return std::nullopt;
}

std::optional<long> opener(const fs::path& file) {
  std::error_code ignored;
  for (const auto& process : fs::directory_iterator("/proc", ignored)) {
    const std::string name = process.path().filename();
    long pid = 0;
    const auto [end, fault] = std::from_chars(name.data(), name.data() + name.size(), pid);
    if (fault != std::errc{} || end != name.data() + name.size() || pid == ::getpid()) continue;
    for (fs::directory_iterator fd(process.path() / "fd", ignored), last; !ignored && fd != last;
         fd.increment(ignored)) {
      if (fs::read_symlink(fd->path(), ignored) == file) return pid;
    }
    ignored.clear();
  }
  return std::nullopt;
}

}  // namespace

std::string port_user(const std::string& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return {};
  if (const auto pid = lock_holder(file)) return describe_process(*pid);
  std::error_code fault;
  const fs::path real = fs::canonical(path, fault);
  if (fault) return {};
  const auto pid = opener(real);
  return pid ? describe_process(*pid) : std::string{};
}

std::optional<std::string> lock_port(int fd, const std::string& path) {
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return fmt::format("cannot lock: {}", errno_text(errno));
    const std::string user = port_user(path);
    return user.empty() ? "in use by another program" : "in use by " + user;
  }
  // Also excludes programs that do not use flock. Works on pseudo-terminals too; root ignores it.
  ::ioctl(fd, TIOCEXCL);
  return std::nullopt;
}

}  // namespace fieldcast
