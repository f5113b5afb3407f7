// Claims a DDS domain for one test, by the same rule as tests/tools/plant.py.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast::test {

// The claim is the highest port of the domain's range (7400 + 250 * domain ..), which no
// participant below the 120th uses. Above domain 100 the kernel assigns these ports. A domain with
// an unclaimed participant is skipped, for example a bridge that survived its test: a test that
// counts matches would count it too.
class ClaimedDomain {
 public:
  ClaimedDomain() {
    static std::uint32_t claims =
        0;  // the next test starts elsewhere, because messages of the last one may be in flight
    const std::uint32_t first = static_cast<std::uint32_t>(::getpid()) + 7 * claims++;
    for (std::uint32_t attempt = 0; attempt < kCount; ++attempt) {
      number_ = kLowest + (first + attempt) % kCount;
      if (claim() && !is_in_use()) return;
    }
    ADD_FAILURE() << "every DDS domain from 10 to 99 is claimed by a test, or in use";
  }
  [[nodiscard]] std::uint32_t number() const { return number_; }

 private:
  static constexpr std::uint32_t kLowest = 10, kCount = 90;
  static constexpr std::uint32_t kClaimed = 249;  // offset of this port in the domain

  [[nodiscard]] std::uint32_t first_port() const { return 7400 + 250 * number_; }

  // Returns whether a process on this machine uses another port of the domain (proc(5): the first
  // line names the columns, then "number: address:port .." in hexadecimal).
  [[nodiscard]] bool is_in_use() const {
    for (const char* table : {"/proc/net/udp", "/proc/net/udp6"}) {
      std::ifstream file(table);
      std::string line, number, local;
      std::getline(file, line);
      while (std::getline(file, line)) {
        std::istringstream(line) >> number >> local;
        const auto port = std::stoul(local.substr(local.rfind(':') + 1), nullptr, 16);
        if (port >= first_port() && port < first_port() + kClaimed) return true;
      }
    }
    return false;
  }

  bool claim() {
    socket_.reset(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(first_port() + kClaimed));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return ::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }

  std::uint32_t number_ = 0;
  FileDescriptor socket_;
};

}  // namespace fieldcast::test
