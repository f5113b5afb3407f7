// Measures a station's history and its recorder in one process with SQLite: the response of GET
// /api/history for 30 days of one sample a second, without HTTP, and the recording of 10 000
// samples a second.
//
// usage: station_history_bench [--file PATH] [--seconds S]
//
// --file: keeps the store with the 30 days in this file, for tests with a real station; without it
// the store is removed. --seconds: of recording, 20.
#include <cstdio>
#include <thread>

#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"
#include "tools/bench/support/store_history.hpp"
#include "tools/progress/progress_line.hpp"
#include "tools/station/api/history.hpp"
#include "tools/station/record/recorder.hpp"

namespace fieldcast::bench {
namespace {

// See store_history.cpp.
constexpr UtcTime kHistoryBegin{1'699'920'000'000'000'000};
constexpr UtcTime kHistoryEnd{kHistoryBegin.nanoseconds + 30 * 86'400'000'000'000};

double best_milliseconds(const auto& work) {
  double best = 1e9;
  for (int run = 0; run < 5; ++run) {
    const auto began = Clock::now();
    work();
    best = std::min(best, 1e3 * seconds_since(began));
  }
  return best;
}

void measure_history(const std::string& file) {
  std::printf("30 days of samples once a second, as the response of 1 000 points\n");
  fill_thirty_days(StoreAddress(file));
  const auto connection = open_store(StoreAddress(file), IfMissing::kFail);
  for (const int channels : {1, 8}) {
    web::HistoryQuestion question{.from = kHistoryBegin, .to = kHistoryEnd};
    for (int i = 0; i < channels; ++i)
      question.channels.push_back({"history", "device", "c" + std::to_string(i)});
    std::size_t bytes = 0;
    const double time = best_milliseconds([&] {
      bytes =
          web::history_json(kHistoryBegin, kHistoryEnd, web::read_history(*connection, question))
              .size();
    });
    std::printf("  %d channel(s)\n", channels);
    print_figure("    from the question to the JSON", time, "ms", channels == 1 ? "below 100" : "");
    print_figure("    the JSON", static_cast<double>(bytes) / 1e3, "kB");
  }
}

void record(const std::string& file, double seconds) {
  constexpr int kChannels = 10'000;
  constexpr int kBursts = 100;
  std::printf("recording %d samples a second for %.0f s\n", kChannels, seconds);
  StoreSpec spec{file};
  Store store(spec);
  web::Recorder recorder(store);
  std::vector<StationSample> samples;
  for (int i = 0; i < kChannels; ++i) {
    StationChannel channel;
    channel.bus = "bus" + std::to_string(i / 1000);
    channel.device = "d";
    channel.channel = "c" + std::to_string(i);
    channel.type = "float32";
    recorder.on_channel(channel);
    samples.push_back({.bus = channel.bus,
                       .device = channel.device,
                       .channel = channel.channel,
                       .quality = Quality::kGood});
  }
  const double before = process_seconds();
  const auto began = Clock::now();
  double handing = 0;
  std::uint64_t sequence = 0;
  const int bursts = kBursts * static_cast<int>(seconds);
  StepProgress progress("recording", static_cast<std::size_t>(bursts));
  for (int burst = 0; burst < bursts; ++burst) {
    std::this_thread::sleep_until(began + std::chrono::milliseconds{10} * burst);
    const int first = burst % kBursts * (kChannels / kBursts);
    if (first == 0) ++sequence;
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const UtcTime utc{std::chrono::duration_cast<std::chrono::nanoseconds>(now).count()};
    const auto start = Clock::now();
    for (int i = first; i < first + kChannels / kBursts; ++i) {
      StationSample& sample = samples[static_cast<std::size_t>(i)];
      sample.sequence = sequence;
      sample.acquired_at = utc;
      sample.value = static_cast<double>(burst);
      recorder.on_sample(sample, utc);
    }
    handing += seconds_since(start);
    progress.step();
  }
  progress.clear();
  (void)store.flush(std::chrono::seconds{60});
  const double wall = seconds_since(began);
  const auto recorded = static_cast<double>(recorder.counters().recorded);
  print_figure("  recorded", recorded / wall, "samples/s");
  print_figure("  dropped", store.counters().dropped, "samples", "0");
  print_figure("  processor, of one core", (process_seconds() - before) / wall);
  print_figure("  handing one over", 1e6 * handing / recorded, "us");
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  return run_bench("station_history_bench", argc, argv, [](const Arguments& arguments) {
    const ScratchFolder folder;
    measure_history(arguments.text("--file", folder.path() + "/history.db"));
    record(folder.path() + "/recorded.db", arguments.number("--seconds", 20.0));
  });
}
