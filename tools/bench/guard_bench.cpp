// Measures the datagram guard before the DDS library: nanoseconds of one thread for each datagram,
// by its form, with datagrams of many writers interleaved.
//
// usage: guard_bench [seconds of each measurement, 0.3]
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "bridge/dds/guard/datagram_guard.hpp"
#include "tests/bridge/dds/transport/rtps_datagrams.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"

namespace {

using namespace fieldcast;
using bench::Clock;
using testing::Datagram;

// The minimum of the rounds, because other processes share the machine.
double nanoseconds_of(const std::vector<Datagram>& datagrams, double seconds) {
  DatagramGuard guard{RtpsLimits{}};
  Datagram scratch;
  constexpr Instant now{std::chrono::seconds{1}};
  double best = 1e9;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  do {
    const auto start = Clock::now();
    for (int round = 0; round < 10; ++round) {
      for (const Datagram& one : datagrams) {
        const auto verdict = guard.check(one, {1}, now, scratch);
        if (!verdict.fault) continue;
        std::fprintf(stderr, "a valid datagram is refused: %s\n",
                     std::string(to_text(*verdict.fault)).c_str());
        std::exit(1);
      }
    }
    const std::chrono::duration<double, std::nano> took = Clock::now() - start;
    best = std::min(best, took.count() / (10.0 * static_cast<double>(datagrams.size())));
  } while (Clock::now() < end);
  return best;
}

template <class Make>
std::vector<Datagram> of_senders(Make make) {
  std::vector<Datagram> all;
  for (std::uint8_t i = 0; i < 100; ++i) {
    ParticipantPrefix sender = testing::kSender;
    sender[11] = i;
    all.push_back(make(i, sender));
  }
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace testing;  // NOLINT(google-build-using-namespace): parts of datagrams
  const double seconds = bench::Arguments(argc, argv).number_at(0, 0.3);
  const auto measure = [&](const char* what, auto make) {
    bench::print_figure(what, nanoseconds_of(of_senders(make), seconds), "ns", "<= 1000");
  };
  const Datagram keys = list_of({{0x0070, Datagram(16, 3)}, {0x0071, {0, 0, 0, 0}}});
  measure("a block of samples, 1300 bytes",
          [](auto number, auto& sender) { return from(sender, sample(number + 1, 1300)); });
  measure("8 keyed samples and a heartbeat", [&](auto, auto& sender) {
    Datagram all = header();
    for (int i = 1; i <= 8; ++i)
      all = joined(all, data(kSamplesWriter, i, keys, payload_of(1, Datagram(96, 1))));
    return from(sender, joined(all, heartbeat(1, 8, 1)));
  });
  measure("a heartbeat", [](auto, auto& sender) { return from(sender, heartbeat(1, 100, 1)); });
  measure("an acknowledgement", [](auto, auto& sender) {
    return from(sender, acknack(7, {1, 2, 3, 4}));
  });
  measure("a participant (SPDP)", [](auto, auto& sender) { return announcement(sender); });
  measure("an endpoint with the description of its type (SEDP)",
          [](auto number, auto& sender) { return endpoint(number, sender); });
}
