// Reads the metrics of a bridge once a second on its own thread, as Prometheus does.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>

#include "tools/bench/plant/plant.hpp"

namespace fieldcast::bench {

class Scraper {
 public:
  explicit Scraper(std::uint16_t port);
  ~Scraper();  // waits for the pending scrape
  Scraper(const Scraper&) = delete;
  Scraper& operator=(const Scraper&) = delete;

  [[nodiscard]] std::uint64_t scrapes() const { return scrapes_; }  // complete responses
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }      // of the last response

 private:
  void run();

  const std::uint16_t port_;
  std::atomic<std::uint64_t> scrapes_{0}, bytes_{0};
  std::atomic<bool> ending_{false};
  std::thread thread_;  // last member: it uses the members above
};

struct Received {
  std::uint64_t samples = 0, missing = 0;  // by sequence
  std::uint64_t channels = 0;              // with a value
  std::uint64_t listed = 0;                // in the catalogue
  std::uint64_t missing_blocks = 0;
};

// Stations in separate processes with their counters. Main thread.
class StationProcess {
 public:
  // `way`: see bench_station. `loss`: share of dropped datagrams. `program`: prints like it.
  StationProcess(const ScratchFolder& folder, unsigned domain, const std::string& name,
                 const std::string& way, double loss = 0,
                 const std::string& program = "bench_station");
  [[nodiscard]] Received received() const;  // at most 20 ms old while it runs
  [[nodiscard]] double cpu_seconds() const { return process_.cpu_seconds(); }
  [[nodiscard]] pid_t id() const { return process_.id(); }

 private:
  std::string log_;
  Process process_;
};

// Datagrams that the kernel dropped since boot because a socket buffer was full.
[[nodiscard]] std::uint64_t dropped_datagrams();
[[nodiscard]] std::uint64_t dropped_datagrams(pid_t process);

}  // namespace fieldcast::bench
