// Runs all buses of the plant on one thread. Uses epoll and one timerfd instead of Asio for exact
// timing: one absolute timer on the monotonic clock, optional spinning before it, and no layer
// between kernel and write.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bridge/base/file_descriptor.hpp"
#include "tools/sim/bus/served_bus.hpp"
#include "tools/sim/bus/sim_bus.hpp"

namespace fieldcast::sim {

[[nodiscard]] Instant now();

struct LoopOptions {
  Instant end = kNever;  // stops by itself at this time
  Duration spin{};       // busy-waits this long before a due time
  std::string report;    // file written at the end and on SIGUSR1; empty: none
};

class PlantLoop : private Watcher {
 public:
  // Blocks and handles SIGINT, SIGTERM and SIGUSR1 in this thread. REQUIRES: the buses outlive it.
  PlantLoop(const std::vector<std::unique_ptr<SimBus>>& buses, LoopOptions options);
  ~PlantLoop() override;

  // Opens every port; on failure closes the opened ones.
  [[nodiscard]] tl::expected<void, std::string> open();
  [[nodiscard]] std::vector<std::string> locations() const;
  // Runs until the end time, SIGINT or SIGTERM. Returns false if the report cannot be written.
  [[nodiscard]] bool run();

 private:
  struct Entry {
    std::unique_ptr<ServedBus> bus;
    Instant due = kLongAgo;  // time of the next on_time()
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
  std::vector<std::size_t> owner_;  // by descriptor: index in served_
  std::size_t serving_ = 0;         // index of the bus being called
  Instant armed_ = kNever;
  bool stopping_ = false, reported_ = true;
};

[[nodiscard]] std::string location_line(const BusSpec& bus, const std::string& location);

[[nodiscard]] std::string report_of(std::span<const std::unique_ptr<SimBus>> buses,
                                    Duration running);

// Replaces the file atomically. Returns false on failure; see errno.
[[nodiscard]] bool write_report(const std::string& path, const std::string& report);

}  // namespace fieldcast::sim
