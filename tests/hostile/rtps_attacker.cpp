// Sends hostile datagrams to the participants of a domain on the loopback, for rtps_attacks.py: the
// known faults of the DDS library, mutated traffic, and announcements of participants that do not
// exist. It never uses the name of a real participant: on one machine the guard does not
// distinguish senders, so a forged "has left" of a real one is accepted (docs/security.md).
//
//   rtps-attacker DOMAIN SECONDS SEED
//
// Prints the number of sent datagrams.
#include <arpa/inet.h>
#include <sys/socket.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "bridge/base/file_descriptor.hpp"
#include "tests/bridge/dds/transport/known_attacks.hpp"
#include "tests/bridge/dds/transport/recorded_datagrams.hpp"
#include "tests/campaign/rtps_mutation.hpp"

namespace {

using namespace fieldcast;
using Clock = std::chrono::steady_clock;

constexpr int kParticipants = 4;  // number of participants whose ports are attacked
constexpr auto kPause = std::chrono::milliseconds{20};
constexpr int kInARow = 100;

// RTPS 2.2, 9.6.1.1: the common multicast port of discovery, and two ports for each participant.
std::vector<sockaddr_in> targets_of(int domain) {
  const auto target = [domain](const char* address, int offset) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * domain + offset));
    ::inet_pton(AF_INET, address, &to.sin_addr);
    return to;
  };
  std::vector<sockaddr_in> all{target("239.255.0.1", 0)};
  for (int i = 0; i < 2 * kParticipants; ++i) all.push_back(target("127.0.0.1", 10 + i));
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: rtps-attacker DOMAIN SECONDS SEED\n");
    return 2;
  }
  const std::vector<sockaddr_in> targets = targets_of(std::atoi(argv[1]));
  const auto end = Clock::now() + std::chrono::seconds{std::atoi(argv[2])};
  const FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const in_addr loopback{htonl(INADDR_LOOPBACK)};
  ::setsockopt(socket.get(), IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback);

  std::vector<testing::Datagram> corpus = testing::recorded_datagrams(), known;
  if (corpus.empty()) {
    std::fprintf(stderr, "cannot read %s\n", FIELDCAST_RECORDED_DATAGRAMS);
    return 1;
  }
  for (const auto& valid : testing::valid_datagrams()) corpus.push_back(valid.bytes);
  for (const auto& attack : testing::known_attacks()) known.push_back(attack.datagram);
  testing::RtpsMutation mutation(corpus, std::strtoull(argv[3], nullptr, 10));
  ParticipantPrefix forged = testing::kSender;
  unsigned long long sent = 0;
  while (Clock::now() < end) {
    for (int i = 0; i < kInARow; ++i) {
      testing::Datagram one = mutation.next();
      if (i % 10 == 0) one = known[sent / 10 % known.size()];
      if (i % 10 == 1) {
        for (std::size_t at = 8; at < forged.size() && ++forged[at] == 0; ++at) {}
        one = testing::announcement(forged);
      }
      const sockaddr_in& to = targets[sent++ % targets.size()];
      (void)::sendto(socket.get(), one.data(), one.size(), 0,
                     reinterpret_cast<const sockaddr*>(&to), sizeof to);
    }
    std::this_thread::sleep_for(kPause);
  }
  std::printf("%llu\n", sent);
}
