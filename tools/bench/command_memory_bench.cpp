// Measures memory over very many commands: a station sends, a bridge in another process responds
// immediately. Every command is a DDS instance that both sides must release. Prints the memory of
// both after each tenth; it must stay constant.
//
// usage: command_memory_bench [COMMANDS (200000)]
#include <sys/prctl.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <mutex>
#include <stdexcept>
#include <string>

#include "bridge/dds/endpoints/dds_link.hpp"
#include "bridge/station/station.hpp"
#include "tools/bench/plant/plant.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::bench {
namespace {

constexpr std::uint64_t kInFlight = 256;
constexpr std::chrono::seconds kWait{30};  // for one result; reached only on a fault
constexpr const char* kBus = "bus";
constexpr const char* kAsBridge = "--bridge";  // starts the bridge process; followed by the domain

UtcMapping both_clocks() {
  const auto steady = std::chrono::steady_clock::now().time_since_epoch();
  const auto utc = std::chrono::system_clock::now().time_since_epoch();
  return {Instant{steady}, {std::chrono::duration_cast<std::chrono::nanoseconds>(utc).count()}};
}

CommandResult done(const Command& command) {
  CommandResult result;
  result.requester = command.requester;
  result.request_id = command.request_id;
  result.state = CommandState::kDone;
  result.received = result.started = result.completed = both_clocks().instant;
  return result;
}

// A bridge that executes commands immediately, until SIGTERM.
void run_bridge(const DdsSpec& spec) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // ends with the parent, whatever the state of the library is
  sigset_t ending;
  sigemptyset(&ending);
  sigaddset(&ending, SIGTERM);
  sigprocmask(SIG_BLOCK, &ending, nullptr);  // before other threads start
  DdsLink* self = nullptr;
  DdsLink link(
      spec, "bench",
      {.clock = both_clocks,
       .on_command = [&](const std::string& bus, const Command& command,
                         const std::string&) { self->complete(bus, done(command), both_clocks()); },
       .on_interest = [](const Interest&) {},
       .on_problem =
           [](const std::string& text) { std::fprintf(stderr, "bridge: %s\n", text.c_str()); },
       .bridges = {.found = [](const std::string&) {},
                   .received = [](const std::string&, const BridgeClaims&) {},
                   .alive = [](const std::string&, bool) {},
                   .lost = [](const std::string&) {}}});
  self = &link;
  BusSpec bus;
  bus.name = kBus;
  link.add_bus(bus);  // commands arrive from here on
  link.announce({.bridge = "bench", .buses = {{kBus, {.since = {1}, .serving = true}}}});
  int signal = 0;
  sigwait(&ending, &signal);
}

void run_station(const DdsSpec& spec, std::uint64_t commands, const Process& bridge) {
  Station station(spec, "command-memory-bench");
  std::mutex mutex;
  std::condition_variable arrived;
  std::uint64_t results = 0;
  station.on_result([&](const StationResult&) {
    const std::lock_guard lock(mutex);
    ++results;
    arrived.notify_one();
  });
  const auto await = [&](std::uint64_t wanted) {
    std::unique_lock lock(mutex);
    if (!arrived.wait_for(lock, kWait, [&] { return results >= wanted; }))
      throw std::runtime_error(std::to_string(results) + " results where " +
                               std::to_string(wanted) + " were due");
  };
  std::printf("%12s %12s %16s %16s\n", "commands", "seconds", "station, MB", "bridge, MB");
  ProgressLine progress(std::cerr);
  const auto began = std::chrono::steady_clock::now();
  const std::uint64_t tenth = std::max<std::uint64_t>(1, commands / 10);
  for (std::uint64_t sent = 1; sent <= commands; ++sent) {
    StationCommand command;
    command.bus = kBus;
    command.command.device = "device";
    command.command.target = ChannelTarget{"channel"};
    command.command.values = {Value{sent}};
    if (const auto id = station.send(std::move(command)); !id)
      throw std::runtime_error(std::string(to_text(id.error())));
    if (sent > kInFlight) await(sent - kInFlight);
    progress.show([&](Duration elapsed) {
      return progress_text("commands", static_cast<double>(sent) / static_cast<double>(commands),
                           elapsed);
    });
    if (sent % tenth != 0 && sent != commands) continue;
    await(sent);
    progress.clear();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;
    std::printf("%12llu %12.1f %16.1f %16.1f\n", static_cast<unsigned long long>(sent),
                seconds.count(), resident_mb(getpid()), bridge.resident_mb());
    std::fflush(stdout);
  }
}

void run(int argc, char** argv) {
  DdsSpec spec;
  if (argc == 3 && std::string(argv[1]) == kAsBridge) {
    spec.domain = static_cast<std::uint32_t>(std::strtoul(argv[2], nullptr, 10));
    return run_bridge(spec);
  }
  const std::uint64_t commands = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 200'000;
  spec.domain = own_domain();
  const ScratchFolder scratch;
  const Process bridge("command_memory_bench", {kAsBridge, std::to_string(spec.domain)},
                       scratch.path() + "/bridge.log");
  run_station(spec, commands, bridge);
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  try {
    fieldcast::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "command_memory_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
