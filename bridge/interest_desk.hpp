// Where interests from DDS come in: keeps the book of wishes and tells each bus what changed for its channels. Any thread.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <tl/expected.hpp>

#include "bridge/bus_runner.hpp"
#include "bridge/interest_book.hpp"

namespace fieldcast {

class InterestDesk {
 public:
  // The bus is told the wishes that stand, and every change until it is removed.
  void add(const BusSpec& bus, std::shared_ptr<BusRunner> runner);
  void remove(const std::string& bus);

  // Nobody wishes anything any more.
  void forget();

  // As InterestBook::note().
  [[nodiscard]] tl::expected<void, std::string> note(const std::string& station, const std::string& pattern,
                                                     std::optional<Duration> refresh);

 private:
  struct Bus {
    BusSpec spec;
    std::shared_ptr<BusRunner> runner;
    std::map<ChannelIndex, Duration> told;
  };
  void tell(Bus& bus);

  std::mutex mutex_;
  InterestBook book_;
  std::map<std::string, Bus, std::less<>> buses_;
};

}  // namespace fieldcast
