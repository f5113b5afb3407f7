#include "core/bus/bus_parts.hpp"

namespace fieldcast {

namespace {

constexpr std::size_t kMostNames = 8;
constexpr std::size_t kMostRanges = 32;  // S7-200 PPI reads at most 19

std::string ranges_text(const BusSetup& setup, DeviceIndex device, const Request& request) {
  if (const auto* write = std::get_if<WriteRequest>(&request))
    return "write " + setup.text(device, write->range);
  if (const auto* both = std::get_if<WriteReadRequest>(&request))
    return "write " + setup.text(device, both->write.range) + ", read " +
           setup.text(device, both->read);
  const auto& ranges = std::get<ReadRequest>(request).ranges;
  std::string text = "read ";
  for (std::size_t i = 0; i < ranges.size() && i < kMostRanges; ++i)
    text += (i == 0 ? "" : ", ") + setup.text(device, ranges[i]);
  if (ranges.size() > kMostRanges) text += ", +" + std::to_string(ranges.size() - kMostRanges);
  return text;
}

std::string command_text(const Command& command, std::size_t batch) {
  std::string text;
  if (const auto* channel = std::get_if<ChannelTarget>(&command.target))
    text = channel->name.empty() ? "all channels" : channel->name;
  if (batch > 1) text += (text.empty() ? "+" : ", +") + std::to_string(batch - 1);
  return (text.empty() ? "command of " : text + "; command of ") + command.requester;
}

}  // namespace

tl::expected<void, CommandFault> BusParts::admit(const Command& command, Instant now) {
  const auto fault = [](Cause cause, std::string reason) {
    return tl::make_unexpected(CommandFault{cause, std::move(reason)});
  };
  const auto* const target = std::get_if<ChannelTarget>(&command.target);
  if (command.operation != Operation::kAcquire || target == nullptr || target->name.empty())
    return fault(Cause::kUnsupported, "only single channels of such a device can be read");
  const DeviceSpec& device = *command.ad_hoc;
  if (setup.find_ad_hoc(device)) return {};
  if (auto reason = setup.why_not_ad_hoc(device))
    return fault(Cause::kUnsupported, std::move(*reason));
  late.expire(now);
  std::optional<DeviceIndex> free;
  for (auto index = static_cast<DeviceIndex>(setup.devices()); index < setup.slots(); ++index) {
    const bool waits = commands.uses(index), owes = late.owes(index);
    if (setup.protocols()[index] && same_address(setup.device(index), device)) {
      // Pending responses stay valid for the same device with other channels or another timeout.
      if (waits || (owes && setup.device(index).link != device.link))
        return fault(Cause::kQueueFull, "an earlier request to this address is still pending");
      free = index;
      break;
    }
    if (!waits && !owes && !free) free = index;
  }
  if (!free) return fault(Cause::kQueueFull, "requests to other devices are still pending");
  if (!setup.set_ad_hoc(*free, device))
    return fault(Cause::kBadAddress, "the protocol does not have this address");
  devices.replaced(*free);
  if (!late.owes(*free)) late.replaced(*free);
  return {};
}

std::string flight_text(const BusParts& parts, const Flight& flight) {
  const DeviceIndex device = flight.asked.device;
  std::string why;
  if (flight.kind == Flight::Kind::kRead) {
    why = parts.reads.channel_names(flight.block, kMostNames);
  } else if (const Command* command = parts.commands.first(); flight.is_command() && command) {
    why = command_text(*command, flight.batch);
  } else if (flight.kind == Flight::Kind::kProbe) {
    why = "is it back?";
  }
  std::string text = parts.setup.device(device).name + ": " +
                     ranges_text(parts.setup, device, flight.asked.request);
  if (!why.empty()) text += " (" + why + ")";
  if (flight.tries > 0) text += ", try " + std::to_string(flight.tries + 1);
  return text;
}

}  // namespace fieldcast
