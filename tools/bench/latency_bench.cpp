// How long a value takes from the last byte of an answer on the serial line to the callback of a
// reader in another process.
//
// This process is the device (the far end of a pseudo-terminal) and the station; the bridge is
// another process. Every register of an answer carries a running number, so each callback knows
// when its answer's last byte was handed to the line.
//
// usage: latency_bench [--seconds N]
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "bridge/station/station.hpp"
#include "core/base/bytes.hpp"
#include "core/codec/checksum.hpp"
#include "tools/bench/figures.hpp"
#include "tools/bench/process.hpp"

namespace fieldcast::bench {
namespace {

using Clock = std::chrono::steady_clock;

// A unit that answers every read after 2 ms with registers that all hold the answer's running
// number.
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

  // When the answer of this number was handed over.
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
      Bytes answer{request[0], request[1], static_cast<std::uint8_t>(2 * count)};
      request.clear();
      ++number;
      for (unsigned i = 0; i < count; ++i) append_u16(answer, number);
      const std::uint16_t crc = crc16_modbus(answer);
      answer.push_back(static_cast<std::uint8_t>(crc));
      answer.push_back(static_cast<std::uint8_t>(crc >> 8));
      std::this_thread::sleep_for(
          std::chrono::milliseconds(2));  // the device's own time, not a way to wait
      handed_over_[number] = Clock::now();
      if (write(line_, answer.data(), answer.size()) < 0) return;
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
  std::string text =
      "bridge: latency\ndds: { domain: " + std::to_string(domain) +
      ", interfaces: [127.0.0.1] }\nbuses:\n  - name: bus\n    port: { serial: " + link +
      ", baud: 115200, format: 8N1 }\n    protocol: modbus-rtu\n    defaults: { refresh: 100ms, "
      "mode: intensive }\n" +
      "    devices:\n      - name: unit\n        address: 1\n        channels:\n";
  for (int i = 0; i < channels; ++i)
    text += "          - { name: c" + std::to_string(i) + ", at: \"holding:" + std::to_string(i) +
            "\", type: uint16 }\n";
  return text;
}

void measure(int channels, double seconds) {
  const ScratchFolder folder;
  const std::string link = folder.path() + "/bus";
  CountingDevice device(link);
  const unsigned domain = own_domain();
  const std::string file = folder.write("bridge.yaml", configuration(link, domain, channels));

  std::mutex lock;
  std::vector<double> microseconds;
  bool counting = false;
  DdsSpec dds;
  dds.domain = domain;
  Station station(dds, "latency_bench");
  station.subscribe_samples([&](const StationSample& sample) {
    const auto now = Clock::now();
    const auto* number = std::get_if<std::uint64_t>(&sample.value);
    if (!number || sample.quality != Quality::kGood) return;
    const std::chrono::duration<double, std::micro> passed =
        now - device.handed_over(static_cast<std::uint16_t>(*number));
    const std::lock_guard guard(lock);
    if (counting) microseconds.push_back(passed.count());
  });
  Process bridge("fieldcast-bridge", {file}, folder.path() + "/bridge.log");
  std::this_thread::sleep_for(
      std::chrono::seconds(2));  // discovery and first rounds are not what is measured
  {
    const std::lock_guard guard(lock);
    counting = true;
  }
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  const std::lock_guard guard(lock);
  counting = false;
  std::printf("block of %d channels, %zu samples\n", channels, microseconds.size());
  print_figure("  last byte to callback, median", quantile(microseconds, 0.5) / 1000, "ms",
               "goal < 0.2 (peer over MQTT 0.23-0.40)");
  print_figure("  last byte to callback, 99th percentile", quantile(microseconds, 0.99) / 1000,
               "ms", "goal < 1 (peer 0.5-1.0)");
  if (microseconds.empty()) throw std::runtime_error("no sample arrived");
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  const double seconds =
      argc > 2 && std::strcmp(argv[1], "--seconds") == 0 ? std::atof(argv[2]) : 8;
  try {
    for (const int channels : {1, 10, 100}) fieldcast::bench::measure(channels, seconds);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "latency_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
