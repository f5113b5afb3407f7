#include "bridge/service/service.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>

#include "bridge/log/log.hpp"

namespace fieldcast {

namespace {

std::string environment(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing sets it
  return value ? value : "";
}

template <typename Number>
std::optional<Number> number_in(const std::string& text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

Service::Service(std::string notify_address, std::optional<Duration> watchdog)
    : address_(std::move(notify_address)), watchdog_(watchdog) {
  if (address_.size() >= sizeof(sockaddr_un::sun_path)) address_.clear();
  if (!address_.empty())
    socket_.reset(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

void Service::ready(std::string_view status) { send(fmt::format("READY=1\nSTATUS={}", status)); }

void Service::reloading(Instant now) {
  const auto microseconds =
      std::chrono::duration_cast<std::chrono::microseconds>(now.time_since_epoch());
  send(fmt::format("RELOADING=1\nMONOTONIC_USEC={}\nSTATUS=reloading", microseconds.count()));
}

void Service::status(std::string_view text) { send(fmt::format("STATUS={}", text)); }

void Service::send(const std::string& message) {
  if (!socket_.valid()) return;
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  std::memcpy(to.sun_path, address_.data(), address_.size());
  if (to.sun_path[0] == '@') to.sun_path[0] = '\0';
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address_.size());
  (void)::sendto(socket_.get(), message.data(), message.size(), MSG_NOSIGNAL,
                 reinterpret_cast<const sockaddr*>(&to), size);
}

std::string notify_address() { return environment("NOTIFY_SOCKET"); }

std::optional<Duration> watchdog_limit() {
  const std::string process = environment("WATCHDOG_PID");
  if (!process.empty() && number_in<pid_t>(process) != ::getpid()) return std::nullopt;
  const auto limit = number_in<std::int64_t>(environment("WATCHDOG_USEC"));
  if (!limit || *limit <= 0) return std::nullopt;
  return std::chrono::microseconds{*limit};
}

std::optional<StandingBus> standing_bus(const std::vector<BusTurn>& turns, Instant now,
                                        Duration limit) {
  const auto oldest = std::min_element(
      turns.begin(), turns.end(), [](const BusTurn& a, const BusTurn& b) { return a.at < b.at; });
  if (oldest == turns.end() || now - oldest->at <= limit) return std::nullopt;
  return StandingBus{oldest->bus, now - oldest->at};
}

// Three times within the limit, so that one late turn has no effect.
Duration Service::sleep(Duration longest) const {
  return watchdog_ ? std::min(longest, *watchdog_ / 3) : longest;
}

void Service::look(const std::vector<BusTurn>& turns, Instant now) {
  if (!watchdog_) return;
  const auto standing = standing_bus(turns, now, std::max(*watchdog_ / 2, kLeastStanding));
  if (!standing) {
    if (!standing_.empty()) {
      log_warning(standing_, "the bus turns again");
      status("all buses turn");
    }
    standing_.clear();
    return send("WATCHDOG=1");
  }
  if (standing->bus == standing_) return;
  standing_ = standing->bus;
  const std::string text = fmt::format(
      "the bus stands, {:.0f} s since its last turn: its driver "
      "hangs; the service is restarted if that goes on",
      to_seconds(standing->standing));
  log_error(standing_, text);
  status(fmt::format("{}: {}", standing_, text));
}

}  // namespace fieldcast
