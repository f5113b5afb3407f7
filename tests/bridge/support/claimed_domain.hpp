// A DDS domain that no other test on this machine uses meanwhile; tests/tools/plant.py claims by
// the same rule.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast::test {

// The claim is the highest port of the domain's range (7400 + 250 * domain ..), which no
// participant below the 120th takes. Above domain 100 the ports are those that the kernel assigns
// out.
class ClaimedDomain {
 public:
  ClaimedDomain() {
    static std::uint32_t claims =
        0;  // the next test of this process starts elsewhere: the last one's farewells travel yet
    const std::uint32_t first = static_cast<std::uint32_t>(::getpid()) + 7 * claims++;
    for (std::uint32_t attempt = 0; attempt < kCount; ++attempt) {
      number_ = kLowest + (first + attempt) % kCount;
      if (claim()) return;
    }
    ADD_FAILURE() << "every DDS domain from 10 to 99 is claimed by a test";
  }
  [[nodiscard]] std::uint32_t number() const { return number_; }

 private:
  static constexpr std::uint32_t kLowest = 10, kCount = 90;

  bool claim() {
    socket_.reset(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * number_ + 249));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return ::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }

  std::uint32_t number_ = 0;
  FileDescriptor socket_;
};

}  // namespace fieldcast::test
