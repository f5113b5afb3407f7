#include "config/sections/device.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/channel/channel.hpp"
#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/bus_keys.hpp"
#include "config/sections/port.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast::config {
namespace {

struct Draft {
  DeviceDefaults defaults;            // its spec is the device
  std::vector<const Node*> channels;  // those of the template first
};

// A list, or the name of a file with one.
void read_channel_nodes(MapReader& map, Draft& draft, LoadState& state) {
  const Node* node = map.find("channels");
  if (node == nullptr) return;
  if (node->kind == Kind::kScalar) node = state.library.channel_list(*node);
  if (node == nullptr) return;
  if (!is_list(*node, "channels", 0, kAnyCount, "a list of channels, or the name of a CSV file",
               state.faults))
    return;
  draft.channels.insert(draft.channels.end(), node->items.begin(), node->items.end());
}

// Protocols whose address notation the template uses.
void check_template_protocols(MapReader& map, const Node& naming, const std::string& protocol,
                              LoadState& state) {
  const Node* node = map.find("protocols");
  if (node == nullptr) return;
  if (!is_list(*node, "protocols", 1, kAnyCount, "a list of protocols", map.faults())) return;
  // A declaration is found relative to the configuration, not to the template.
  const bool fits = std::ranges::any_of(node->items, [&](const Node* item) {
    return item->kind == Kind::kScalar && !protocol.empty() && item->text == protocol;
  });
  if (fits) return;
  std::vector<std::string> names;
  for (const Node* item : node->items) {
    if (auto choice = read_protocol(*item, "protocol", state); choice.known())
      names.push_back(std::move(choice.name));
  }
  if (protocol.empty() || names.size() != node->items.size()) return;
  map.faults().add(naming.position,
                   fmt::format("template '{}' is not for {}", naming.text, protocol),
                   joined(std::vector<std::string_view>(names.begin(), names.end())));
}

void read_template(const Node& naming, const std::string& protocol, Draft& draft,
                   LoadState& state) {
  const Node* root = state.library.device_template(naming);
  if (root == nullptr) return;
  MapReader map(*root, template_rows(), state.faults);
  std::string description;
  map.read("description", description, TextRule{kMaxDescription});
  check_template_protocols(map, naming, protocol, state);
  template_default_rows().read_section(map, "defaults", draft.defaults);
  template_rows().read(map, draft.defaults);
  read_channel_nodes(map, draft, state);
}

// Null after faults of address or options.
std::unique_ptr<Protocol> protocol_of(MapReader& map, const ProtocolChoice& choice,
                                      const PortSpec& port, bool has_address, const Draft& draft) {
  const auto options =
      choice.built_in != nullptr ? choice.built_in->options : std::span<const std::string_view>{};
  bool known = true;
  for (const auto& [name, value] : draft.defaults.spec.link.options) {
    if (std::ranges::find(options, name) != options.end()) continue;
    known = false;
    map.faults().add(draft.defaults.options.positions.at(name),
                     fmt::format("unknown option '{}' of {}", name, choice.name),
                     options.empty() ? "no options" : joined(options), closest(name, options));
  }
  if (!known) return nullptr;
  auto protocol = make_protocol(draft.defaults.spec, line_of(port));
  if (protocol) return std::move(*protocol);
  const auto& fault = protocol.error();
  const auto option = draft.defaults.options.positions.find(fault.option);
  // The address is missing or not a number: a fault was already added.
  if (fault.option.empty() && !has_address) return nullptr;
  const bool of_option = option != draft.defaults.options.positions.end();
  map.faults().add(
      of_option ? option->second : map.position_of("address"),
      (of_option ? fmt::format("option '{}': ", fault.option) : std::string{}) + fault.what,
      fault.allowed);
  return nullptr;
}

void read_channels(const Draft& draft, const Protocol* protocol, const Position& position,
                   DeviceSpec& spec, LoadState& state) {
  const ChannelContext context{protocol, draft.defaults.channels, draft.defaults.spec.max_block};
  UniqueNames names;
  spec.channels.reserve(std::min(draft.channels.size(), kMaxChannels));
  for (const Node* node : draft.channels) {
    if (state.channels++ >= kMaxChannels) {
      state.faults.add(position, "too many channels", fmt::format("{} of a bridge", kMaxChannels));
      return;
    }
    spec.channels.push_back(read_channel(*node, context, state.faults));
    names.add("channel", spec.channels.back().name, node->position, state.faults);
    if (!spec.channels.back().calculation) continue;
    for (const auto& [key, value] : node->entries)
      if (key->text == "calculate")
        state.calculations.push_back(value->kind == Kind::kScalar ? value : nullptr);
  }
}

// A number of 16 bits; in a declared protocol also a longer one, or a text.
bool read_address(const Node& node, const ProtocolChoice& choice, DeviceLink& link,
                  FaultList& faults) {
  const auto* declaration = choice.declaration.value.get();
  const bool is_text = declaration != nullptr && declaration->address_characters != 0;
  if (declaration == nullptr || (!is_text && declaration->highest_address <= 65535)) {
    const auto address = WholeRule{0, 65535}(node, "address", faults);
    if (address) link.address = static_cast<std::uint16_t>(*address);
    return address.has_value();
  }
  if (is_text) {
    const auto text = TextRule{declaration->address_characters}(node, "address", faults);
    if (text) link.long_address = *text;
    return text.has_value();
  }
  // A meter's number may be quoted, and may begin with zeros.
  const auto* text = scalar_of(node, "address", "the number of the device", faults);
  if (text == nullptr) return false;
  const auto number = whole_from(*text);
  if (!number || *number < 0) {
    faults.add(node.position, fmt::format("address '{}' is no whole number", *text),
               fmt::format("{} to {}", declaration->lowest_address, declaration->highest_address));
    return false;
  }
  link.address = static_cast<std::uint16_t>(std::min<std::int64_t>(*number, 65535));
  if (*number > 65535) link.long_address = std::to_string(*number);
  return true;
}

}  // namespace

DeviceSpec read_device(const Node& node, const DeviceContext& context, LoadState& state) {
  MapReader map(node, device_rows(), state.faults);
  Draft draft{context.defaults, {}};
  DeviceSpec& spec = draft.defaults.spec;
  const Node* address_node = map.require("address", "the device's address on the bus");

  ProtocolChoice choice = context.protocol;
  if (const Node* own = map.find("protocol")) {
    choice = read_protocol(*own, "protocol", state);
    // The bus's options are those of its protocol.
    if (context.protocol_named && choice.name != context.protocol.name) draft.defaults.options = {};
  } else if (!context.protocol_named && map.is_map() && !map.has("protocol")) {
    state.faults.add(map.position(), "'protocol' is missing in a device, and its bus names none",
                     "a protocol here or in the bus");
  }
  if (choice.known()) {
    spec.protocol = choice.name;
    spec.declaration = choice.declaration;
    check_port(spec.protocol, context.port,
               map.has("protocol") ? map.position_of("protocol") : context.protocol_position,
               state.faults);
  }
  // A protocol that was refused does not say what its addresses are.
  const bool refused = !choice.known() && (map.has("protocol") || context.protocol_named);
  const bool has_address = address_node != nullptr && !refused &&
                           read_address(*address_node, choice, spec.link, state.faults);
  if (has_address && choice.known()) {
    const std::string address = fmt::format("{} ({})", address_text(spec.link), spec.protocol);
    context.addresses.add("address", address, map.position_of("address"), state.faults);
  }

  if (const Node* naming = map.find("template"))
    read_template(*naming, spec.protocol, draft, state);
  device_rows().read(map, draft.defaults);
  read_channel_nodes(map, draft, state);
  spec.link.options = draft.defaults.options.texts;

  const auto protocol =
      choice.known() ? protocol_of(map, choice, context.port, has_address, draft) : nullptr;
  if (draft.channels.empty() && map.is_map() && !map.has("channels") && !map.has("template") &&
      !spec.allow_raw_read && !spec.allow_raw_write) {
    state.faults.add(map.position(), "a device without channels",
                     "channels, a template, or allow: [raw-read, raw-write]");
  }
  read_channels(draft, protocol.get(), map.position_of("channels"), spec, state);
  return std::move(spec);
}

}  // namespace fieldcast::config
