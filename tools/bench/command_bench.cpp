// Sends 1 000 writes while the line is read at full load. Checks that each has one result and
// reaches the device once; compares the time to a result with the time of one block.
#include <chrono>
#include <condition_variable>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"

namespace fieldcast::bench {
namespace {

constexpr int kWrites = 1000;
constexpr int kDevices = 3;
constexpr int kRegisters = 100;

std::string buses() {
  return serial_bus("bus", 115200, "refresh: 1s, mode: intensive, silence: 3.5c",
                    scattered_devices(kDevices, kRegisters, 5));
}

struct Results {
  std::mutex lock;
  std::condition_variable arrived;
  std::map<std::uint64_t, Clock::time_point> sent;
  std::map<std::uint64_t, int> count;
  std::vector<double> milliseconds;
  int done = 0;
};

std::uint64_t executed_writes(const std::string& report_path) {
  std::ifstream file(report_path);
  const auto report = nlohmann::json::parse(file);
  std::uint64_t writes = 0;
  for (const auto& bus : report.at("buses"))
    for (const auto& device : bus.at("devices"))
      writes += device.at("write_requests").get<std::uint64_t>();
  return writes;
}

void run() {
  Plant plant(buses());
  const std::string report = plant.folder().path() + "/report.json";
  plant.start_simulator({"--report", report});
  plant.listen();
  plant.start_bridge();
  plant.wait_until_seen(kDevices * kRegisters, 20);
  let_run(2);

  Results results;
  plant.station().on_result([&](const StationResult& result) {
    const auto now = Clock::now();
    const std::lock_guard guard(results.lock);
    ++results.count[result.request_id];
    results.done += result.state == CommandState::kDone;
    const auto sent = results.sent.find(result.request_id);
    if (sent != results.sent.end())
      results.milliseconds.push_back(
          std::chrono::duration<double, std::milli>(now - sent->second).count());
    results.arrived.notify_one();
  });
  const auto before = plant.buses().at("bus").report;
  const auto began = Clock::now();
  std::mt19937 random(3);
  for (int i = 0; i < kWrites; ++i) {
    StationCommand command{"bus", {}, std::chrono::seconds{5}};
    command.command.device = "unit-" + std::to_string(1 + i % kDevices);
    command.command.target = ChannelTarget{"r" + std::to_string(random() % kRegisters)};
    command.command.values = {Value{std::uint64_t{random() % 65536}}};
    std::unique_lock guard(results.lock);
    const auto sent = Clock::now();
    const auto id = plant.station().send(std::move(command));
    if (!id)
      throw std::runtime_error("a command could not be sent: " + std::string(to_text(id.error())));
    results.sent[*id] = sent;
    guard.unlock();
    // not synchronous with the blocks
    let_run(0.010 + 0.00002 * static_cast<double>(random() % 1000));
  }
  std::unique_lock guard(results.lock);
  results.arrived.wait_for(guard, std::chrono::seconds(10),
                           [&] { return results.count.size() >= kWrites; });
  guard.unlock();
  let_run(1.5);  // waits for duplicate results and the final status
  const double wall = seconds_since(began);
  const auto after = plant.buses().at("bus").report;
  plant.stop_bridge();
  plant.stop_simulator();

  guard.lock();
  int total = 0;
  for (const auto& [id, count] : results.count) total += count;
  const double reads = static_cast<double>(after.exchanges - before.exchanges) - kWrites;
  const double block_ms = 1000 * wall / std::max(1.0, reads);
  print_figure("commands sent", kWrites);
  print_figure("results", total, "", "goal 1000");
  print_figure("results 'done'", results.done, "", "goal 1000");
  print_figure("writes executed by the devices", executed_writes(report), "", "goal 1000");
  print_figure("time of one block at full load", block_ms, "ms");
  print_figure("time to result, median", quantile(results.milliseconds, 0.5), "ms",
               "goal < two block times");
  print_figure("time to result, median, in block times",
               quantile(results.milliseconds, 0.5) / block_ms, "", "goal < 2");
  print_figure("time to result, 99th percentile", quantile(results.milliseconds, 0.99), "ms");
}

}  // namespace
}  // namespace fieldcast::bench

int main() { return fieldcast::bench::run_bench("command_bench", fieldcast::bench::run); }
