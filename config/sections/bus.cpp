#include "config/sections/bus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "config/document/common_forms.hpp"
#include "config/document/document.hpp"
#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/bus_keys.hpp"
#include "config/sections/gateway.hpp"
#include "config/sections/port.hpp"
#include "core/base/duration_text.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast::config {

namespace {

void read_defaults(MapReader& bus, BusSpec& spec, DeviceDefaults& defaults) {
  const Node* node = bus.find("defaults");
  if (node == nullptr) return;
  MapReader map(*node, bus_default_rows(), bus.faults());
  BusDefaults both{spec, defaults};
  bus_default_rows().read(map, both);
}

// Responses of one connection are matched with the requests by a number in the frames.
void check_in_flight(const BusSpec& spec, const MapReader& map, FaultList& faults) {
  if (spec.in_flight == 1) return;
  const auto fault = [&](const std::string& what, const std::string& allowed) {
    faults.add(map.position_of("in-flight"), "in-flight: " + what, allowed);
  };
  if (!over_network(spec.port) || has_line(spec.port))
    return fault("the port is no plain TCP device", "port: { tcp: HOST:PORT } without baud");
  for (const DeviceSpec& device : spec.devices) {
    const ProtocolEntry* entry = find_protocol(device.protocol);
    if (entry == nullptr || entry->first_frame == nullptr)
      return fault(device.protocol + " cannot have several requests in flight",
                   pipelined_protocol_names());
    const auto protocol = make_protocol(device, line_of(spec.port));
    if (protocol && (*protocol)->traits().identity != ResponseIdentity::kSequence)
      return fault(device.protocol + " cannot have several requests in flight with these options",
                   "frame: 4e");
    if (device.protocol != spec.devices.front().protocol)
      return fault("the devices have different protocols", "one protocol for the bus");
    if (device.pause > Duration::zero())
      return fault("device " + device.name + " has a pause after each exchange",
                   "a bus without pause");
  }
}

void read_devices(MapReader& bus, const DeviceContext& context, BusSpec& spec, LoadState& state) {
  const Node* list = bus.require("devices", "a list of devices");
  if (list == nullptr) return;
  auto& faults = state.faults;
  if (!is_list(*list, "devices", 1, kAnyCount, "a list of devices", faults)) return;
  UniqueNames names;
  for (const Node* node : list->items) {
    if (spec.devices.size() == kMaxDevices) {
      faults.add(node->position, "too many devices", fmt::format("{} of a bus", kMaxDevices));
      return;
    }
    spec.devices.push_back(read_device(*node, context, state));
    names.add("device", spec.devices.back().name, node->position, faults);
    const ProtocolEntry* entry = find_protocol(spec.devices.back().protocol);
    if (spec.devices.size() == 2 && entry != nullptr && entry->one_device) {
      faults.add(node->position, fmt::format("a bus of {} has one device", entry->name),
                 "a bus of its own for each");
    }
  }
}

// The protocol that the devices name, if their lines are alike; otherwise empty.
std::string_view protocol_of_devices(MapReader& bus) {
  const Node* list = bus.find("devices");
  std::string_view found;
  for (std::size_t i = 0; list != nullptr && i < list->items.size(); ++i) {
    const auto own = std::ranges::find_if(list->items[i]->entries, [](const Node::Entry& entry) {
      return entry.key->text == "protocol";
    });
    if (own == list->items[i]->entries.end()) return {};
    if (i == 0) found = own->value->text;
    if (factory_line(own->value->text) != factory_line(found)) return {};
  }
  return found;
}

}  // namespace

std::optional<SilenceRule> SilenceReader::operator()(const Node& node, std::string_view key,
                                                     FaultList& faults) const {
  static constexpr std::string_view kForms =
      "standard, characters such as 3.5c, a duration such as 500us, learn, learn 1ms";
  static constexpr std::string_view kLearn = "learn";
  const std::string* text = scalar_of(node, key, kForms, faults);
  if (text == nullptr) return std::nullopt;
  if (*text == "standard") return StandardSilence{};
  if (*text == kLearn) return LearnedSilence{};
  if (text->starts_with(kLearn) && (*text)[kLearn.size()] == ' ') {
    const auto least = duration_from(std::string_view(*text).substr(kLearn.size() + 1));
    if (least && *least >= Duration::zero() && *least <= kMaxSilence) return LearnedSilence{*least};
  }
  if (text->ends_with('c')) {
    const auto characters = number_from(std::string_view(*text).substr(0, text->size() - 1));
    if (characters && *characters >= 0 && *characters <= kMaxSilenceCharacters)
      return CharacterSilence{*characters};
  }
  if (duration_from(*text)) {
    if (const auto duration = DurationRule{Duration{}, kMaxSilence}(node, key, faults))
      return *duration;
    return std::nullopt;
  }
  const std::string meant = number_from(*text)
                                ? *text + 'c'
                                : closest(*text, std::array{std::string_view("standard"), kLearn});
  faults.add(node.position, fmt::format("{} '{}' is unknown", key, *text), kForms, meant);
  return std::nullopt;
}

std::string SilenceReader::schema() const {
  return R"({ "type": "string", )"
         R"("pattern": "^(standard|learn|(learn )?[0-9]+(\\.[0-9]+)?(c|us|ms|s|m|min|h|d))$" })";
}
std::string SilenceReader::form() const { return {}; }

BusSpec read_bus(const Node& node, LoadState& state) {
  MapReader map(node, bus_rows(), state.faults);
  BusSpec spec;
  UniqueNames addresses;
  DeviceContext context{{}, map.has("protocol"), map.position_of("protocol"),
                        {}, spec.port,           addresses};
  bus_rows().read(map, spec);
  if (const Node* protocol = map.find("protocol"))
    context.protocol = read_protocol(*protocol, "protocol", state);
  if (const Node* port = map.require("port", port_forms()))
    spec.port = read_port(
        *port, factory_line(map.has("protocol") ? context.protocol.name : protocol_of_devices(map)),
        state.library, state.faults);
  read_capture(map, spec.capture);
  read_defaults(map, spec, context.defaults);
  read_devices(map, context, spec, state);
  read_gateway(map, spec);
  check_in_flight(spec, map, state.faults);
  if (const auto fault = port_fault(spec))
    state.faults.add(map.position_of("port"), fault->what, fault->allowed);
  return spec;
}

std::optional<PortFault> port_fault(const BusSpec& spec) {
  for (const DeviceSpec& device : spec.devices) {
    const ProtocolEntry* entry = find_protocol(device.protocol);
    const std::string option(entry == nullptr ? "" : entry->datagram_option);
    const bool has_option = !option.empty() && device.link.options.contains(option);
    if (device.declaration && device.declaration.value->changes_rate() &&
        !std::holds_alternative<SerialPortSpec>(spec.port))
      return {{device.protocol + " changes the baud rate of its line", "port: { serial: PATH }"}};
    const std::string over_udp = device.protocol + " over UDP";
    if (!has_datagrams(spec.port)) {
      if (has_option) return {{option + " is for UDP", "port: { udp: HOST:PORT }"}};
      continue;
    }
    if (entry != nullptr && entry->stream_only && !has_option) {
      if (option.empty()) return {{over_udp, "port: { tcp: HOST:PORT }"}};
      return {{fmt::format("{} without {}", over_udp, option),
               fmt::format("options: {{ {}: 1 to 254 }}", option)}};
    }
    const auto protocol = make_protocol(device, line_of(spec.port));
    if (!protocol || (*protocol)->traits().identity == ResponseIdentity::kSequence) continue;
    const bool only_listens =
        !device.channels.empty() && std::ranges::all_of(device.channels, &ChannelSpec::unsolicited);
    if (!only_listens)
      return {{over_udp + ": its responses do not name their request, so that a late or doubled "
                          "one would be taken for the next",
               "port: { tcp: HOST:PORT }"}};
  }
  return std::nullopt;
}

void read_capture(MapReader& bus, std::optional<CaptureSpec>& spec) {
  const Node* node = bus.find("capture");
  if (node == nullptr) return;
  MapReader map(*node, capture_rows(), bus.faults());
  CaptureSpec capture;
  capture_rows().read(map, capture);
  capture.folder = resolve(*map.position().source, capture.folder);
  spec = std::move(capture);
}

}  // namespace fieldcast::config
