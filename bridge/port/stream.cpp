#include "bridge/port/stream.hpp"

#include <fcntl.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <unistd.h>

#include <boost/asio/post.hpp>
#include <cerrno>

#include "bridge/base/clock.hpp"
#include "bridge/base/file_descriptor.hpp"

namespace fieldcast {

namespace asio = boost::asio;

// poll() need not read after a wait that ended without bytes less than this time ago.
constexpr Duration kFresh = std::chrono::microseconds{100};

Stream::Stream(asio::io_context& io, PortListener& listener, Unsent::Kind kind)
    : listener_(listener), readiness_(io), timer_(io), unsent_(kind) {}

bool Stream::assign(FileDescriptor descriptor) {
  if (!readiness_.assign(descriptor.get())) return false;
  descriptor_ = std::move(descriptor);
  return true;
}

void Stream::start() {
  if (!over_) wait_for_bytes();
}

void Stream::write(ByteView bytes) {
  if (!usable()) return;
  before_write(fd());
  drop_stale();
  sleep_until_ = {};
  push(bytes);
}

void Stream::write_more(ByteView bytes) {
  if (usable()) push(bytes);
}

void Stream::poll() {
  if (!usable() || steady_now() - kFresh < empty_at_) return;
  fetch();
  (void)take();
}

bool Stream::wait(Instant until, int wake) {
  if (!usable() || tls_ || !unsent_.empty() || !can_wait()) return false;
  attended_ = true;
  const auto keep = shared_from_this();  // the listener may close the port
  const Instant now = steady_now();
  const bool sleeps = sleep_until_ > now;  // the response accumulates in the kernel
  const Duration left =
      std::max((sleeps ? std::min(until, sleep_until_) : until) - now, Duration{});
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(left);
  const timespec timeout{seconds.count(), (left - seconds).count()};
  std::array<pollfd, 2> watched{{{wake, POLLIN, 0}, {fd(), POLLIN, 0}}};
  ::ppoll(watched.data(), sleeps ? 1 : 2, &timeout, nullptr);
  const bool woken = watched[0].revents != 0;
  if (watched[1].revents != 0 || (sleeps && !woken && sleep_until_ <= until)) (void)take();
  if (!sleeps && watched[1].revents == 0) empty_at_ = steady_now();
  return true;
}

void Stream::watch() {
  if (std::exchange(attended_, false)) wait_for_bytes();
}

void Stream::close() {
  if (std::exchange(over_, true)) return;
  timer_.cancel();
  if (descriptor_.valid()) before_close(fd());
  readiness_.close();
  descriptor_.reset();
  companion_.reset();
}

FileDescriptor Stream::release() {
  if (leased_ || std::exchange(over_, true)) return {};
  timer_.cancel();
  readiness_.close();
  return std::move(descriptor_);
}

FileDescriptor Stream::lease() {
  if (over_ || !descriptor_.valid() || tls_) return {};
  before_write(fd());
  leased_ = true;
  return FileDescriptor(::fcntl(fd(), F_DUPFD_CLOEXEC, 0));
}

void Stream::end_lease() {
  if (over_ || !std::exchange(leased_, false)) return;
  if (auto end = restore(fd())) return fail_later(std::move(*end));
  drop_stale();
  wait_for_bytes();
}

void Stream::push(ByteView bytes) {
  if (!tls_) return push_raw(bytes);
  Bytes encrypted;
  tls_->send(bytes, encrypted);
  push_raw(encrypted);
}

// Also sends what TLS itself has to send. Returns false at a fault or at the end of TLS.
bool Stream::decrypt(ByteView bytes, Bytes& plain) {
  Bytes out;
  const bool open = tls_->receive(bytes, plain, out);
  if (!out.empty()) push_raw(out);
  return open;
}

void Stream::push_raw(ByteView bytes) {
  switch (unsent_.write(fd(), bytes)) {
    case Unsent::Outcome::kAllSent: return;
    case Unsent::Outcome::kBlocked: return wait_for_space();
    case Unsent::Outcome::kFailed: return fail_later(end_of(errno));
    case Unsent::Outcome::kFull: return fail_later({"the line takes no bytes"});
  }
}

// Waits for readiness and reads in two steps. Bytes that were read are delivered immediately, so
// poll() may be called in between.
void Stream::wait_for_bytes() {
  if (over_ || leased_ || attended_ || std::exchange(waiting_, true)) return;
  readiness_.wait_readable([self = shared_from_this()](boost::system::error_code fault) {
    self->waiting_ = false;
    if (self->over_ || self->leased_ || self->attended_) return;
    if (fault) return self->fail({fault.message()});
    self->on_readable();
  });
}

void Stream::on_readable() {
  sleep_ = {};
  if (!take() || over_) return;
  sleep_ == Duration::zero() ? wait_for_bytes() : sleep();
}

// Returns false if the line was lost; the listener has been notified.
bool Stream::take() {
  const ssize_t size = ::read(fd(), buffer_.data(), buffer_.size());
  if (size > 0) {
    ByteView received(buffer_.data(), static_cast<std::size_t>(size));
    Bytes plain;
    const bool open = !tls_ || decrypt(received, plain);
    if (tls_) received = plain;
    decrypted_ = decrypted_ || !plain.empty();
    if (!received.empty()) listener_.on_received(received, steady_now());
    if (!over_ && !open) fail({tls_->fault()});
    if (over_) return open;
    acknowledge(fd());
    return true;
  }
  if (size == 0 && datagrams()) return true;
  if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return true;
  End end = end_of(size == 0 ? 0 : errno);
  // Not every server says why it refuses a client.
  if (tls_ && !decrypted_)
    end.reason += " after the TLS handshake; it may refuse the certificate of this client";
  fail(std::move(end));
  return false;
}

// The rest of the response accumulates in the kernel: one wake-up instead of one per byte.
void Stream::sleep() {
  timer_.expires_after(sleep_);
  timer_.async_wait([self = shared_from_this()](boost::system::error_code fault) {
    if (!self->over_ && !fault) self->wait_for_bytes();
  });
}

void Stream::drop_stale() {
  fetch();
  std::array<std::uint8_t, 512> stale;
  const ssize_t more = datagrams() ? 0 : static_cast<ssize_t>(stale.size());
  for (ssize_t size = more; size >= more;) {
    size = ::read(fd(), stale.data(), stale.size());
    Bytes ignored;
    if (tls_ && size > 0 &&
        !decrypt(ByteView(stale).first(static_cast<std::size_t>(size)), ignored))
      return fail_later({tls_->fault()});
  }
}

void Stream::wait_for_space() {
  readiness_.wait_writable([self = shared_from_this()](boost::system::error_code fault) {
    if (!self->over_ && !fault) self->push_raw({});
  });
}

void Stream::fail_later(End end) {
  asio::post(readiness_.get_executor(),
             [self = shared_from_this(), end = std::move(end)]() mutable {
               if (!self->over_) self->fail(std::move(end));
             });
}

void Stream::fail(End end) {
  if (over_) return;
  close();
  listener_.on_closed(std::move(end.reason), end.cause);
}

namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

constexpr int kKeepAliveIdleSeconds = 10, kKeepAliveIntervalSeconds = 3, kKeepAliveProbes = 3;

void set_option(int fd, int level, int option, int value) {
  ::setsockopt(fd, level, option, &value, sizeof value);
}

}  // namespace

void tune_socket(int fd, Duration unacknowledged) {
  set_option(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  set_option(fd, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(fd, IPPROTO_TCP, TCP_KEEPIDLE, kKeepAliveIdleSeconds);
  set_option(fd, IPPROTO_TCP, TCP_KEEPINTVL, kKeepAliveIntervalSeconds);
  set_option(fd, IPPROTO_TCP, TCP_KEEPCNT, kKeepAliveProbes);
  const auto limit = std::chrono::duration_cast<std::chrono::milliseconds>(unacknowledged);
  set_option(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, static_cast<int>(limit.count()));
}

void acknowledge_now(int fd) { set_option(fd, IPPROTO_TCP, TCP_QUICKACK, 1); }

std::optional<tcp::socket> adopt_socket(asio::io_context& io, FileDescriptor fd) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getsockname(fd.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0)
    return std::nullopt;
  tcp::socket socket(io);
  boost::system::error_code fault;
  socket.assign(address.ss_family == AF_INET6 ? tcp::v6() : tcp::v4(), fd.get(), fault);
  if (fault) return std::nullopt;
  (void)fd.release();
  return socket;
}

bool peer_responds(int fd) {
  tcp_info info{};
  socklen_t size = sizeof info;
  if (::getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &size) != 0) return true;
  const bool unacknowledged = info.tcpi_unacked > 0 && info.tcpi_retransmits > 0 &&
                              std::chrono::milliseconds{info.tcpi_last_ack_recv} >= kUnacknowledged;
  return !unacknowledged && info.tcpi_probes < kKeepAliveProbes;
}

std::optional<Stream::End> SocketStream::restore(int fd) {
  // The programming session had set its own timeout.
  tune_socket(fd, clients_ == Clients::kOne ? kUnacknowledgedByOne : kUnacknowledged);
  return std::nullopt;
}

Stream::End SocketStream::end_of(int error) const {
  const bool closed = error == 0 || error == ECONNRESET;
  if (clients_ == Clients::kOne && closed && steady_now() - began_ < kAtOnce) {
    return {
        "closed by the server immediately: it accepts one client, and another client is connected",
        Cause::kPortInUse};
  }
  return {error == 0 ? std::string("closed by the peer") : errno_text(error)};
}

Stream::End DatagramStream::end_of(int error) const {
  if (error != ECONNREFUSED) return {errno_text(error)};
  return {"no program receives datagrams there (ICMP: port unreachable)", Cause::kPortUnreachable};
}

std::shared_ptr<SocketStream> make_socket_stream(asio::io_context& io, FileDescriptor socket,
                                                 PortListener& listener, Clients clients) {
  const int fd = socket.get();
  const int flags = ::fcntl(fd, F_GETFL);
  if (flags < 0 || ::fcntl(fd, F_SETFL, flags | O_NONBLOCK) != 0) return nullptr;
  tune_socket(fd, clients == Clients::kOne ? kUnacknowledgedByOne : kUnacknowledged);
  auto stream = std::make_shared<SocketStream>(io, listener, clients);
  return stream->assign(std::move(socket)) ? stream : nullptr;
}

}  // namespace fieldcast
