#include "core/program/reconnection.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast::program {
namespace {

bool is_final(const PortEnd& end) {
  switch (end.kind) {
    case PortEnd::Kind::kDeviceLost:
    case PortEnd::Kind::kBridgeGone: return false;
    // The bridge may still hold the device for the lost connection, or the module has not dialled
    // in again.
    case PortEnd::Kind::kRefused: return end.reply == Reply::kNotAllowed;
    case PortEnd::Kind::kStopped:
    case PortEnd::Kind::kProtocol: return true;
  }
  return true;
}

}  // namespace

std::optional<Reconnection::Next> Reconnection::ended(const PortEnd& end, Instant now) {
  if (is_final(end)) return std::nullopt;
  const Instant since = std::exchange(paired_at_, kNever);
  if (since != kNever && now - since >= kProven) next_ = kFirst;
  if (end.kind == PortEnd::Kind::kDeviceLost && since != kNever && now - sent_at_ >= kSilent)
    return Next{.when_program_sends = true};
  const Next next{.pause = next_};
  next_ = std::min(next_ * 2, kLongest);
  return next;
}

}  // namespace fieldcast::program
