#include "tools/sim/plant_loop.hpp"

#include <fmt/format.h>
#include <sys/epoll.h>
#include <sys/signalfd.h>
#include <sys/timerfd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <fstream>

#include "core/base/json.hpp"

namespace fieldcast::sim {

Instant now() {
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return Instant{Duration{static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec}};
}

PlantLoop::PlantLoop(const std::vector<std::unique_ptr<SimBus>>& buses, LoopOptions options)
    : buses_(buses),
      options_(std::move(options)),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      timer_(::timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC)) {
  sigset_t taken;
  sigemptyset(&taken);
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) sigaddset(&taken, signal);
  ::pthread_sigmask(SIG_BLOCK, &taken, nullptr);
  signals_.reset(::signalfd(-1, &taken, SFD_NONBLOCK | SFD_CLOEXEC));
  watch(timer_.get());
  watch(signals_.get());
}

PlantLoop::~PlantLoop() { served_.clear(); }

tl::expected<void, std::string> PlantLoop::open() {
  for (const auto& bus : buses_) {
    serving_ = served_.size();
    served_.push_back({serve(*bus, *this)});
    if (const auto opened = served_.back().bus->open(now()); !opened) {
      served_.clear();
      return tl::unexpected(fmt::format("{}: {}", bus->spec().name, opened.error()));
    }
  }
  return {};
}

std::vector<std::string> PlantLoop::locations() const {
  std::vector<std::string> locations;
  for (const Entry& entry : served_) locations.push_back(entry.bus->location());
  return locations;
}

void PlantLoop::watch(int fd) {
  if (owner_.size() <= static_cast<std::size_t>(fd))
    owner_.resize(static_cast<std::size_t>(fd) + 1);
  owner_[static_cast<std::size_t>(fd)] = serving_;
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.fd = fd;
  ::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, fd, &event);
}

void PlantLoop::forget(int fd) { ::epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, fd, nullptr); }

void PlantLoop::arm(Instant at) {
  if (at == armed_) return;
  armed_ = at;
  itimerspec timer{};
  if (at != kNever) {
    const auto since = std::max(at.time_since_epoch(), Duration{1});  // zero would disarm the timer
    timer.it_value.tv_sec = static_cast<std::time_t>(since.count() / 1'000'000'000);
    timer.it_value.tv_nsec = static_cast<long>(since.count() % 1'000'000'000);
  }
  ::timerfd_settime(timer_.get(), TFD_TIMER_ABSTIME, &timer, nullptr);
}

void PlantLoop::take_signal() {
  signalfd_siginfo info{};
  while (::read(signals_.get(), &info, sizeof info) == sizeof info) {
    if (info.ssi_signo == SIGUSR1) {
      reported_ = report() && reported_;
    } else {
      stopping_ = true;
    }
  }
}

void PlantLoop::take(int fd) {
  if (fd == signals_.get()) return take_signal();
  if (fd == timer_.get()) {
    std::uint64_t expirations = 0;
    [[maybe_unused]] const ssize_t count = ::read(fd, &expirations, sizeof expirations);
    armed_ = kNever;
    return;
  }
  serving_ = owner_[static_cast<std::size_t>(fd)];
  served_[serving_].bus->on_readable(fd, now());
  served_[serving_].due = kLongAgo;  // received bytes may change its due time
}

void PlantLoop::wait(Instant until) {
  const Instant sleep_until = until == kNever ? kNever : until - options_.spin;
  bool sleep = now() < sleep_until;
  if (sleep) arm(sleep_until);
  std::array<epoll_event, 64> events;
  for (;;) {
    const int count =
        ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()), sleep ? -1 : 0);
    for (int i = 0; i < count; ++i) take(events[static_cast<std::size_t>(i)].data.fd);
    if (count > 0 || stopping_ || now() >= until) return;
    sleep = false;
  }
}

bool PlantLoop::run() {
  while (!stopping_) {
    Instant until = options_.end;
    const Instant called = now();
    for (serving_ = 0; serving_ < served_.size(); ++serving_) {
      Entry& entry = served_[serving_];
      if (entry.due <= called) entry.due = entry.bus->on_time(called);
      until = std::min(until, entry.due);
    }
    if (called >= options_.end) break;
    wait(until);
  }
  const bool written = report();
  served_.clear();
  return written && reported_;
}

bool PlantLoop::report() const {
  if (options_.report.empty()) return true;
  const Duration running = buses_.empty() ? Duration{} : now() - buses_.front()->start();
  return write_report(options_.report, report_of(buses_, running));
}

namespace {

Json device_report(const SimBus::Member& member) {
  const DeviceStatistics& counted = member.device->statistics();
  Json exceptions = Json::object();
  for (const auto& [code, count] : counted.exceptions) exceptions.add(std::to_string(code), count);
  std::uint64_t requests = 0;
  for (const auto& [function, count] : counted.requests) requests += count;
  return {{"name", member.name},
          {"requests", requests},
          {"requests_by_function", counted.requests},
          {"answers", counted.responses},
          {"exceptions", exceptions},
          {"write_requests", counted.write_requests},
          {"writes", counted.writes},
          {"broadcasts", counted.broadcasts},
          {"bad_frames", counted.bad_frames},
          {"unheard_characters", member.missed},
          {"spoiled_answers", member.spoiled}};
}

Json bus_report(const SimBus& bus) {
  const LineStatistics& line = bus.statistics();
  Json devices = Json::array();
  for (const SimBus::Member& member : bus.members()) devices.push_back(device_report(member));
  std::optional<double> rest_us;
  if (line.shortest_rest) rest_us = static_cast<double>(line.shortest_rest->count()) / 1000.0;
  return {{"name", bus.spec().name},
          {"port", to_text(bus.spec().port)},
          {"bytes_heard", line.bytes_received},
          {"bytes_said", line.bytes_sent},
          {"lost_characters", line.lost},
          {"collisions", line.collisions},
          {"connections", line.connections},
          {"shortest_rest_us", rest_us},
          {"devices", devices}};
}

}  // namespace

std::string location_line(const BusSpec& bus, const std::string& location) {
  const Json line{{"bus", bus.name},
                  {"place", location},
                  {"port", to_text(bus.port)},
                  {"devices", bus.devices.size()}};
  return line.text();
}

std::string report_of(std::span<const std::unique_ptr<SimBus>> buses, Duration running) {
  Json list = Json::array();
  for (const auto& bus : buses) list.push_back(bus_report(*bus));
  return Json{{"seconds", to_seconds(running)}, {"buses", list}}.text() + "\n";
}

bool write_report(const std::string& path, const std::string& report) {
  const std::string draft = path + ".part";
  {
    std::ofstream file(draft, std::ios::trunc);
    file << report;
    file.flush();
    if (!file) return false;
  }
  return std::rename(draft.c_str(), path.c_str()) == 0;
}

}  // namespace fieldcast::sim
