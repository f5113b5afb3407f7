// Measures the time from the last byte of a response on the serial line to the first and last
// callback of a reader in another process. In the same run, measures a bare Fast DDS writer and
// reader with the same data, so that the ratio is independent of the machine's load.
//
// This process is the device (the peer of a pseudo-terminal) and the station; the bridge is a
// second process. Every register of a response contains a running number, which gives each callback
// the send time of its response.
//
// usage: latency_bench [--seconds N]
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "bridge/station/station.hpp"
#include "core/base/bytes.hpp"
#include "core/codec/checksum.hpp"
#include "tools/bench/plant/bare.hpp"
#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"

namespace fieldcast::bench {
namespace {

// A unit that responds to every read after 2 ms; all registers contain the response's number.
class CountingDevice {
 public:
  explicit CountingDevice(const std::string& link) : link_(link), handed_over_(65536) {
    char name[128];
    if (openpty(&line_, &far_end_, name, nullptr, nullptr) != 0)
      throw std::runtime_error("no pseudo-terminal");
    termios raw{};
    tcgetattr(far_end_, &raw);
    cfmakeraw(&raw);
    tcsetattr(far_end_, TCSANOW, &raw);
    std::filesystem::create_symlink(name, link_);
    thread_ = std::thread([this] { run(); });
  }
  ~CountingDevice() {
    stop_ = true;
    thread_.join();
    std::filesystem::remove(link_);
    close(line_);
    close(far_end_);
  }
  CountingDevice(const CountingDevice&) = delete;
  CountingDevice& operator=(const CountingDevice&) = delete;

  [[nodiscard]] Clock::time_point handed_over(std::uint16_t number) const {
    return handed_over_[number].load();
  }

 private:
  void run() {
    Bytes request;
    std::uint16_t number = 0;
    while (!stop_) {
      pollfd readable{line_, POLLIN, 0};
      if (poll(&readable, 1, 50) <= 0) continue;
      std::uint8_t buffer[64];
      const auto got = read(line_, buffer, sizeof buffer);
      if (got <= 0) continue;
      request.insert(request.end(), buffer, buffer + got);
      if (request.size() < 8) continue;
      const unsigned count = read_u16(request, 4);
      Bytes response{request[0], request[1], static_cast<std::uint8_t>(2 * count)};
      request.clear();
      ++number;
      for (unsigned i = 0; i < count; ++i) append_u16(response, number);
      append_crc16(response);
      std::this_thread::sleep_for(
          std::chrono::milliseconds(2));  // simulated response time, not a wait
      handed_over_[number] = Clock::now();
      if (write(line_, response.data(), response.size()) < 0) return;
    }
  }

  std::string link_;
  int line_ = -1;
  int far_end_ = -1;
  std::vector<std::atomic<Clock::time_point>> handed_over_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

std::string configuration(const std::string& link, unsigned domain, int channels) {
  std::string list;
  for (int i = 0; i < channels; ++i)
    list += fmt::format("          - {{ name: c{0}, at: \"holding:{0}\", type: uint16 }}\n", i);
  return fmt::format(
      "bridge: latency\n"
      "dds: {{ domain: {}, interfaces: [127.0.0.1] }}\n"
      "buses:\n"
      "  - name: bus\n"
      "    port: {{ serial: {}, baud: 115200, format: 8N1 }}\n"
      "    protocol: modbus-rtu\n"
      "    defaults: {{ refresh: 100ms, mode: intensive }}\n"
      "    devices:\n"
      "      - name: unit\n"
      "        address: 1\n"
      "        channels:\n{}",
      domain, link, list);
}

using Figures = BlockTimes::Figures;

Figures bridge_times(int channels, double seconds, bool one_by_one) {
  const ScratchFolder folder;
  const std::string link = folder.path() + "/bus";
  CountingDevice device(link);
  const unsigned domain = own_domain();
  const std::string file = folder.write("bridge.yaml", configuration(link, domain, channels));

  BlockTimes times(static_cast<std::size_t>(channels));
  DdsSpec dds;
  dds.domain = domain;
  Station station(dds, "latency_bench");
  station.subscribe_samples(
      [&](const StationSample& sample) {
        const auto now = Clock::now();
        const auto* number = std::get_if<std::uint64_t>(&sample.value);
        if (!number || sample.quality != Quality::kGood) return;
        times.add(*number, device.handed_over(static_cast<std::uint16_t>(*number)), now);
      },
      {}, {.deadline = {}, .on_deadline_missed = {}, .one_by_one = one_by_one});
  const Process bridge("fieldcast-bridge", {file}, folder.path() + "/bridge.log");
  let_run(2);  // excludes discovery and the first rounds
  times.start();
  let_run(seconds);
  const Figures figures = times.stop();
  if (figures.blocks == 0) throw std::runtime_error("no block arrived whole");
  return figures;
}

// A bare writer in another process at the rate of the bridge.
Figures bare_times(BareData data, int channels, double seconds, double blocks_a_second) {
  const ScratchFolder folder;
  const unsigned domain = own_domain();
  BlockTimes times(static_cast<std::size_t>(channels));
  const BareReader reader(domain, data, [&](const BareReader::Row& row) {
    times.add(row.number, row.written, Clock::now());
  });
  const std::string rows = std::to_string(channels);
  const auto period = static_cast<int>(1e6 / blocks_a_second);
  const Process writer("bench_bare",
                       {std::to_string(domain), data == BareData::kBlocks ? "blocks" : "samples",
                        "write", rows, rows, std::to_string(period)},
                       folder.path() + "/bare.log");
  let_run(2);
  times.start();
  let_run(seconds);
  const Figures figures = times.stop();
  if (figures.blocks == 0) throw std::runtime_error("the bare reader got no block whole");
  return figures;
}

void print_times(const char* what, const Figures& figures) {
  std::printf("  %s, %zu blocks\n", what, figures.blocks);
  print_figure("    to the first callback, median", figures.first, "ms");
  print_figure("    to the first callback, 99th percentile", figures.first_p99, "ms");
  print_figure("    to the last callback, median", figures.last, "ms");
  print_figure("    to the last callback, 99th percentile", figures.last_p99, "ms");
}

void print_ratio(const char* what, const Figures& figures, const Figures& other,
                 const char* goal_median = "", const char* goal_p99 = "") {
  const std::string text = std::string("    last callback, of ") + what;
  print_figure(text + ", median", figures.last / other.last, "", goal_median);
  print_figure(text + ", p99", figures.last_p99 / other.last_p99, "", goal_p99);
}

void measure(double seconds) {
  std::optional<Figures> single;  // the first measurement
  for (const int channels : {1, 10, 100}) {
    std::printf("block of %d channels\n", channels);
    const Figures blocks = bridge_times(channels, seconds, false);
    if (!single) single = blocks;
    const double a_second = static_cast<double>(blocks.blocks) / seconds;
    const Figures bare_blocks = bare_times(BareData::kBlocks, channels, seconds, a_second);
    const Figures one_by_one = bridge_times(channels, seconds, true);
    const Figures bare_samples = bare_times(BareData::kSamples, channels, seconds, a_second);
    print_times("last byte to a station that takes blocks", blocks);
    print_ratio("a single sample's", blocks, *single, "goal <= 1.3 (100)", "goal <= 1.5 (100)");
    print_ratio("the bare message's", blocks, bare_blocks);
    print_times("last byte to a station that takes samples one by one", one_by_one);
    print_ratio("the bare samples'", one_by_one, bare_samples);
    print_times("bare: write of one unkeyed message", bare_blocks);
    print_times("bare: write of the keyed samples one by one", bare_samples);
  }
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  return run_bench("latency_bench", argc, argv,
                   [](const Arguments& arguments) { measure(arguments.number("--seconds", 5.0)); });
}
