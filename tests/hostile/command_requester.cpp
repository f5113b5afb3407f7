// Sends reads on demand at a constant rate for some seconds, and prints one line of JSON: sent,
// done, refused by a full queue, others, and the time to a result in milliseconds (median and
// longest of those that are done).
//
// usage: command_requester DOMAIN PACE_US SECONDS BUS DEVICE CHANNEL
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "bridge/station/station.hpp"

namespace fieldcast {
namespace {

using Clock = std::chrono::steady_clock;

struct Seen {
  std::mutex mutex;
  std::map<std::uint64_t, Clock::time_point> sent;
  std::vector<double> milliseconds;
  std::uint64_t done = 0, full = 0, others = 0;
};

void run(char** argv) {
  DdsSpec spec;
  spec.domain = static_cast<std::uint32_t>(std::strtoul(argv[1], nullptr, 10));
  const std::chrono::microseconds pace{std::strtol(argv[2], nullptr, 10)};
  const std::chrono::seconds lasts{std::strtol(argv[3], nullptr, 10)};
  Seen seen;
  Station station(spec, "command-requester");
  station.on_result([&](const StationResult& result) {
    const std::lock_guard lock(seen.mutex);
    const auto sent = seen.sent.extract(result.request_id);
    if (result.state != CommandState::kDone) {
      (result.cause == to_name(Cause::kQueueFull) ? seen.full : seen.others) += 1;
      return;
    }
    ++seen.done;
    if (sent.empty()) return;
    const std::chrono::duration<double, std::milli> taken = Clock::now() - sent.mapped();
    seen.milliseconds.push_back(taken.count());
  });
  std::uint64_t count = 0;
  const auto begun = Clock::now();
  for (auto next = begun; next < begun + lasts; next += pace, ++count) {
    std::this_thread::sleep_until(next);
    StationCommand command;
    command.bus = argv[4];
    command.command.device = argv[5];
    command.command.target = ChannelTarget{argv[6]};
    command.command.operation = Operation::kAcquire;
    const std::lock_guard lock(seen.mutex);
    if (const auto id = station.send(std::move(command))) seen.sent[*id] = Clock::now();
  }
  std::this_thread::sleep_for(std::chrono::seconds{6});  // the lifespan of the last ones
  const std::lock_guard lock(seen.mutex);
  std::sort(seen.milliseconds.begin(), seen.milliseconds.end());
  const auto at = [&](double share) {
    if (seen.milliseconds.empty()) return 0.0;
    return seen.milliseconds[static_cast<std::size_t>(
        share * static_cast<double>(seen.milliseconds.size() - 1))];
  };
  std::printf(
      "{\"sent\": %llu, \"done\": %llu, \"full\": %llu, \"others\": %llu, "
      "\"median_ms\": %.1f, \"longest_ms\": %.1f}\n",
      static_cast<unsigned long long>(count), static_cast<unsigned long long>(seen.done),
      static_cast<unsigned long long>(seen.full), static_cast<unsigned long long>(seen.others),
      at(0.5), at(1));
}

}  // namespace
}  // namespace fieldcast

int main(int argc, char** argv) {
  if (argc != 7) {
    std::fprintf(stderr, "usage: command_requester DOMAIN PACE_US SECONDS BUS DEVICE CHANNEL\n");
    return 2;
  }
  try {
    fieldcast::run(argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "command_requester: %s\n", error.what());
    return 1;
  }
  return 0;
}
