#include "bridge/port/readiness.hpp"

#include <sys/epoll.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace fieldcast {

namespace asio = boost::asio;

bool Readiness::assign(int fd) {
  const int epoll = ::epoll_create1(EPOLL_CLOEXEC);
  if (epoll < 0) return false;
  epoll_event nothing{};
  nothing.events = EPOLLONESHOT;
  boost::system::error_code fault;
  if (::epoll_ctl(epoll, EPOLL_CTL_ADD, fd, &nothing) == 0) watch_.assign(epoll, fault);
  if (fault || !watch_.is_open()) {
    ::close(epoll);
    return false;
  }
  fd_ = fd;
  return true;
}

void Readiness::close() {
  if (!watch_.is_open()) return;
  // The descriptor or its copies may stay open elsewhere, which would keep it in the epoll.
  ::epoll_ctl(watch_.native_handle(), EPOLL_CTL_DEL, fd_, nullptr);
  readable_ = writable_ = {};
  boost::system::error_code ignored;
  watch_.close(ignored);
}

void Readiness::wait(Handler& slot, Handler handler) {
  if (!is_open()) return;
  slot = std::move(handler);
  arm();
}

void Readiness::arm() {
  epoll_event wanted{};
  wanted.events =
      EPOLLONESHOT | (readable_ ? EPOLLIN | EPOLLRDHUP : 0u) | (writable_ ? EPOLLOUT : 0u);
  ::epoll_ctl(watch_.native_handle(), EPOLL_CTL_MOD, fd_, &wanted);
  if (std::exchange(waiting_, true)) return;
  watch_.async_wait(asio::posix::stream_descriptor::wait_read,
                    [this, alive = std::weak_ptr<int>(alive_)](boost::system::error_code fault) {
                      if (alive.lock()) on_event(fault);
                    });
}

// A handler may close this object and destroy its owner: no member is used after the last handler.
void Readiness::on_event(boost::system::error_code fault) {
  waiting_ = false;
  if (!is_open()) return;
  epoll_event event{};
  if (!fault) ::epoll_wait(watch_.native_handle(), &event, 1, 0);
  const bool broken = fault || (event.events & (EPOLLERR | EPOLLHUP)) != 0;
  Handler readable, writable;
  if (broken || (event.events & (EPOLLIN | EPOLLRDHUP)) != 0)
    readable = std::exchange(readable_, {});
  if (broken || (event.events & EPOLLOUT) != 0) writable = std::exchange(writable_, {});
  if (readable_ || writable_) arm();
  if (readable) readable(fault);
  if (writable) writable(fault);
}

}  // namespace fieldcast
