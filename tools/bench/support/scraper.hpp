// Reads the metrics of a bridge once a second on its own thread, as Prometheus does.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

namespace fieldcast::bench {

// Throws if there is no free port.
[[nodiscard]] std::uint16_t free_tcp_port();

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

}  // namespace fieldcast::bench
