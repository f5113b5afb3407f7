#include "bridge/configure/line_scan.hpp"

#include <algorithm>

#include "bridge/configure/first_values.hpp"
#include "core/base/message_text.hpp"
#include "core/bus/setup/bus_setup.hpp"

namespace fieldcast::configure {

namespace {

// An integer of one item.
ChannelSpec channel_of(const ScanQuestion& question, const Protocol& protocol) {
  ChannelSpec channel;
  channel.name = channel.at = question.at;
  channel.range = question.range;
  const unsigned bits = protocol.areas()[question.range.area].item_bits;
  channel.encoding.type = bits == 1    ? ValueType::kBool
                          : bits == 8  ? ValueType::kUint8
                          : bits == 32 ? ValueType::kUint32
                                       : ValueType::kUint16;
  return channel;
}

ChannelSpec channel_of(const IdentityQuestion& identity, const Protocol& protocol) {
  ChannelSpec channel = channel_of(identity.question, protocol);
  if (identity.label.empty())
    channel.encoding = {.type = ValueType::kString,
                        .string_bytes = static_cast<std::uint16_t>(channel.range.count)};
  return channel;
}

// The identity was read behind the first response.
std::string identity_of(const ProbedDevice& device, const ScanPart& part) {
  const ProbedChannel& last = device.channels.back();
  if (!part.identity || last.name != part.identity->question.at || !last.value) return {};
  return printable(identity_text(*part.identity, fieldcast::to_text(*last.value)));
}

Json found_json(const DeviceSpec& spec, const ProbedChannel& channel, std::string identity) {
  return {{"address", std::to_string(spec.link.address)},
          {"protocol", spec.protocol},
          {"response", channel.value ? channel.name + " = " + fieldcast::to_text(*channel.value)
                                     : printable(channel.reason)},
          {"responded", channel.responded},
          {"took_ms", milliseconds(channel.took)},
          {"identity", std::move(identity)}};
}

}  // namespace

tl::expected<ScanPart, std::string> scan_part(const BusSpec& bus, const std::string& protocol,
                                              unsigned first, unsigned last) {
  const auto model = std::ranges::find(bus.devices, protocol, &DeviceSpec::protocol);
  if (model == bus.devices.end())
    return tl::unexpected("no device of the bus '" + bus.name + "' has the protocol '" +
                          printable(protocol) + "'");
  const LineFormat line = line_of(bus.port);
  const auto made = make_protocol(*model, line);
  if (!made || !model->link.long_address.empty())
    return tl::unexpected("the addresses of " + protocol + " are not numbers that can be searched");
  const unsigned lowest = (*made)->traits().lowest_address;
  const unsigned highest = (*made)->traits().highest_address;
  if (first > last || first < lowest || last > highest)
    return tl::unexpected("addresses of " + protocol + " are " + std::to_string(lowest) + " to " +
                          std::to_string(highest));
  DeviceSpec device = *model;
  device.number.clear();
  device.channels.clear();
  for (const ScanQuestion& question : scan_questions(**made, model->declaration))
    device.channels.push_back(channel_of(question, **made));
  ScanPart part{.questions = device.channels.size(), .identity = identity_question(**made)};
  if (part.identity) device.channels.push_back(channel_of(*part.identity, **made));
  for (unsigned address = first; address <= last; ++address) {
    if (part.devices.size() == DeviceProbe::kMostDevices) {
      part.next = static_cast<std::uint16_t>(address);
      break;
    }
    device.name = "address " + std::to_string(address);
    device.link.address = static_cast<std::uint16_t>(address);
    const bool is_known = std::ranges::any_of(
        bus.devices, [&](const DeviceSpec& other) { return same_address(other, device); });
    if (!is_known && make_protocol(device, line)) part.devices.push_back(device);
  }
  return part;
}

Json scan_json(const ScanPart& part, const std::vector<ProbedDevice>& probed) {
  Json found = Json::array();
  for (std::size_t i = 0; i < probed.size(); ++i) {
    const auto& channels = probed[i].channels;
    if (channels.empty())  // the bus stopped
      return {{"found", found}, {"next", part.devices[i].link.address}, {"error", ""}};
    const bool responds = std::ranges::any_of(channels, &ProbedChannel::responded);
    if (DeviceProbe::ends_probe(channels.back().cause) && !responds) {
      // The next part begins here; if nothing could be done, it would end in the same way.
      const std::string error = i == 0 ? error_of(part.devices[i], channels.back()) : "";
      return {{"found", found}, {"next", part.devices[i].link.address}, {"error", error}};
    }
    const auto seen = std::ranges::find_if(
        channels, [](const ProbedChannel& channel) { return channel.cause != Cause::kNoResponse; });
    if (seen != channels.end())
      found.push_back(found_json(part.devices[i], *seen, identity_of(probed[i], part)));
  }
  // The probe may have ended while it read the identity of its last device.
  const auto next = probed.size() < part.devices.size()
                        ? std::optional(part.devices[probed.size()].link.address)
                        : part.next;
  return {{"found", found}, {"next", next ? Json(*next) : Json(nullptr)}, {"error", ""}};
}

}  // namespace fieldcast::configure
