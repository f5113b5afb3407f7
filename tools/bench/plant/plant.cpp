#include "tools/bench/plant/plant.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <thread>

#include "bridge/base/file_descriptor.hpp"
#include "tools/progress/progress_line.hpp"

extern char** environ;

namespace fieldcast::bench {

namespace {

std::string path_of(const std::string& program) {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / program).string();
}

}  // namespace

bool has_program(const std::string& program) { return std::filesystem::exists(path_of(program)); }

Process::Process(const std::string& program, const std::vector<std::string>& arguments,
                 const std::string& log_path) {
  const std::string path = path_of(program);
  // The child ends with the bench, even if that is killed, so no bridge keeps its buses.
  std::vector<std::string> words{"setpriv", "--pdeathsig", "TERM", "--", path};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log_path.c_str(),
                                   O_WRONLY | O_CREAT | O_APPEND, 0600);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  const int failed = posix_spawnp(&id_, words[0].c_str(), &files, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (failed != 0) throw std::runtime_error("cannot start " + path);
}

Process::~Process() { stop(); }

void Process::stop() {
  if (id_ <= 0) return;
  kill(id_, SIGTERM);
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (waitpid(id_, nullptr, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > patience) kill(id_, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  id_ = -1;
}

double Process::cpu_seconds() const {
  std::ifstream file("/proc/" + std::to_string(id_) + "/stat");
  std::string text((std::istreambuf_iterator<char>(file)), {});
  std::istringstream fields(text.substr(text.rfind(')') + 2));
  std::string skipped;
  // proc(5): state is the third field, utime the 14th.
  for (int i = 0; i < 11; ++i) fields >> skipped;
  double user = 0, system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

double Process::resident_mb() const { return bench::resident_mb(id_); }

double resident_mb(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("VmRSS:", 0) == 0) return std::stod(line.substr(6)) / 1024;
  }
  return 0;
}

double process_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::uint16_t free_port() {
  constexpr unsigned kLowest = 20000, kCount = 12000;
  static unsigned next = static_cast<unsigned>(getpid()) * 7;
  for (unsigned i = 0; i < kCount; ++i) {
    const auto port = static_cast<std::uint16_t>(kLowest + next++ % kCount);
    const FileDescriptor fd(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const sockaddr_in address = loopback(port);
    if (::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
      return port;
  }
  throw std::runtime_error("every port from 20000 to 31999 is in use");
}

ScratchFolder::ScratchFolder() {
  std::string pattern =
      (std::filesystem::temp_directory_path() / "fieldcast-bench-XXXXXX").string();
  if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
  path_ = pattern;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  held_ = ends[1];
  // A separate session, because Ctrl-C reaches the process group. It removes twice, because other
  // programs may still write while they end.
  const char* const script = "cat; rm -rf -- \"$0\" 2>/dev/null || { sleep 2; rm -rf -- \"$0\"; }";
  const char* const argv[] = {"sh", "-c", script, path_.c_str(), nullptr};
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, ends[0], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  const int failed =
      posix_spawnp(&remover_, "sh", &files, &attributes, const_cast<char* const*>(argv), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  close(ends[0]);
  if (failed != 0) throw std::runtime_error("cannot start sh");
}

ScratchFolder::~ScratchFolder() {
  close(held_);
  waitpid(remover_, nullptr, 0);
}

std::string ScratchFolder::write(const std::string& name, const std::string& text) const {
  const std::string path = path_ + '/' + name;
  std::ofstream(path) << text;
  return path;
}

bool wait_for_path(const std::string& path, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!std::filesystem::exists(path)) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

bool wait_for_text(const std::string& path, const std::string& text, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (true) {
    std::ifstream file(path);
    const std::string all((std::istreambuf_iterator<char>(file)), {});
    if (all.find(text) != std::string::npos) return true;
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

unsigned own_domain() { return 100 + static_cast<unsigned>(getpid()) % 100; }

namespace {

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

}  // namespace

Plant::Plant(const std::string& buses, const std::string& faults, const std::string& more) {
  dds_.domain = own_domain();
  config_ =
      folder_.write("bridge.yaml", "bridge: bench\ndds: { domain: " + std::to_string(dds_.domain) +
                                       ", interfaces: [127.0.0.1] }\n" + more + "buses:\n" +
                                       replaced(buses, "{dir}", folder_.path()));
  constexpr std::string_view kLink = "serial: {dir}/";
  for (std::size_t at = 0; (at = buses.find(kLink, at)) != std::string::npos;) {
    at += kLink.size();
    links_.push_back(link(buses.substr(at, buses.find(',', at) - at)));
  }
  if (!faults.empty()) faults_ = folder_.write("faults.yaml", faults);
}

void Plant::start_simulator(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{config_};
  if (!faults_.empty()) arguments.insert(arguments.end(), {"--faults", faults_});
  arguments.insert(arguments.end(), more.begin(), more.end());
  simulator_ = std::make_unique<Process>("fieldcast-sim", arguments, folder_.path() + "/sim.log");
  for (const std::string& path : links_) {
    if (!wait_for_path(path, 10)) throw std::runtime_error("the simulator made no link " + path);
  }
}

void Plant::start_bridge(const std::string& program) {
  {
    const std::lock_guard guard(lock_);
    seen_.clear();  // of the previous bridge
  }
  bridge_ = std::make_unique<Process>(program, std::vector<std::string>{config_},
                                      folder_.path() + "/bridge.log");
}

void Plant::listen_to_status() {
  if (station_) return;
  station_ = std::make_unique<Station>(dds_, "bench");
  station_->subscribe_bus_status([this](const StationBusStatus& status) {
    const std::lock_guard guard(lock_);
    buses_[status.bus] = status;
  });
  station_->subscribe_device_status([this](const StationDeviceStatus& status) {
    const std::lock_guard guard(lock_);
    devices_[status.bus + '/' + status.device] = status;
  });
}

void Plant::listen() {
  listen_to_status();
  if (listening_) return;
  listening_ = true;
  station_->subscribe_samples([this](const StationSample& sample) {
    const std::lock_guard guard(lock_);
    Seen& seen = seen_[sample.bus + '/' + sample.device + '/' + sample.channel];
    if (sample.quality != Quality::kGood) {
      ++seen.bad;
      return;
    }
    const std::int64_t at = sample.acquired_at.nanoseconds;
    if (seen.last_acquired > 0) {
      seen.longest_gap = std::max(seen.longest_gap, at - seen.last_acquired);
      seen.shortest_gap = std::min(seen.shortest_gap, at - seen.last_acquired);
    }
    ++seen.samples;
    seen.last_acquired = at;
  });
}

void Plant::forget_samples() {
  const std::lock_guard guard(lock_);
  // A gap that is open at the mark counts completely.
  for (auto& [name, seen] : seen_) seen = Seen{.last_acquired = seen.last_acquired};
}

void Plant::wait_until_seen(std::size_t channels, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  std::size_t good = 0;
  while (std::chrono::steady_clock::now() < end) {
    good = 0;
    for (const auto& [name, seen] : this->seen()) good += seen.samples > 0;
    if (good >= channels) return;
    let_run(0.05);
  }
  throw std::runtime_error("only " + std::to_string(good) + " of " + std::to_string(channels) +
                           " channels had a good sample; see " + folder_.path());
}

void let_run(double seconds) {
  using Seconds = std::chrono::duration<double>;
  constexpr Seconds kStep{0.2};
  const auto began = std::chrono::steady_clock::now();
  ProgressLine progress(std::cerr);
  for (Seconds left{seconds}; left > Seconds{};) {
    // without a terminal, avoids wake-ups during the measurement
    std::this_thread::sleep_for(progress.seen() ? std::min(left, kStep) : left);
    left = Seconds{seconds} - Seconds{std::chrono::steady_clock::now() - began};
    progress.show([&](Duration elapsed) {
      return progress_text("measuring", 1 - left.count() / seconds, elapsed);
    });
  }
}

namespace {

// `first` is the address of register 0, `step(r)` the distance from register r to r + 1.
std::string devices_of(int devices, int registers, const auto& first, const auto& step) {
  std::string text;
  for (int d = 1; d <= devices; ++d) {
    text += fmt::format("      - name: unit-{0}\n        address: {0}\n        channels:\n", d);
    unsigned long address = first();
    for (int r = 0; r < registers; address += step(r), ++r)
      text += fmt::format(
          "          - {{ name: r{}, at: \"holding:{}\", type: uint16, access: read-write }}\n", r,
          address);
  }
  return text;
}

}  // namespace

std::string serial_bus(const std::string& name, unsigned baud, const std::string& defaults,
                       const std::string& devices, const char* format) {
  return fmt::format(
      "  - name: {0}\n"
      "    port: {{ serial: {{dir}}/{0}, baud: {1}, format: {2} }}\n"
      "    protocol: modbus-rtu\n"
      "    defaults: {{ {3} }}\n"
      "    devices:\n{4}",
      name, baud, format, defaults, devices);
}

std::string scattered_devices(int devices, int registers, unsigned seed) {
  std::mt19937 random(seed);
  // Mostly close addresses, sometimes a gap that no read should include.
  return devices_of(
      devices, registers, [&] { return random() % 50; },
      [&](int) { return random() % 20 == 0 ? 30 + random() % 100 : 1 + random() % 4; });
}

std::string packed_devices(int devices, int registers, int run) {
  return devices_of(
      devices, registers, [] { return 0UL; },
      [run](int r) { return (r + 1) % run == 0 ? 201UL : 1UL; });
}

}  // namespace fieldcast::bench
