#include "tests/bridge/support/claimed_domain.hpp"

#include <gtest/gtest.h>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast::test {
namespace {

FileDescriptor participant_in(std::uint32_t domain) {
  FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * domain));
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  const int yes = 1;
  ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  EXPECT_EQ(::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  return socket;
}

TEST(ClaimedDomain, PassesOverADomainWithAParticipant) {
  const std::uint32_t before = ClaimedDomain().number();
  const std::uint32_t first_choice = 10 + (before - 10 + 7) % 90;  // of the next claim
  const FileDescriptor participant = participant_in(first_choice);
  EXPECT_NE(ClaimedDomain().number(), first_choice);
}

}  // namespace
}  // namespace fieldcast::test
