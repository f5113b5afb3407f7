// The threads that run the buses: each has an io_context of its own, and a bus lives on one of them for good. The context is the
// bus's strand: its handlers run one after another, never hop threads and take no lock of another bus.
#pragma once

#include <cstddef>
#include <memory>
#include <thread>
#include <vector>

namespace boost::asio {
class io_context;
}

namespace fieldcast {

class IoThreads {
 public:
  // REQUIRES: count >= 1.
  explicit IoThreads(std::size_t count);
  ~IoThreads();  // stop()
  IoThreads(const IoThreads&) = delete;
  IoThreads& operator=(const IoThreads&) = delete;

  // min(2, cores).
  [[nodiscard]] static std::size_t default_count();

  // Buses are dealt out in turn.
  [[nodiscard]] boost::asio::io_context& next();
  // Ends the threads; handlers still queued do not run.
  void stop();

 private:
  struct Worker;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::size_t turn_ = 0;
};

}  // namespace fieldcast
