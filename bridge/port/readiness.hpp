// Waits until a descriptor is readable or writable; causes no wake-up while no wait is pending.
//
// Asio watches a descriptor edge-triggered as soon as it is assigned. A terminal then wakes the
// thread for each burst of bytes, also while a response accumulates. This class uses its own epoll,
// which is armed for one event at a time and only during a wait.
//
// Owns the epoll, not the descriptor. Lives on its bus's io thread.
#pragma once

#include <boost/asio/posix/stream_descriptor.hpp>
#include <cstdint>
#include <functional>
#include <memory>

namespace fieldcast {

class Readiness {
 public:
  using Handler = std::function<void(boost::system::error_code)>;

  explicit Readiness(boost::asio::io_context& io) : watch_(io) {}

  // Watches this descriptor until close(); call once. Returns false if that is not possible.
  [[nodiscard]] bool assign(int fd);
  [[nodiscard]] bool is_open() const { return watch_.is_open(); }
  [[nodiscard]] auto get_executor() { return watch_.get_executor(); }

  // Calls the handler once, posted, and not after close(). One wait of each kind at a time.
  void wait_readable(Handler handler) { wait(readable_, std::move(handler)); }
  void wait_writable(Handler handler) { wait(writable_, std::move(handler)); }
  void close();

 private:
  void wait(Handler& slot, Handler handler);
  void arm();
  void on_event(boost::system::error_code fault);

  int fd_ = -1;
  boost::asio::posix::stream_descriptor watch_;  // the epoll
  Handler readable_, writable_;
  bool waiting_ = false;  // for the epoll
  // The wait for the epoll may outlive this object.
  std::shared_ptr<int> alive_ = std::make_shared<int>();
};

}  // namespace fieldcast
