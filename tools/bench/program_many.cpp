// Many dialled-in modules on one bridge; half of them are programmed while it polls the others.
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>

#include <atomic>
#include <mutex>
#include <set>
#include <thread>

#include "bridge/station/station.hpp"
#include "core/codec/checksum.hpp"
#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/figures.hpp"
#include "tools/bench/support/program_net.hpp"

namespace fieldcast::bench {
namespace {

std::string name_of(int device) { return "m" + std::to_string(100 + device); }

std::string buses_of(int devices) {
  std::string text;
  for (int i = 0; i < devices; ++i) {
    text += fmt::format(
        "  - name: {0}\n"
        "    port: {{ dial-in: {0} }}\n"
        "    protocol: modbus-rtu\n"
        "    defaults: {{ refresh: 200ms, timeout: 500ms }}\n"
        "    devices:\n"
        "      - {{ name: plc, address: 1, channels: [ {{ name: a, at: \"holding:0\", type: uint16 "
        "}}, {{ name: b, at: \"holding:1\", type: uint16 }} ] }}\n",
        name_of(i));
  }
  return text;
}

// Respond to Modbus reads of unit 1, and echo frames that start with `@` like a PLC.
class Modules {
 public:
  Modules(std::uint16_t port, int count) {
    for (int i = 0; i < count; ++i) {
      sockets_.push_back(connect_to(port, 5));
      const std::string registration = name_of(i) + "\r\n";
      send_all(sockets_.back().get(),
               {reinterpret_cast<const std::uint8_t*>(registration.data()), registration.size()});
    }
    thread_ = std::thread([this] { serve(); });
  }
  ~Modules() {
    over_ = true;
    thread_.join();
  }

 private:
  void serve() {
    std::vector<pollfd> wait;
    for (const FileDescriptor& socket : sockets_) wait.push_back({socket.get(), POLLIN, 0});
    while (!over_) {
      ::poll(wait.data(), wait.size(), 50);
      for (pollfd& one : wait) {
        if (one.revents == 0) continue;
        const Bytes bytes = receive_some(one.fd, 4096);
        if (bytes.empty()) {
          one.fd = -1;
        } else if (bytes[0] == '@') {
          send_all(one.fd, bytes);
        } else if (bytes.size() >= 8 && bytes[1] == 3) {
          Bytes response{bytes[0], 3, static_cast<std::uint8_t>(2 * bytes[5])};
          for (int i = 0; i < bytes[5]; ++i) append_u16(response, static_cast<std::uint16_t>(i));
          append_crc16(response);
          send_all(one.fd, response);
        }
      }
    }
  }
  std::vector<FileDescriptor> sockets_;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

// Sends program bytes repeatedly; returns the number of correct echoes.
std::uint64_t program(int fd, const std::atomic<bool>& over) {
  Bytes frame;
  append_u32(frame, 512);
  frame.push_back('@');
  frame.resize(4 + 512, 'x');
  std::uint64_t rounds = 0;
  while (!over) {
    send_all(fd, frame);
    std::size_t received = 0;
    while (received < 512) {
      Bytes head;
      while (head.size() < 4) {
        const Bytes part = receive_some(fd, 4 - head.size());
        if (part.empty()) return rounds;
        append(head, part);
      }
      for (std::uint32_t left = read_u32(head); left > 0;) {
        const Bytes part = receive_some(fd, left);
        if (part.empty()) return rounds;
        left -= static_cast<std::uint32_t>(part.size());
        received += part.size();
      }
    }
    ++rounds;
  }
  return rounds;
}

}  // namespace

void many_bench(const ManyOptions& options) {
  ProgramBridge bridge(buses_of(options.devices));
  const Modules modules(bridge.modules(), options.devices);
  DdsSpec dds;
  dds.domain = bridge.domain();
  std::mutex mutex;
  std::set<std::string> good;                            // buses with a good sample
  std::map<std::string, std::uint64_t> samples, missed;  // by bus
  Station station(dds, "program_bench");
  station.subscribe_samples([&](const StationSample& sample) {
    const std::lock_guard lock(mutex);
    if (sample.quality != Quality::kGood) return;
    good.insert(sample.bus);
    ++samples[sample.bus];
  });
  station.subscribe_bus_status([&](const StationBusStatus& status) {
    const std::lock_guard lock(mutex);
    missed[status.bus] = status.report.deadline_misses;
  });
  const auto start = Clock::now();
  const auto all_good = [&] {
    const std::lock_guard lock(mutex);
    return good.size() == static_cast<std::size_t>(options.devices);
  };
  while (!all_good() && seconds_since(start) < 60)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  print_figure("modules whose data is collected", good.size(), "",
               std::to_string(options.devices).c_str());
  print_figure("after", seconds_since(start), "s");

  std::vector<FileDescriptor> clients;
  for (int i = 0; i < options.pairings; ++i)
    clients.push_back(paired_client(bridge.engineers(), name_of(i)));
  std::this_thread::sleep_for(std::chrono::seconds(2));  // until the previous status has arrived
  std::map<std::string, std::uint64_t> samples_before, missed_before;
  {
    const std::lock_guard lock(mutex);
    samples_before = samples;
    missed_before = missed;
  }
  std::atomic<bool> over{false};
  std::atomic<std::uint64_t> rounds{0};
  std::vector<std::thread> threads;
  for (const FileDescriptor& client : clients)
    threads.emplace_back([&rounds, &over, fd = client.get()] { rounds += program(fd, over); });
  const double cpu = bridge.process().cpu_seconds();
  const auto began = Clock::now();
  let_run(options.seconds);
  over = true;
  for (std::thread& thread : threads) thread.join();
  const double took = seconds_since(began);
  let_run(1);

  std::uint64_t others = 0, others_missed = 0, leased = 0;
  const std::lock_guard lock(mutex);
  for (int i = 0; i < options.devices; ++i) {
    const std::string bus = name_of(i);
    const std::uint64_t more = samples[bus] - samples_before[bus];
    if (i < options.pairings) {
      leased += more;
    } else {
      others += more;
      others_missed += missed[bus] - missed_before[bus];
    }
  }
  const int collecting = options.devices - options.pairings;
  print_figure("simultaneous pairings", clients.size(), "",
               std::to_string(options.pairings).c_str());
  print_figure("program bytes, all pairings, both ways",
               2 * 512 * static_cast<double>(rounds) / took / 1e6, "MB/s");
  print_figure("samples of each collected channel",
               static_cast<double>(others) / took / (2.0 * collecting), "/s",
               ">= 5 (refresh 200 ms)");
  print_figure("refreshes missed by collected buses", others_missed, "", "0");
  print_figure("good samples of leased buses", leased, "", "0");
  print_figure("bridge: processor", (bridge.process().cpu_seconds() - cpu) / took * 100,
               "% of one");
  print_figure("bridge: memory", bridge.process().resident_mb(), "MB");
}

}  // namespace fieldcast::bench
