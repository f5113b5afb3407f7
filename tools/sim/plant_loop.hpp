// Runs all buses of the plant on one thread: waits for bytes, instants and signals, and calls the
// bus that they concern.
//
// Plain epoll and one timerfd, not Asio: the loop's product is the exact instant, so it wants one
// absolute timer on the monotonic clock (without the slack of a poll's timeout), the freedom to
// spin before it, and nothing between the kernel and the write.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bridge/base/file_descriptor.hpp"
#include "tools/sim/bus/served_bus.hpp"

namespace fieldcast::sim {

// The monotonic clock.
[[nodiscard]] Instant now();

struct LoopOptions {
  Instant end = kNever;  // stops by itself then
  Duration spin{};       // busy-wait the last stretch before an instant
  std::string report;    // file, written at the end and on SIGUSR1; empty: none
};

class PlantLoop : private Watcher {
 public:
  // Blocks SIGINT, SIGTERM and SIGUSR1 in this thread and takes them itself. REQUIRES: the buses
  // outlive the loop.
  PlantLoop(const std::vector<std::unique_ptr<SimBus>>& buses, LoopOptions options);
  ~PlantLoop() override;

  // Opens every port; or why not, with those opened closed again.
  [[nodiscard]] tl::expected<void, std::string> open();
  [[nodiscard]] std::vector<std::string> locations() const;
  // Until the end, SIGINT or SIGTERM; then ports are closed and links gone. False: the report could
  // not be written.
  [[nodiscard]] bool run();

 private:
  struct Entry {
    std::unique_ptr<ServedBus> bus;
    Instant due = kLongAgo;  // when on_time() wants to be called
  };
  void watch(int fd) override;
  void forget(int fd) override;
  void wait(Instant until);
  void take(int fd);
  void take_signal();
  void arm(Instant at);
  [[nodiscard]] bool report() const;

  const std::vector<std::unique_ptr<SimBus>>& buses_;
  LoopOptions options_;
  FileDescriptor epoll_, timer_, signals_;
  std::vector<Entry> served_;
  std::vector<std::size_t> owner_;  // by descriptor: which of served_
  std::size_t serving_ = 0;         // who is being called
  Instant armed_ = kNever;
  bool stopping_ = false, reported_ = true;
};

}  // namespace fieldcast::sim
