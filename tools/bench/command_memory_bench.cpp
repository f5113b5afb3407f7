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
#include <iostream>
#include <mutex>
#include <stdexcept>
#include <string>

#include "bridge/base/clock.hpp"
#include "bridge/dds/endpoints/dds_link.hpp"
#include "bridge/station/station.hpp"
#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::bench {
namespace {

constexpr std::uint64_t kInFlight = 256;
constexpr std::chrono::seconds kWait{30};  // for one result; reached only on a fault
constexpr const char* kBus = "bus";
constexpr const char* kAsBridge = "--bridge";  // starts the bridge process; followed by the domain

CommandResult done(const Command& command) {
  CommandResult result;
  result.requester = command.requester;
  result.request_id = command.request_id;
  result.state = CommandState::kDone;
  result.received = result.started = result.completed = read_clocks().instant;
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
      {.clock = read_clocks,
       .on_command = [&](const std::string& bus, const Command& command,
                         const std::string&) { self->complete(bus, done(command), read_clocks()); },
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
  const auto began = Clock::now();
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
    std::printf("%12llu %12.1f %16.1f %16.1f\n", static_cast<unsigned long long>(sent),
                seconds_since(began), resident_mb(getpid()), bridge.resident_mb());
    std::fflush(stdout);
  }
}

void run(const Arguments& arguments) {
  DdsSpec spec;
  spec.domain = arguments.number(kAsBridge, own_domain());
  if (arguments.has(kAsBridge)) return run_bridge(spec);
  const ScratchFolder scratch;
  const Process bridge("command_memory_bench", {kAsBridge, std::to_string(spec.domain)},
                       scratch.path() + "/bridge.log");
  run_station(spec, arguments.number_at(0, std::uint64_t{200'000}), bridge);
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  return run_bench("command_memory_bench", argc, argv, run);
}
