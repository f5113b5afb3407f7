// Measures the effect of the store on acquisition and its reliability: 20 000 samples a second for
// a minute, with and without store; the same in a bridge with saturated buses; and a process that
// is killed while it stores.
//
// usage: store_bench [--seconds N] [--url postgresql://..]
//                    [--only killed | throughput | history | saturated]
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <set>

#include "bridge/base/clock.hpp"
#include "bridge/store/store.hpp"
#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"
#include "tools/bench/support/store_history.hpp"

namespace fieldcast::bench {
namespace {

constexpr std::size_t kChannels = 1000;
constexpr std::size_t kBlock = 100;                         // samples of one response
constexpr Duration kPeriod = std::chrono::milliseconds{5};  // 200 responses a second
constexpr unsigned kResponses = 200;                        // in a second

BusSpec bus() {
  BusSpec made;
  made.name = "bus";
  made.devices.resize(1);
  made.devices[0].name = "device";
  made.devices[0].channels.resize(kChannels);
  for (std::size_t i = 0; i < kChannels; ++i)
    made.devices[0].channels[i].name = "c" + std::to_string(i);
  return made;
}

std::vector<Sample> block(std::uint64_t response, Instant now) {
  std::vector<Sample> samples(kBlock);
  for (std::size_t i = 0; i < kBlock; ++i) {
    const std::uint64_t number = response * kBlock + i;
    Sample& sample = samples[i];
    sample.channel = static_cast<ChannelIndex>(number % kChannels);
    sample.value = 0.001 * static_cast<double>(number);
    sample.quality = Quality::kGood;
    sample.acquired = now;
    sample.sequence = number / kChannels + 1;
  }
  return samples;
}

struct Costs {
  std::vector<double> lateness, put;  // microseconds
};
// A bus with one response each period, on a thread with the same timing as in the bridge.
Costs acquire(Store::Intake* intake, double seconds, Duration ahead) {
  prctl(PR_SET_TIMERSLACK, 1000UL);
  Costs costs;
  auto next = Clock::now();
  const auto responses = static_cast<std::uint64_t>(seconds * kResponses);
  for (std::uint64_t response = 0; response < responses; ++response) {
    next += kPeriod;
    std::this_thread::sleep_until(next);
    const auto began = Clock::now();
    const UtcMapping mapping = read_clocks();
    const auto samples = block(response, mapping.instant);
    const auto made = Clock::now();
    if (intake) intake->put(samples, mapping, {mapping.utc.nanoseconds + ahead.count()});
    costs.lateness.push_back(std::chrono::duration<double, std::micro>(began - next).count());
    costs.put.push_back(std::chrono::duration<double, std::micro>(Clock::now() - made).count());
  }
  return costs;
}

void print_costs(const char* what, Costs& costs) {
  std::printf("%s\n", what);
  for (const auto& [name, values] : {std::pair{"  a response is late by", &costs.lateness},
                                     std::pair{"  handing 100 samples over", &costs.put}}) {
    print_figure(std::string(name) + ", median", quantile(*values, 0.5), "us");
    print_figure(std::string(name) + ", p99", quantile(*values, 0.99), "us");
    print_figure(std::string(name) + ", most", quantile(*values, 1.0), "us");
  }
}

struct Stored {
  Costs costs;
  double processor = 0;  // cores
};
// Published now, or `ahead` of now.
Stored store_for(const std::string& address, double seconds, Duration ahead) {
  StoreSpec spec{address};
  const double cpu = process_seconds();
  Store store(spec);
  const auto intake = store.intake(bus());
  Stored result{acquire(intake.get(), seconds, ahead)};
  const auto counters = store.counters();
  const bool flushed = store.flush(std::chrono::seconds{30});
  result.processor = (process_seconds() - cpu) / seconds;
  const double put = seconds * kResponses * kBlock;
  print_figure("  samples stored of those put", static_cast<double>(store.counters().stored) / put,
               "", flushed ? "goal 1" : "not flushed");
  print_figure("  samples dropped", store.counters().dropped, "", "goal 0");
  print_figure("  samples still waiting at the end", counters.waiting, "", "below 200 000");
  print_figure("  processor of the process", result.processor, "cores");
  return result;
}

double counted_by_tiers(const std::string& address) {
  double counted = 0;
  open_store(StoreAddress(address), IfMissing::kFail)
      ->query("select cast(sum(count) as double precision) from tiers where width = 60", {},
              [&](const SqlRow& row) {
                if (const auto* sum = std::get_if<double>(&row.at(0))) counted = *sum;
                return true;
              });
  return counted;
}

void throughput(const std::string& address, double seconds) {
  Costs without = acquire(nullptr, seconds / 3, {});
  print_costs("20 000 samples a second, no store", without);
  std::printf("20 000 samples a second, with the store\n");
  Stored with = store_for(address, seconds, {});
  print_costs("  what it costs acquisition", with.costs);
  print_figure("  samples in the minutes that were written", counted_by_tiers(address));
  print_figure("  p99 of the lateness, with / without",
               quantile(with.costs.lateness, 0.99) / quantile(without.lateness, 0.99));
  if (!StoreAddress(address).is_server()) {
    print_figure(
        "  file for one sample",
        static_cast<double>(std::filesystem::file_size(address)) / (seconds * kResponses * kBlock),
        "bytes");
  }
  // Minutes in the future are not finished, so none is written.
  std::printf("the same without writing minutes\n");
  const Stored untiered = store_for(address, seconds, std::chrono::hours{48});
  print_figure("  processor, with minutes / without", with.processor / untiered.processor);
  print_figure("  p99 of the lateness, with minutes / without",
               quantile(with.costs.lateness, 0.99) / quantile(untiered.costs.lateness, 0.99));
}

constexpr int kBuses = 8;

std::string buses(bool stored) {
  std::string text;
  for (int b = 1; b <= kBuses; ++b)
    text += serial_bus("bus-" + std::to_string(b), 115200, "refresh: 2s, mode: intensive",
                       scattered_devices(2, 100, 7), "8N1");
  return stored ? text + "store: { path: {dir}/store.db }\n" : text;
}

struct Acquired {
  double samples_a_second = 0, wire = 1, processor = 0;
};

Acquired saturate(bool stored, double seconds) {
  Plant plant(buses(stored));
  plant.start_simulator();
  plant.start_bridge();
  plant.listen_to_status();
  let_run(12);  // the measured load covers the last ten seconds
  const auto published = [&] {
    std::uint64_t sum = 0;
    for (const auto& [name, status] : plant.buses()) sum += status.report.samples;
    return static_cast<double>(sum);
  };
  const double before = published();
  const double cpu = plant.bridge().cpu_seconds();
  let_run(seconds);
  Acquired result;
  result.samples_a_second = (published() - before) / seconds;
  result.processor = (plant.bridge().cpu_seconds() - cpu) / seconds;
  for (const auto& [name, status] : plant.buses())
    result.wire = std::min(result.wire, status.report.measured_load);
  return result;
}

void saturated(double seconds) {
  const Acquired without = saturate(false, seconds);
  const Acquired with = saturate(true, seconds);
  std::printf("8 saturated buses at 115200 baud, the bridge without and with a store\n");
  print_figure("  samples a second, without", without.samples_a_second, "1/s");
  print_figure("  samples a second, with", with.samples_a_second, "1/s");
  print_figure("  with / without", with.samples_a_second / without.samples_a_second, "", "goal 1");
  print_figure("  share of its wire, least bus, without", without.wire);
  print_figure("  share of its wire, least bus, with", with.wire);
  print_figure("  processor of the bridge, without", without.processor, "cores");
  print_figure("  processor of the bridge, with", with.processor, "cores");
}

[[noreturn]] void store_and_report(const std::string& address, int report_to) {
  Store store(StoreSpec{address});
  const auto intake = store.intake(bus());
  auto next = Clock::now();
  for (std::uint64_t response = 0;; ++response) {
    std::this_thread::sleep_until(next += kPeriod);
    const UtcMapping mapping = read_clocks();
    intake->put(block(response, mapping.instant), mapping, mapping.utc);
    const std::uint64_t stored = store.counters().stored;
    if (::write(report_to, &stored, sizeof stored) != sizeof stored) ::_exit(1);
  }
}

void killed(const std::string& address, double seconds) {
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("no child");
  if (child == 0) store_and_report(address, ends[1]);
  ::close(ends[1]);
  std::uint64_t reported = 0, now = 0;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (Clock::now() < end && ::read(ends[0], &now, sizeof now) == sizeof now) reported = now;
  ::kill(child, SIGKILL);
  while (::read(ends[0], &now, sizeof now) == sizeof now) reported = now;
  ::waitpid(child, nullptr, 0);
  ::close(ends[0]);
  std::uint64_t found = 0;
  std::set<std::uint64_t> first;  // numbers of the stored samples among those reported first
  const auto connection = open_store(StoreAddress(address), IfMissing::kFail);
  SampleTable(*connection)
      .history(Pattern(), {}, UtcTime{INT64_MAX}, [&](const StoredSample& sample) {
        ++found;
        const std::uint64_t number =
            (sample.sequence - 1) * kChannels + std::stoull(sample.channel.substr(1));
        if (number < reported) first.insert(number);
        return true;
      });
  std::printf("a process that stores 20 000 samples a second, killed (SIGKILL)\n");
  print_figure("  samples reported stored", reported);
  print_figure("  samples found afterwards", found);
  print_figure("  reported and lost", reported - first.size(), "", "goal 0");
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  return run_bench("store_bench", argc, argv, [](const Arguments& arguments) {
    const double seconds = arguments.number("--seconds", 60.0);
    const std::string url = arguments.text("--url"), only = arguments.text("--only");
    const auto wanted = [&](const char* part) { return only.empty() || only == part; };
    const ScratchFolder folder;
    const auto address = [&](const char* file) {
      return url.empty() ? folder.path() + '/' + file : url;
    };
    if (wanted("killed")) killed(address("killed.db"), seconds / 6);  // first, because it forks
    if (wanted("throughput")) throughput(address("store.db"), seconds);
    if (wanted("history")) read_thirty_days(fieldcast::StoreAddress(address("history.db")));
    if (wanted("saturated") && url.empty()) saturated(seconds / 4);
  });
}
