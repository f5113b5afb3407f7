#include "bridge/service/service.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bridge/log/log.hpp"

namespace fieldcast {

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
      socket_.status("all buses turn");
    }
    standing_.clear();
    return socket_.alive();
  }
  if (standing->bus == standing_) return;
  standing_ = standing->bus;
  const std::string text = fmt::format(
      "the bus stands, {:.0f} s since its last turn: its driver "
      "hangs; the service is restarted if that goes on",
      to_seconds(standing->standing));
  log_error(standing_, text);
  socket_.status(fmt::format("{}: {}", standing_, text));
}

}  // namespace fieldcast
