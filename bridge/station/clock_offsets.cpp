#include "bridge/station/clock_offsets.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace fieldcast {
namespace {

std::optional<Duration> smaller(std::optional<Duration> a, std::optional<Duration> b) {
  return a && b ? std::min(a, b) : a ? a : b;
}

}  // namespace

std::optional<Duration> ClockOffsets::add(const std::string& bridge, const std::string& bus,
                                          UtcTime written, UtcTime arrived, Instant now) {
  std::int64_t offset = 0;
  if (written.nanoseconds <= 0 ||
      __builtin_sub_overflow(arrived.nanoseconds, written.nanoseconds, &offset))
    return std::nullopt;
  if (buses_ >= kMostBuses) forget_silent(now);
  if (buses_ >= kMostBuses && (!peers_.contains(bridge) || !peers_[bridge].buses.contains(bus)))
    return std::nullopt;
  Peer& peer = peers_[bridge];
  if (now - peer.since >= kWindow) {
    const bool recent = now - peer.since < 2 * kWindow;
    peer.least_before = recent ? std::exchange(peer.least, std::nullopt) : std::nullopt;
    if (!recent) peer.least.reset();
    peer.since = now;
  }
  peer.last = now;
  if (peer.buses.insert(bus).second) {
    ++buses_;
  } else {
    peer.least = smaller(peer.least, Duration{offset});
  }
  return smaller(peer.least, peer.least_before);
}

void ClockOffsets::forget_silent(Instant now) {
  std::erase_if(peers_, [&](const auto& entry) {
    const bool silent = now - entry.second.last >= 2 * kWindow;
    if (silent) buses_ -= entry.second.buses.size();
    return silent;
  });
}

}  // namespace fieldcast
