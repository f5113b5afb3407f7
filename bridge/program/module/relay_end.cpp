#include "bridge/program/module/relay_end.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <boost/asio/error.hpp>
#include <boost/asio/io_context.hpp>
#include <utility>

#include "bridge/port/stream.hpp"

namespace fieldcast::program {

namespace asio = boost::asio;

void RelayEnd::start(Handlers handlers) {
  handlers_ = std::move(handlers);
  read();
}

void RelayEnd::read() {
  if (closed_ || paused_ || finished_ || std::exchange(reading_, true)) return;
  stream_->read_some(asio::buffer(piece_), [self = shared_from_this()](
                                               boost::system::error_code fault, std::size_t count) {
    self->reading_ = false;
    if (self->closed_ || self->finished_) return;
    if (fault)
      return self->fail(fault == asio::error::eof ? "closed by the peer" : fault.message());
    if (self->handlers_.bytes) self->handlers_.bytes(ByteView(self->piece_).first(count));
    self->read();
  });
}

void RelayEnd::send(ByteView bytes) {
  if (closed_ || finished_) return;
  append(waiting_, bytes);
  if (writing_.empty()) write();
  if (!crowded_ && unsent() > kHigh) {
    crowded_ = true;
    if (handlers_.room) handlers_.room(false);
  }
}

void RelayEnd::write() {
  if (written_ == writing_.size()) {
    writing_.clear();
    written_ = 0;
    std::swap(writing_, waiting_);
  }
  if (writing_.empty()) {
    if (finished_) settle();
    return;
  }
  stream_->write_some(
      asio::buffer(writing_) + written_,
      [self = shared_from_this()](boost::system::error_code fault, std::size_t count) {
        if (self->closed_) return;
        if (fault) return self->fail(fault.message());
        self->written_ += count;
        self->taken_ += static_cast<std::int64_t>(count);
        if (self->crowded_ && self->unsent() < kLow) {
          self->crowded_ = false;
          if (self->handlers_.room) self->handlers_.room(true);
        }
        if (!self->closed_) self->write();
      });
}

void RelayEnd::pause(bool paused) {
  paused_ = paused;
  read();
}

void RelayEnd::close() {
  if (std::exchange(closed_, true)) return;
  stream_->close();
  handlers_ = {};
  if (const auto done = std::exchange(finished_, {})) done();
}

bool RelayEnd::drained() {
  if (closed_) return false;
  const std::int64_t left = taken_ - static_cast<std::int64_t>(stream_->queued());
  // TLS counts its overhead, so the value can decrease at first, but not at the end
  if (left <= left_) return false;
  left_ = left;
  return true;
}

void RelayEnd::finish(Until until, std::function<void()> done) {
  if (closed_) return done();
  until_ = until;
  finished_ = std::move(done);
  if (writing_.empty()) write();
}

bool RelayEnd::settle() {
  if (!closed_ && unsent() == 0 && (until_ == Until::kTaken || stream_->queued() == 0)) close();
  return closed_;
}

void RelayEnd::fail(const std::string& reason) {
  const auto gone = std::move(handlers_.gone);
  close();
  if (gone) gone(reason);
}

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
  const auto join = [self = shared_from_this()](std::shared_ptr<RelayEnd> from,
                                                std::shared_ptr<RelayEnd> to) {
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

SilentConnections::Id SilentConnections::add(const std::string& host, Cut cut) {
  const auto same = of_.find(host);
  if (same != of_.end() && same->second >= most_of_one_) {
    cut_oldest_of(host);
  } else if (all_.size() >= most_) {
    cut_one();
  }
  all_.emplace(++last_, Connection{host, std::move(cut)});
  ++of_[host];
  return last_;
}

bool SilentConnections::remove(Id id) {
  const auto found = all_.find(id);
  if (found == all_.end()) return false;
  const auto host = of_.find(found->second.host);
  if (--host->second == 0) of_.erase(host);
  all_.erase(found);
  return true;
}

bool SilentConnections::cut_one() {
  std::size_t most = 0;
  for (const auto& [host, count] : of_) most = std::max(most, count);
  const auto victim = std::find_if(all_.begin(), all_.end(),
                                   [&](const auto& one) { return of_[one.second.host] == most; });
  if (victim == all_.end()) return false;
  cut(victim);
  return true;
}

void SilentConnections::cut_oldest_of(const std::string& host) {
  cut(std::find_if(all_.begin(), all_.end(),
                   [&](const auto& one) { return one.second.host == host; }));
}

void SilentConnections::cut(std::map<Id, Connection>::iterator which) {
  const Cut cut = std::move(which->second.cut);
  remove(which->first);
  cut();
}

}  // namespace fieldcast::program
