#include "bridge/program/module/relay_end.hpp"

#include <algorithm>
#include <boost/asio/error.hpp>
#include <utility>

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
