#include "bridge/port/serial_port.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cerrno>
#include <cstring>

#include "bridge/bus/clock.hpp"
#include "bridge/log/log.hpp"
#include "bridge/port/file_descriptor.hpp"
#include "bridge/port/port_lock.hpp"
#include "bridge/port/serial_line.hpp"
#include "bridge/port/unsent.hpp"

namespace fieldcast {
namespace {

namespace asio = boost::asio;

// Sleeping through an answer ends this long before its last byte could come, so that a late timer
// never delays the answer: its last bytes are waited for one by one.
constexpr Duration kEarlyWake = std::chrono::microseconds{200};
constexpr Duration kWorthSleeping = std::chrono::microseconds{500};

struct Fault {
  std::string text;
  Cause cause = Cause::kPortClosed;
};

Fault open_fault(const std::string& path) {
  const int fault = errno;
  switch (fault) {
    case EBUSY: {
      const std::string user = port_user(path);
      return {user.empty() ? "in use by another program" : "in use by " + user, Cause::kPortInUse};
    }
    case EACCES:
    case EPERM:
      return {"permission denied (is the user in the group that owns the device, often 'dialout'?)",
              Cause::kPortDenied};
    case ENOENT:
    case ENODEV:
    case ENXIO: return {std::strerror(fault), Cause::kPortMissing};
    default: return {std::strerror(fault)};
  }
}

}  // namespace

// One opening of the device, from open() to its end. Handlers hold it; once over_ is set they do
// nothing.
class SerialPort::Session : public std::enable_shared_from_this<Session> {
 public:
  Session(asio::io_context& io, const SerialPortSpec& spec, PortListener& listener)
      : spec_(spec), listener_(listener), stream_(io), nap_(io) {}

  void open() {
    asio::post(stream_.get_executor(), [self = shared_from_this(), fault = try_open()] {
      if (self->over_) return;
      if (fault) return self->fail(fault->text, fault->cause);
      self->listener_.on_opened();
      if (!self->over_) self->listen();
    });
  }

  void write(ByteView bytes) {
    if (over_ || lent_ || !stream_.is_open()) return;
    drop_stale();
    push(bytes);
  }

  void expect(std::uint32_t characters) {
    if (characters < 2) return;
    const Duration early = std::max(kEarlyWake, spec_.line.characters(1));
    const Duration sleep = spec_.line.characters(characters - 1) - early;
    if (sleep >= kWorthSleeping) sleep_ = sleep;
  }

  void poll() {
    if (!over_ && !lent_ && stream_.is_open()) take();
  }

  FileDescriptor lend() {
    if (over_ || !stream_.is_open()) return {};
    lent_ = true;
    return FileDescriptor(::fcntl(stream_.native_handle(), F_DUPFD_CLOEXEC, 0));
  }

  void take_back() {
    if (over_ || !std::exchange(lent_, false)) return;
    if (const auto remarks = set_up_line(stream_.native_handle(), spec_); !remarks)
      return fail_later(remarks.error());
    listen();
  }

  void close() {
    if (std::exchange(over_, true)) return;
    nap_.cancel();
    boost::system::error_code ignored;
    if (stream_.is_open()) drop_unsent(stream_.native_handle());
    stream_.close(ignored);
  }

 private:
  void push(ByteView bytes) {
    switch (unsent_.write(stream_.native_handle(), bytes)) {
      case Unsent::Outcome::kAllSent: return;
      case Unsent::Outcome::kBlocked: return wait_for_room();
      case Unsent::Outcome::kFailed: return fail_later(std::strerror(errno));
      case Unsent::Outcome::kFull: return fail_later("the line takes no bytes");
    }
  }

  // Nothing on success; else why not, in one line.
  std::optional<Fault> try_open() {
    // O_NONBLOCK: neither the open waits for a carrier nor a read for bytes. O_NOCTTY: a terminal
    // must not become ours.
    FileDescriptor fd(::open(spec_.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (!fd.valid()) return open_fault(spec_.path);
    if (spec_.exclusive) {
      if (auto held = lock_port(fd.get(), spec_.path)) return Fault{*held, Cause::kPortInUse};
    }
    auto remarks = set_up_line(fd.get(), spec_);
    if (!remarks) return Fault{remarks.error()};
    for (const LineRemark& remark : *remarks) {
      log_counted(remark.harmless ? LogLevel::kDebug : LogLevel::kWarning, spec_.path,
                  "remarks about " + spec_.path, remark.text);
    }
    boost::system::error_code fault;
    stream_.assign(fd.get(), fault);
    if (fault) return Fault{fault.message()};
    (void)fd.release();
    return std::nullopt;
  }

  // Waits for bytes and then takes them, in two steps: nothing is taken that is not delivered at
  // once, so that poll() may come between.
  void listen() {
    if (lent_ || std::exchange(listening_, true)) return;
    stream_.async_wait(asio::posix::stream_descriptor::wait_read,
                       [self = shared_from_this()](boost::system::error_code fault) {
                         self->listening_ = false;
                         if (self->over_ || self->lent_) return;
                         if (fault) return self->fail(fault.message());
                         self->sleep_ = {};
                         if (!self->take() || self->over_) return;
                         self->sleep_ == Duration::zero() ? self->listen() : self->nap();
                       });
  }

  // False: the device is gone, and that was told.
  bool take() {
    const ssize_t size = ::read(stream_.native_handle(), buffer_.data(), buffer_.size());
    if (size > 0) {
      listener_.on_received({buffer_.data(), static_cast<std::size_t>(size)}, steady_now());
    } else if (size == 0 || (errno != EAGAIN && errno != EINTR)) {
      const bool gone = size == 0 || errno == EIO || errno == ENXIO || errno == ENODEV;
      fail(gone ? "the device is gone" : std::strerror(errno),
           gone ? Cause::kPortMissing : Cause::kPortClosed);
      return false;
    }
    return true;
  }

  // The rest of the answer gathers in the kernel meanwhile: one wake-up instead of one for each
  // byte.
  void nap() {
    nap_.expires_after(sleep_);
    nap_.async_wait([self = shared_from_this()](boost::system::error_code fault) {
      if (!self->over_ && !fault) self->listen();
    });
  }

  void drop_stale() {
    std::array<std::uint8_t, 512> stale;
    while (::read(stream_.native_handle(), stale.data(), stale.size()) ==
           static_cast<ssize_t>(stale.size())) {}
  }

  void wait_for_room() {
    stream_.async_wait(asio::posix::stream_descriptor::wait_write,
                       [self = shared_from_this()](boost::system::error_code fault) {
                         if (!self->over_ && !fault) self->push({});
                       });
  }

  void fail_later(std::string reason) {
    asio::post(stream_.get_executor(),
               [self = shared_from_this(), reason = std::move(reason)]() mutable {
                 if (!self->over_) self->fail(std::move(reason));
               });
  }

  void fail(std::string reason, Cause cause = Cause::kPortClosed) {
    close();
    listener_.on_closed(std::move(reason), cause);
  }

  SerialPortSpec spec_;
  PortListener& listener_;
  asio::posix::stream_descriptor stream_;
  asio::steady_timer nap_;
  Duration sleep_{};
  Unsent unsent_{Unsent::Kind::kTerminal};
  bool over_ = false;
  bool lent_ = false;
  bool listening_ = false;  // a wait is under way
  std::array<std::uint8_t, 4096> buffer_;
};

SerialPort::SerialPort(asio::io_context& io, SerialPortSpec spec)
    : io_(io), spec_(std::move(spec)) {}
SerialPort::~SerialPort() { close(); }

void SerialPort::open(PortListener& listener) {
  close();
  session_ = std::make_shared<Session>(io_, spec_, listener);
  session_->open();
}

void SerialPort::write(ByteView bytes) {
  if (session_) session_->write(bytes);
}

void SerialPort::expect(std::uint32_t characters) {
  if (session_) session_->expect(characters);
}

void SerialPort::poll() {
  if (session_) session_->poll();
}

FileDescriptor SerialPort::lend() { return session_ ? session_->lend() : FileDescriptor{}; }

void SerialPort::take_back() {
  if (session_) session_->take_back();
}

void SerialPort::close() {
  if (session_) session_->close();
  session_.reset();
}

}  // namespace fieldcast
