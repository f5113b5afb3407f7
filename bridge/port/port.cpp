#include "bridge/port/port.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>

#include "bridge/base/check.hpp"
#include "bridge/port/rfc2217_port.hpp"
#include "bridge/port/serial_port.hpp"
#include "bridge/port/stream_port.hpp"

namespace fieldcast {

Unsent::Outcome Unsent::write(int fd, ByteView bytes) {
  if (rest_.size() + bytes.size() > Port::kMaxUnsent) return Outcome::kFull;
  const bool waiting = !rest_.empty();
  if (waiting) append(rest_, bytes);
  ByteView todo = waiting ? ByteView(rest_) : bytes;
  while (!todo.empty()) {
    const ssize_t sent = write_some(fd, todo);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && errno != EAGAIN && errno != EWOULDBLOCK) return Outcome::kFailed;
    if (sent <= 0) break;
    todo = todo.subspan(static_cast<std::size_t>(sent));
  }
  rest_ = Bytes(todo.begin(), todo.end());
  return rest_.empty() ? Outcome::kAllSent : Outcome::kBlocked;
}

ssize_t Unsent::write_some(int fd, ByteView bytes) const {
  // After the peer has closed, the call then fails with EPIPE and raises no signal.
  if (kind_ == Kind::kSocket) return ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  return ::write(fd, bytes.data(), bytes.size());
}

namespace {

struct Maker {
  boost::asio::io_context& io;
  DialInRegistry* modules;

  std::unique_ptr<Port> operator()(const SerialPortSpec& spec) const {
    return std::make_unique<SerialPort>(io, spec);
  }
  std::unique_ptr<Port> operator()(const TcpPortSpec& spec) const {
    return std::make_unique<TcpPort>(io, spec);
  }
  std::unique_ptr<Port> operator()(const Rfc2217PortSpec& spec) const {
    return std::make_unique<Rfc2217Port>(io, spec);
  }
  std::unique_ptr<Port> operator()(const DialInPortSpec& spec) const {
    FIELDCAST_CHECK(modules != nullptr);
    return std::make_unique<DialInPort>(io, spec, *modules);
  }
};

}  // namespace

std::unique_ptr<Port> make_port(boost::asio::io_context& io, const PortSpec& spec,
                                DialInRegistry* modules) {
  return std::visit(Maker{io, modules}, spec);
}

}  // namespace fieldcast
