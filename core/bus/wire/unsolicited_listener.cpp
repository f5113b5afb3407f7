#include "core/bus/wire/unsolicited_listener.hpp"

#include <algorithm>

namespace fieldcast {

UnsolicitedListener::UnsolicitedListener(const BusSetup& setup) : setup_(setup) {
  for (DeviceIndex index = 0; index < setup.devices(); ++index) {
    Sender sender{.device = index};
    bool sends = false, polled = false;
    for (const ChannelSpec& channel : setup.device(index).channels) {
      sends = sends || channel.unsolicited;
      polled = polled || is_requestable(channel);
      if (channel.unsolicited) sender.patience = std::max(sender.patience, channel.refresh);
    }
    if (polled) sender.patience = Duration::zero();
    if (sends) senders_.push_back(std::move(sender));
  }
}

void UnsolicitedListener::opened() {
  last_byte_ = kLongAgo;
  for (Sender& sender : senders_) {
    sender.kept.clear();
    sender.boundary = false;
    sender.silent_since = kNever;
  }
}

std::vector<UnsolicitedListener::Frame> UnsolicitedListener::on_bytes(ByteView bytes, Instant now) {
  std::vector<Frame> frames;
  const bool paused = last_byte_ < now - kLongestPause;
  last_byte_ = now;
  for (Sender& sender : senders_) {
    if (paused && !sender.kept.empty()) {
      sender.kept.clear();
      sender.boundary = false;
    }
    append(sender.kept, bytes);
    if (sender.kept.size() > kMostKept) {
      sender.kept.erase(sender.kept.begin(), sender.kept.end() - kMostKept / 2);
      sender.boundary = false;
    }
    for (;;) {
      UnsolicitedFrame found =
          setup_.protocol(sender.device).find_unsolicited(sender.kept, sender.boundary);
      sender.kept.erase(sender.kept.begin(),
                        sender.kept.begin() + static_cast<std::ptrdiff_t>(found.used));
      sender.boundary = found.boundary;
      if (!found.range) break;
      sender.silent_since = now;
      frames.push_back(
          {sender.device, *found.range, std::move(found.items), std::move(found.absent)});
    }
  }
  return frames;
}

std::vector<DeviceIndex> UnsolicitedListener::silent(Instant now) {
  std::vector<DeviceIndex> devices;
  for (Sender& sender : senders_) {
    if (sender.patience == Duration::zero()) continue;
    if (sender.silent_since == kNever) sender.silent_since = now;
    if (now - sender.silent_since < sender.patience) continue;
    sender.silent_since = now;
    devices.push_back(sender.device);
  }
  return devices;
}

Instant UnsolicitedListener::next_silence() const {
  Instant next = kNever;
  for (const Sender& sender : senders_) {
    if (sender.patience > Duration::zero() && sender.silent_since != kNever)
      next = std::min(next, sender.silent_since + sender.patience);
  }
  return next;
}

}  // namespace fieldcast
