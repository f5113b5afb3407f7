// Reads the metrics of a bridge once a second, as Prometheus does, on a thread of its own.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

namespace fieldcast::bench {

// A port of the loopback that nobody listens at just now. Throws where there is none.
[[nodiscard]] std::uint16_t free_tcp_port();

class Scraper {
 public:
  explicit Scraper(std::uint16_t port);
  ~Scraper();  // ends after the scrape under way
  Scraper(const Scraper&) = delete;
  Scraper& operator=(const Scraper&) = delete;

  [[nodiscard]] std::uint64_t scrapes() const { return scrapes_; }  // answered in full
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }      // of the last answer

 private:
  void run();

  const std::uint16_t port_;
  std::atomic<std::uint64_t> scrapes_{0}, bytes_{0};
  std::atomic<bool> ending_{false};
  std::thread thread_;  // last: it uses what is above
};

}  // namespace fieldcast::bench
