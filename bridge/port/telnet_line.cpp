#include "bridge/port/telnet_line.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <utility>

namespace fieldcast {
namespace {

constexpr std::size_t kPiece = 4096;

bool blocked() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

// Returns false if the peer has closed.
bool send_some(int fd, Bytes& bytes) {
  if (bytes.empty()) return true;
  const ssize_t sent = ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (sent < 0) return blocked();
  bytes.erase(bytes.begin(), bytes.begin() + sent);
  return true;
}

}  // namespace

TelnetLine::TelnetLine(boost::asio::io_context& io, FileDescriptor socket, const LineFormat& line)
    : socket_(std::move(socket)),
      server_ready_(io),
      line_ready_(io),
      timer_(io),
      client_(line, steady_now(), to_server_) {}

void TelnetLine::start(Handlers handlers) {
  handlers_ = std::move(handlers);
  boost::asio::post(server_ready_.get_executor(), [self = shared_from_this()] {
    if (self->over_) return;
    if (!self->server_ready_.assign(self->socket_.get()))
      return self->end({"the connection cannot be waited for"});
    self->wait_for_deadline();
    self->turn();
  });
}

void TelnetLine::wait_for_deadline() {
  timer_.expires_at(std::chrono::steady_clock::time_point{client_.deadline().time_since_epoch()});
  timer_.async_wait([self = shared_from_this()](boost::system::error_code cancelled) {
    if (self->over_ || cancelled) return;
    self->client_.on_time(steady_now());
    if (!self->client_.fault().empty()) return self->end({self->client_.fault()});
    self->tell_changed();
  });
}

void TelnetLine::change(const telnet::LineChange& change, telnet::LineChangeDone done) {
  if (over_ || !opened_) return done({});
  while (to_server_.size() < kMaxResponses / 2 && read_line()) {  // what was sent before the change
  }
  if (over_) return done({});
  client_.change(change, steady_now(), to_server_);
  changes_.emplace_back(change, std::move(done));
  wait_for_deadline();
  turn();
  tell_changed();  // if it was refused here
}

void TelnetLine::tell_changed() {
  for (const auto& ended : client_.take_changed()) {
    const auto found =
        std::ranges::find(changes_, ended.change, [](const auto& change) { return change.first; });
    if (found == changes_.end()) continue;
    const auto done = std::move(found->second);
    changes_.erase(found);
    done(ended.in_force);
  }
}

void TelnetLine::turn() {
  if (!over_) from_server();
  if (!over_) from_line();
  if (!over_) flush();
  if (!over_) wait();
}

void TelnetLine::from_server() {
  if (!to_line_.empty()) return;  // the server waits for the line's reader
  std::array<std::uint8_t, kPiece> buffer;
  const ssize_t size = ::read(socket_.get(), buffer.data(), buffer.size());
  if (size < 0 && blocked()) return;
  if (!opened_ && (size == 0 || (size < 0 && errno == ECONNRESET)))
    return end({"closed by the server before the line was open: another client may be connected",
                Cause::kPortInUse});
  if (size <= 0) return end({size == 0 ? "closed by the server" : errno_text(errno)});
  client_.on_bytes({buffer.data(), static_cast<std::size_t>(size)}, to_line_, to_server_);
  acknowledge_now(socket_.get());
  if (!client_.fault().empty()) return end({client_.fault()});
  if (client_.open() && !opened_) on_open();
  tell_changed();
}

void TelnetLine::on_open() {
  opened_ = true;
  timer_.cancel();
  int ends[2];
  const int kind = SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC;
  if (::socketpair(AF_UNIX, kind, 0, ends) != 0) return end({errno_text(errno)});
  pair_ = FileDescriptor(ends[0]);
  FileDescriptor line(ends[1]);
  if (!line_ready_.assign(pair_.get())) return end({"the line cannot be waited for"});
  std::exchange(handlers_, {}).opened(std::move(line));
}

void TelnetLine::from_line() {
  if (opened_ && !client_.suspended() && to_server_.empty()) (void)read_line();
}

bool TelnetLine::read_line() {
  std::array<std::uint8_t, kPiece> buffer;
  const ssize_t size = ::read(pair_.get(), buffer.data(), buffer.size());
  if (size == 0) close();
  if (size <= 0) return false;
  telnet::append_data(to_server_, {buffer.data(), static_cast<std::size_t>(size)});
  return true;
}

void TelnetLine::flush() {
  if (to_server_.size() > kMaxResponses)
    return end({"the server sends requests but reads no responses"});
  if (!send_some(socket_.get(), to_server_)) return end({errno_text(errno)});
  if (opened_ && !send_some(pair_.get(), to_line_)) close();
}

void TelnetLine::wait() {
  wait_for(to_line_.empty() ? kServerReads : kLineWrites);
  if (!to_server_.empty()) wait_for(kServerWrites);
  if (opened_ && to_server_.empty() && !client_.suspended()) wait_for(kLineReads);
}

void TelnetLine::wait_for(Wait what) {
  if ((waiting_ & what) != 0) return;
  waiting_ |= what;
  auto handler = [self = shared_from_this(), what](boost::system::error_code) {
    self->waiting_ &= ~what;
    self->turn();
  };
  Readiness& ready = (what & (kServerReads | kServerWrites)) != 0 ? server_ready_ : line_ready_;
  if ((what & (kServerReads | kLineReads)) != 0)
    ready.wait_readable(std::move(handler));
  else
    ready.wait_writable(std::move(handler));
}

void TelnetLine::end(Stream::End end) {
  reason_ = end.reason;
  const auto failed = std::exchange(handlers_, {}).failed;
  close();
  if (failed) failed(std::move(end));
}

void TelnetLine::close() {
  if (std::exchange(over_, true)) return;
  handlers_ = {};
  for (const auto& [change, done] : std::exchange(changes_, {})) done({});
  timer_.cancel();
  server_ready_.close();
  line_ready_.close();
  socket_.reset();
  pair_.reset();
}

}  // namespace fieldcast
