// The way to the io thread of a bus for others, who may come when the bus has stopped and its
// io_context is gone. Any thread. Includes Asio.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <mutex>
#include <utility>

namespace fieldcast {

class Gate {
 public:
  explicit Gate(boost::asio::io_context& io) : io_(&io) {}
  // False: closed, and nothing was posted.
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
