// Posts handlers to the io thread of a bus, and refuses them after the bus has stopped and its
// io_context no longer exists. Any thread. Includes Asio.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <mutex>
#include <utility>

namespace fieldcast {

class Gate {
 public:
  explicit Gate(boost::asio::io_context& io) : io_(&io) {}
  // Returns false if closed; nothing was posted then.
  template <typename Handler>
  bool post(Handler&& handler) {
    const std::lock_guard lock(mutex_);
    if (io_) boost::asio::post(*io_, std::forward<Handler>(handler));
    return io_ != nullptr;
  }
  void close() {
    const std::lock_guard lock(mutex_);
    io_ = nullptr;
  }

 private:
  std::mutex mutex_;
  boost::asio::io_context* io_;
};

}  // namespace fieldcast
