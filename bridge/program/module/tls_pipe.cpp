#include "bridge/program/module/tls_pipe.hpp"

#include <sys/socket.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <utility>

#include "bridge/port/stream.hpp"

namespace fieldcast::program {

namespace {

// Period of the check whether the peer of the TLS connection still exists.
constexpr std::chrono::seconds kWatchPeriod{1};
// Limit for sending the remaining bytes after one end has closed.
constexpr std::chrono::seconds kLastBytes{5};

}  // namespace

TlsPipe::TlsPipe(boost::asio::io_context& io, std::unique_ptr<ByteStream> tls, int socket)
    : io_(io), socket_(socket), tls_(std::make_shared<RelayEnd>(std::move(tls))), timer_(io) {
  // The timeout of a programming session; watch() notices a lost peer earlier.
  tune_socket(socket_, kTunnelPatience);
}

FileDescriptor TlsPipe::start(std::function<void()> over) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends.data()) != 0) {
    close();
    return {};
  }
  FileDescriptor outside(ends[0]);
  auto plain = descriptor_stream(io_, FileDescriptor(ends[1]));
  if (!plain) {
    close();
    return {};
  }
  over_ = std::move(over);
  relay(std::move(plain));
  watch();
  return outside;
}

void TlsPipe::relay(std::unique_ptr<ByteStream> plain) {
  plain_ = std::make_shared<RelayEnd>(std::move(plain));
  const auto join = [self = shared_from_this()](const std::shared_ptr<RelayEnd>& from,
                                                const std::shared_ptr<RelayEnd>& to) {
    from->start({[to](ByteView bytes) { to->send(bytes); },
                 [self, to](const std::string&) { self->gone(*to); },
                 [to](bool room) { to->pause(!room); }});
  };
  join(tls_, plain_);
  join(plain_, tls_);
}

void TlsPipe::watch() {
  timer_.expires_after(kWatchPeriod);
  timer_.async_wait([weak = weak_from_this()](boost::system::error_code cancelled) {
    const auto self = weak.lock();
    if (cancelled || !self || self->ending_) return;
    if (!peer_responds(self->socket_)) return self->finish();
    self->watch();
  });
}

// Called when one end has closed: the other end gets the remaining bytes, and closes.
void TlsPipe::gone(RelayEnd& other) {
  if (std::exchange(ending_, true)) return finish();
  timer_.expires_after(kLastBytes);
  timer_.async_wait([self = shared_from_this()](boost::system::error_code cancelled) {
    if (!cancelled) self->finish();
  });
  other.finish(RelayEnd::Until::kTaken, [self = shared_from_this()] { self->finish(); });
}

void TlsPipe::finish() {
  const auto self = shared_from_this();
  const auto over = std::exchange(over_, {});
  close();
  if (over) over();
}

void TlsPipe::close() {
  ending_ = true;
  over_ = {};
  timer_.cancel();
  for (const auto& end : {tls_, plain_}) {
    if (end) end->close();
  }
}

}  // namespace fieldcast::program
