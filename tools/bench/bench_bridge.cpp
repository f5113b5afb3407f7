// The DDS part of a bridge in its own process, without wires: publishes every channel once a second
// in blocks of 50.
//
// usage: bench_bridge DOMAIN BUSES CHANNELS [real] [--record FILE]
//
// The values are the number of the round; with `real`, they are 32-bit numbers that change a little
// in each round, like measured ones. With --record, each block is appended to FILE before it is
// published: "epoch BUS EPOCH" for each bus, then "FIRST COUNT ROUND TIME" for each block: the
// first channel, the number of channels, the sequence of their samples, and the time of acquisition
// in nanoseconds since 1970.
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "bridge/base/clock.hpp"
#include "bridge/dds/endpoints/dds_link.hpp"
#include "tools/bench/support/arguments.hpp"

namespace fieldcast::bench {
namespace {

constexpr std::size_t kBlock = 50;  // samples

std::atomic<bool> stopped = false;

BusSpec bus_of(const std::string& name, std::size_t channels) {
  BusSpec bus;
  bus.name = name;
  for (std::size_t i = 0; i < channels; ++i) {
    if (i % 100 == 0) bus.devices.emplace_back().name = "unit-" + std::to_string(i / 100);
    ChannelSpec& channel = bus.devices.back().channels.emplace_back();
    channel.name = "channel-" + std::to_string(i);
    channel.at = "holding:" + std::to_string(i);
    channel.refresh = std::chrono::seconds(2);
  }
  return bus;
}

// A slow wave with noise, with the digits of a 32-bit number.
double measured(std::size_t channel, std::uint64_t round) {
  const auto phase = static_cast<double>(round) / 60 + static_cast<double>(channel);
  const std::uint64_t noise = (round * 0x9E3779B97F4A7C15 + channel) * 0xBF58476D1CE4E5B9 >> 40;
  return static_cast<float>(50 + 20 * std::sin(phase) + static_cast<double>(noise) * 1e-8);
}

void run(unsigned domain, int buses, std::size_t channels, bool real, const std::string& path) {
  DdsSpec dds;
  dds.domain = domain;
  DdsLink link(dds, "bench",
               {.clock = read_clocks,
                .on_command = [](auto&&...) {},
                .on_interest = [](auto&&...) {},
                .on_problem = [](const std::string& text) { std::printf("%s\n", text.c_str()); }});
  std::vector<std::string> names;
  for (int b = 0; b < buses; ++b) {
    names.push_back("bus-" + std::to_string(b));
    link.add_bus(bus_of(names.back(), channels));
  }
  std::ofstream record;
  if (!path.empty()) record.open(path, std::ios::app);
  for (const StandbyBusFigures& figures : link.stream_figures())
    record << "epoch " << figures.bus << ' ' << figures.epoch << std::endl;
  std::uint64_t round = 0;
  auto due = std::chrono::steady_clock::now();
  const std::size_t blocks = (channels + kBlock - 1) / kBlock;
  const auto step = std::chrono::nanoseconds(std::chrono::seconds(1)) / static_cast<long>(blocks);
  while (!stopped) {
    ++round;
    for (std::size_t first = 0; first < channels && !stopped; first += kBlock) {
      const UtcMapping now = read_clocks();
      const std::size_t end = std::min(channels, first + kBlock);
      record << first << ' ' << end - first << ' ' << round << ' ' << now.utc.nanoseconds
             << std::endl;
      for (const std::string& name : names) {
        std::vector<Sample> samples;
        for (std::size_t i = first; i < end; ++i) {
          Sample& sample = samples.emplace_back();
          sample.channel = static_cast<ChannelIndex>(i);
          sample.value = real ? Value{measured(i, round)} : Value{round};
          sample.quality = Quality::kGood;
          sample.acquired = now.instant;
          sample.sequence = round;
        }
        link.publish(name, samples, now);
      }
      due += step;
      std::this_thread::sleep_until(due);
    }
    if (round == 1) std::printf("published\n");
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  const Arguments arguments(argc, argv);
  if (arguments.size() < 3) return 2;
  std::signal(SIGTERM, [](int) { stopped = true; });
  return run_bench("bench_bridge", [&] {
    run(arguments.number_at(0, 0u), arguments.number_at(1, 0),
        arguments.number_at(2, std::size_t{}), arguments.has("real"), arguments.text("--record"));
  });
}
