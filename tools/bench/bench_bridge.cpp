// The DDS part of a bridge in its own process, without wires: publishes every channel once a second
// in blocks of 50.
//
// usage: bench_bridge DOMAIN BUSES CHANNELS [real] [--record FILE] [--store FILE]
//
// The values are the number of the round; with `real`, they are 32-bit numbers that change a little
// in each round, like measured ones. With --record, each block is appended to FILE before it is
// published: "epoch BUS EPOCH" for each bus, then "FIRST COUNT ROUND TIME" for each block: the
// first channel, the number of channels, the sequence of their samples, and the time of acquisition
// in nanoseconds since 1970. With --store, the samples are also written to a store as a bridge
// does, and requests for stored samples are served from it.
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bridge/base/clock.hpp"
#include "bridge/dds/endpoints/dds_link.hpp"
#include "bridge/history/history_service.hpp"
#include "bridge/store/store.hpp"
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

// The store of the buses, and its service. Destroy it after the link is closed.
class StoredBuses {
 public:
  explicit StoredBuses(const std::string& path) {
    if (path.empty()) return;
    spec_.emplace().address = path;
    store_.emplace(*spec_);
  }

  void receive(HistoryRequest request, std::string fault) {
    if (auto* service = receives_.load()) service->receive(std::move(request), std::move(fault));
  }
  void serve(DdsLink& link) {
    service_ = std::make_unique<HistoryService>(
        spec_,
        HistoryService::Uses{[&link](const std::string& bus) { return link.epoch_of(bus) != 0; },
                             [&link](const HistoryRequest& request, const HistoryResponse& rows) {
                               link.respond(request, rows);
                             }});
    receives_ = service_.get();
  }
  void add(const BusSpec& bus, std::uint64_t epoch) {
    if (!store_) return;
    store_->put(BusEpoch{bus.name, epoch});
    intakes_.push_back(store_->intake(bus));
  }
  void put(std::size_t bus, const std::vector<Sample>& samples, const UtcMapping& mapping) {
    if (store_) intakes_[bus]->put(samples, mapping, read_clocks().utc);
  }
  void stop_serving() {
    if (service_) service_->close();
  }

 private:
  std::optional<StoreSpec> spec_;
  std::optional<Store> store_;
  std::vector<std::unique_ptr<Store::Intake>> intakes_;
  std::unique_ptr<HistoryService> service_;
  std::atomic<HistoryService*> receives_ = nullptr;  // service_, once it exists
};

void run(unsigned domain, int buses, std::size_t channels, bool real, const Arguments& arguments) {
  const std::string path = arguments.text("--record");
  DdsSpec dds;
  dds.domain = domain;
  StoredBuses stored(arguments.text("--store"));
  DdsLink link(dds, "bench",
               {.clock = read_clocks,
                .on_command = [](auto&&...) {},
                .on_interest = [](auto&&...) {},
                .on_problem = [](const std::string& text) { std::printf("%s\n", text.c_str()); },
                .on_history =
                    [&stored](HistoryRequest request, std::string fault) {
                      stored.receive(std::move(request), std::move(fault));
                    }});
  stored.serve(link);
  std::ofstream record;
  if (!path.empty()) record.open(path, std::ios::app);
  std::vector<std::string> names;
  for (int b = 0; b < buses; ++b) {
    names.push_back("bus-" + std::to_string(b));
    const BusSpec bus = bus_of(names.back(), channels);
    link.add_bus(bus);
    stored.add(bus, link.epoch_of(bus.name));
    record << "epoch " << bus.name << ' ' << link.epoch_of(bus.name) << std::endl;
  }
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
      for (std::size_t b = 0; b < names.size(); ++b) {
        std::vector<Sample> samples;
        for (std::size_t i = first; i < end; ++i) {
          Sample& sample = samples.emplace_back();
          sample.channel = static_cast<ChannelIndex>(i);
          sample.value = real ? Value{measured(i, round)} : Value{round};
          sample.quality = Quality::kGood;
          sample.acquired = now.instant;
          sample.sequence = round;
        }
        link.publish(names[b], samples, now);
        stored.put(b, samples, now);
      }
      due += step;
      std::this_thread::sleep_until(due);
    }
    if (round == 1) std::printf("published\n");
    std::fflush(stdout);
  }
  stored.stop_serving();
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
        arguments.number_at(2, std::size_t{}), arguments.has("real"), arguments);
  });
}
