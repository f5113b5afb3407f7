#include "tools/bench/plant/plant.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <random>
#include <stdexcept>
#include <thread>

#include "tools/progress/progress_line.hpp"

namespace fieldcast::bench {
namespace {

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

}  // namespace

Plant::Plant(const std::string& buses, const std::string& faults, const std::string& more) {
  dds_.domain = own_domain();
  config_ =
      folder_.write("bridge.yaml", "bridge: bench\ndds: { domain: " + std::to_string(dds_.domain) +
                                       ", interfaces: [127.0.0.1] }\n" + more + "buses:\n" +
                                       replaced(buses, "{dir}", folder_.path()));
  if (!faults.empty()) faults_ = folder_.write("faults.yaml", faults);
}

void Plant::start_simulator(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{config_};
  if (!faults_.empty()) arguments.insert(arguments.end(), {"--faults", faults_});
  arguments.insert(arguments.end(), more.begin(), more.end());
  simulator_ = std::make_unique<Process>("fieldcast-sim", arguments, folder_.path() + "/sim.log");
}

void Plant::start_bridge(const std::string& program) {
  {
    const std::lock_guard guard(lock_);
    seen_.clear();  // of the previous bridge
  }
  bridge_ = std::make_unique<Process>(program, std::vector<std::string>{config_},
                                      folder_.path() + "/bridge.log");
}

void Plant::listen_to_status() {
  if (station_) return;
  station_ = std::make_unique<Station>(dds_, "bench");
  station_->subscribe_bus_status([this](const StationBusStatus& status) {
    const std::lock_guard guard(lock_);
    buses_[status.bus] = status;
  });
  station_->subscribe_device_status([this](const StationDeviceStatus& status) {
    const std::lock_guard guard(lock_);
    devices_[status.bus + '/' + status.device] = status;
  });
}

void Plant::listen() {
  listen_to_status();
  if (listening_) return;
  listening_ = true;
  station_->subscribe_samples([this](const StationSample& sample) {
    const std::lock_guard guard(lock_);
    Seen& seen = seen_[sample.bus + '/' + sample.device + '/' + sample.channel];
    if (sample.quality != Quality::kGood) {
      ++seen.bad;
      return;
    }
    const std::int64_t at = sample.acquired_at.nanoseconds;
    if (seen.last_acquired > 0) {
      seen.longest_gap = std::max(seen.longest_gap, at - seen.last_acquired);
      seen.shortest_gap = std::min(seen.shortest_gap, at - seen.last_acquired);
    }
    ++seen.samples;
    seen.last_acquired = at;
  });
}

void Plant::forget_samples() {
  const std::lock_guard guard(lock_);
  // A gap that is open at the mark counts completely.
  for (auto& [name, seen] : seen_) seen = Seen{.last_acquired = seen.last_acquired};
}

std::map<std::string, Seen> Plant::seen() const {
  const std::lock_guard guard(lock_);
  return seen_;
}

std::map<std::string, StationBusStatus> Plant::buses() const {
  const std::lock_guard guard(lock_);
  return buses_;
}

std::map<std::string, StationDeviceStatus> Plant::devices() const {
  const std::lock_guard guard(lock_);
  return devices_;
}

void Plant::wait_until_seen(std::size_t channels, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  std::size_t good = 0;
  while (std::chrono::steady_clock::now() < end) {
    good = 0;
    for (const auto& [name, seen] : this->seen()) good += seen.samples > 0;
    if (good >= channels) return;
    let_run(0.05);
  }
  throw std::runtime_error("only " + std::to_string(good) + " of " + std::to_string(channels) +
                           " channels had a good sample; see " + folder_.path());
}

void let_run(double seconds) {
  using Seconds = std::chrono::duration<double>;
  constexpr Seconds kStep{0.2};
  const auto began = std::chrono::steady_clock::now();
  ProgressLine progress(std::cerr);
  for (Seconds left{seconds}; left > Seconds{};) {
    // without a terminal, avoids wake-ups during the measurement
    std::this_thread::sleep_for(progress.seen() ? std::min(left, kStep) : left);
    left = Seconds{seconds} - Seconds{std::chrono::steady_clock::now() - began};
    progress.show([&](Duration elapsed) {
      return progress_text("measuring", 1 - left.count() / seconds, elapsed);
    });
  }
}

double seconds_from(int argc, char** argv, double by_default) {
  for (int i = 1; i + 1 < argc; ++i) {
    if (std::strcmp(argv[i], "--seconds") == 0) return std::atof(argv[i + 1]);
  }
  return by_default;
}

namespace {

// `first` is the address of register 0, `step(r)` the distance from register r to r + 1.
template <class First, class Step>
std::string devices_of(int devices, int registers, const std::string& indent, First first,
                       Step step) {
  std::string text;
  for (int d = 1; d <= devices; ++d) {
    const std::string name = "unit-" + std::to_string(d);
    text += indent + "- name: " + name + "\n" + indent + "  address: " + std::to_string(d) + "\n" +
            indent + "  channels:\n";
    unsigned long address = first();
    for (int r = 0; r < registers; ++r) {
      text += indent + "    - { name: r" + std::to_string(r) +
              ", at: \"holding:" + std::to_string(address) +
              "\", type: uint16, access: read-write }\n";
      address += step(r);
    }
  }
  return text;
}

}  // namespace

std::string scattered_devices(int devices, int registers, const std::string& indent,
                              unsigned seed) {
  std::mt19937 random(seed);
  // Mostly close addresses, sometimes a gap that no read should include.
  return devices_of(
      devices, registers, indent, [&] { return random() % 50; },
      [&](int) { return random() % 20 == 0 ? 30 + random() % 100 : 1 + random() % 4; });
}

std::string packed_devices(int devices, int registers, const std::string& indent, int run) {
  return devices_of(
      devices, registers, indent, [] { return 0UL; },
      [run](int r) { return (r + 1) % run == 0 ? 201UL : 1UL; });
}

}  // namespace fieldcast::bench
