// Waits until a descriptor is readable or writable, and is not woken while nobody waits.
//
// Asio watches a descriptor edge-triggered from the moment it is assigned: a terminal that fills
// wakes its thread for each burst of some bytes, also while the answer is to gather. Here a small
// epoll of its own stands between: armed for one event at a time, and only while somebody waits.
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

  // Watches this descriptor, once, until close(); false when that is not possible.
  [[nodiscard]] bool assign(int fd);
  [[nodiscard]] bool is_open() const { return watch_.is_open(); }
  [[nodiscard]] auto get_executor() { return watch_.get_executor(); }

  // The handler is called once, posted; not after close(). One wait of each kind at a time.
  void wait_readable(Handler handler) { wait(readable_, std::move(handler)); }
  void wait_writable(Handler handler) { wait(writable_, std::move(handler)); }
  void close();

 private:
  void wait(Handler& slot, Handler handler);
  void arm();
  void on_event(boost::system::error_code fault);

  int fd_ = -1;
  boost::asio::posix::stream_descriptor watch_;           // the epoll
  Handler readable_, writable_;                           // null: nobody waits
  bool waiting_ = false;                                  // for the epoll
  std::shared_ptr<int> alive_ = std::make_shared<int>();  // the wait for the epoll may outlive this
};

}  // namespace fieldcast
