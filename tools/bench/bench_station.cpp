// A station in its own process: subscribes to every sample and prints totals every 20 ms.
//
// usage: bench_station DOMAIN one-by-one|best-effort|by-blocks [SHARE OF DATAGRAMS LOST]
//
// one-by-one: by fieldcast/Sample. best-effort: too, with a reader of this reliability.
// Each line: samples received, samples missing by sequence, channels with a value, channels of the
// catalogue, blocks missing.
#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <optional>
#include <string>
#include <thread>
#include <unordered_map>

#include "bridge/dds/library/fastdds.hpp"
#include "bridge/dds/topics/received_sample.hpp"
#include "bridge/dds/topics/topics.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "bridge/station/station.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/lossy_receive.hpp"

namespace fieldcast::bench {
namespace {

std::atomic<bool> stopped = false;

// Counts samples of a subscription; written by one thread, read by another.
class Count {
 public:
  void add(const StationSample& sample) {
    path_.assign(sample.bus)
        .append(1, '/')
        .append(sample.device)
        .append(1, '/')
        .append(sample.channel);
    std::uint64_t& last = last_[path_];
    if (last == 0) ++channels;
    // A restarted bus counts from 1 again.
    if (last != 0 && sample.sequence > last + 1) missing += sample.sequence - last - 1;
    last = sample.sequence;
    ++samples;
  }
  std::atomic<std::uint64_t> samples = 0, missing = 0, channels = 0, listed = 0;

 private:
  std::string path_;
  std::unordered_map<std::string, std::uint64_t> last_;
};

// A reader of its own: Station has only reliable ones.
class BestEffortReader : private dds::DataReaderListener {
 public:
  BestEffortReader(const DdsSpec& dds, Count& count)
      : count_(count), domain_(dds, "bench_station best-effort", nullptr) {
    dds::DataReaderQos qos = sample_reader_qos(std::nullopt);
    qos.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
    (void)domain_.reader<idl::SamplePubSubType, ReceivedSampleType>(
        kSampleTopic, qos, this, dds::StatusMask::data_available());
  }

 private:
  void on_data_available(dds::DataReader* reader) override {
    dds::SampleInfo info;
    while (reader->take_next_sample(&received_, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data && received_.is_known) count_.add(received_.sample);
    }
  }
  Count& count_;
  ReceivedSample received_;
  Domain domain_;  // last: its threads use the members above
};

void run(unsigned domain, const std::string& way) {
  Count count;
  DdsSpec dds;
  dds.domain = domain;
  Station station(dds, "bench_station");
  station.subscribe_channels([&](const StationChannel&) { ++count.listed; });
  std::optional<BestEffortReader> reader;
  if (way == "best-effort") {
    reader.emplace(dds, count);
  } else {
    station.subscribe_samples(
        [&](const StationSample& sample) { count.add(sample); }, {},
        {.deadline = {}, .on_deadline_missed = {}, .one_by_one = way == "one-by-one"});
  }
  while (!stopped) {
    fmt::print("{} {} {} {} {}\n", count.samples.load(), count.missing.load(),
               count.channels.load(), count.listed.load(), station.block_counters().missing);
    std::fflush(stdout);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  const Arguments arguments(argc, argv);
  if (arguments.size() < 1) return 2;
  std::signal(SIGTERM, [](int) { stopped = true; });
  return run_bench("bench_station", [&] {
    lose(arguments.number_at(2, 0.0));
    run(arguments.number_at(0, 0u), arguments.text_at(1));
  });
}
