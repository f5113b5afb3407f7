#include "tools/sim/bus/fault_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/document/map_reader.hpp"
#include "config/document/scalars.hpp"
#include "config/document/suggest.hpp"
#include "config/files/file_reader.hpp"
#include "config/loader/loader.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {
namespace {

using namespace std::chrono_literals;
using config::DurationRule;
using config::FaultList;
using config::FlagRule;
using config::KeyTable;
using config::Kind;
using config::MapReader;
using config::Node;
using config::TextRule;
using config::WholeRule;

constexpr std::size_t kMaxListed = 1000;  // windows or ranges in one list
constexpr DurationRule kMoment{0s, 24h * 365};

constexpr std::string_view kFileWords[] = {"buses"};
constexpr std::string_view kBusWords[] = {"noise",  "echo", "babble", "foreign",
                                          "unplug", "fifo", "devices"};
constexpr std::string_view kDeviceWords[] = {"delay",   "loss",    "late",       "queue",
                                             "doubled", "deaf",    "garble",     "truncate",
                                             "stray",   "silence", "exceptions", "only-configured"};
constexpr std::string_view kBabbleWords[] = {"rate", "length"};
constexpr std::string_view kUnplugWords[] = {"at", "for"};
constexpr std::string_view kDelayWords[] = {"base", "spread", "spike", "spike-probability"};
constexpr std::string_view kLateWords[] = {"probability", "by"};
constexpr std::string_view kDoubledWords[] = {"probability", "after"};
constexpr std::string_view kSilenceWords[] = {"from", "to"};
constexpr std::string_view kExceptionWords[] = {"area", "from", "to", "code"};
const KeyTable kFileKeys{"faults", "a faults file", kFileWords},
    kBusKeys{"bus", "the faults of a bus", kBusWords},
    kDeviceKeys{"device", "the faults of a device", kDeviceWords},
    kBabbleKeys{"babble", "a babble", kBabbleWords},
    kUnplugKeys{"unplug", "an unplugging", kUnplugWords},
    kDelayKeys{"delay", "a delay", kDelayWords}, kLateKeys{"late", "late responses", kLateWords},
    kDoubledKeys{"doubled", "doubled responses", kDoubledWords},
    kSilenceKeys{"silence", "a silence", kSilenceWords},
    kExceptionKeys{"exception", "an exception range", kExceptionWords};

struct BoundedRule {
  double min, max;
  std::optional<double> operator()(const Node& node, std::string_view key,
                                   FaultList& faults) const {
    const auto value = config::NumberRule{}(node, key, faults);
    if (!value || (*value >= min && *value <= max)) return value;
    faults.add(node.position, fmt::format("{} '{}' is out of range", key, node.text),
               fmt::format("a number from {} to {}", whole(min), whole(max)));
    return std::nullopt;
  }
  static std::string whole(double bound) { return std::to_string(static_cast<int>(bound)); }
};
constexpr BoundedRule kProbability{0, 1};

template <typename Read>
void each(const Node& node, std::string_view key, FaultList& faults, const Read& read) {
  if (node.kind == Kind::kMap) return read(node);
  if (node.kind != Kind::kList || node.items.size() > kMaxListed) {
    faults.add(node.position,
               fmt::format("{} is {}", key,
                           node.kind == Kind::kList ? "too long" : std::string(to_text(node.kind))),
               fmt::format("a list of at most {} maps", kMaxListed));
    return;
  }
  for (const Node* item : node.items) read(*item);
}

void read_silence(const Node& node, DeviceFaults& device, FaultList& faults) {
  device.silence.clear();
  if (node.kind == Kind::kScalar) {
    if (node.text == "always") {
      device.silence.push_back({});
    } else {
      faults.add(node.position, fmt::format("silence '{}' is unknown", node.text),
                 "always, or a list of { from, to }", "always");
    }
    return;
  }
  each(node, "silence", faults, [&](const Node& item) {
    Window window;
    MapReader map(item, kSilenceKeys, faults);
    map.read("from", window.from, kMoment);
    map.read("to", window.to, kMoment);
    if (window.to <= window.from)
      map.fault("to", "the silence ends before it begins", "a 'to' after 'from'");
    device.silence.push_back(window);
  });
}

void read_delay(const Node& node, ResponseDelay& delay, FaultList& faults) {
  constexpr DurationRule kDelay{0s, 1min};
  if (node.kind == Kind::kScalar) {
    if (const auto base = kDelay(node, "delay", faults)) delay.base = *base;
    return;
  }
  MapReader map(node, kDelayKeys, faults);
  map.read("base", delay.base, kDelay);
  map.read("spread", delay.spread, kDelay);
  map.read("spike", delay.spike, kDelay);
  map.read("spike-probability", delay.spike_probability, kProbability);
}

void read_exceptions(const Node& node, DeviceFaults& device,
                     const std::vector<std::string_view>& areas, FaultList& faults) {
  device.refused.clear();
  each(node, "exceptions", faults, [&](const Node& item) {
    RefusedRange range;
    MapReader map(item, kExceptionKeys, faults);
    constexpr WholeRule kItem{0, 0xFFFFFFFF};
    map.read_required("area", range.area, TextRule{32}, "an area of the device's protocol");
    map.read_required("from", range.from, kItem, "the first item");
    range.to = range.from;
    map.read("to", range.to, kItem);
    map.read("code", range.code, WholeRule{1, 255});
    if (range.to < range.from)
      map.fault("to", "the range ends before it begins", "a 'to' not below 'from'");
    const bool known =
        areas.empty() || range.area.empty() || std::ranges::find(areas, range.area) != areas.end();
    if (!known) {
      map.fault("area", fmt::format("area '{}' is unknown", range.area), config::joined(areas),
                config::closest(range.area, areas));
    }
    device.refused.push_back(range);
  });
}

void read_device(const Node& node, DeviceFaults& device, const std::vector<std::string_view>& areas,
                 FaultList& faults) {
  MapReader map(node, kDeviceKeys, faults);
  if (const Node* delay = map.find("delay")) read_delay(*delay, device.delay, faults);
  map.read("loss", device.loss, kProbability);
  if (const Node* late = map.find("late")) {
    MapReader inner(*late, kLateKeys, faults);
    inner.read_required("probability", device.late_probability, kProbability, "0 to 1");
    inner.read_required("by", device.late, DurationRule{1ms, 1min}, "a duration such as 300ms");
  }
  map.read("queue", device.queues, FlagRule{});
  if (const Node* doubled = map.find("doubled")) {
    MapReader inner(*doubled, kDoubledKeys, faults);
    inner.read_required("probability", device.doubled, kProbability, "0 to 1");
    inner.read("after", device.doubled_after, DurationRule{0s, 1min});
  }
  map.read("deaf", device.deaf, DurationRule{0s, 1min});
  map.read("garble", device.garble, kProbability);
  map.read("truncate", device.truncate, kProbability);
  map.read("stray", device.stray, kProbability);
  if (const Node* silence = map.find("silence")) read_silence(*silence, device, faults);
  if (const Node* exceptions = map.find("exceptions"))
    read_exceptions(*exceptions, device, areas, faults);
  map.read("only-configured", device.only_configured, FlagRule{});
}

void read_unplug(const Node& node, BusFaults& bus, FaultList& faults) {
  bus.unplugged.clear();
  each(node, "unplug", faults, [&](const Node& item) {
    Window window;
    Duration length{};
    MapReader map(item, kUnplugKeys, faults);
    map.read_required("at", window.from, kMoment, "seconds after the start, such as 10s");
    if (map.read("for", length, kMoment)) window.to = window.from + length;
    bus.unplugged.push_back(window);
  });
}

std::vector<const Node*> about(const Node& names, std::string_view name) {
  std::vector<const Node*> found;
  for (const std::string_view wanted : {std::string_view("*"), name}) {
    for (const auto& [key, value] : names.entries) {
      if (key->text == wanted) found.push_back(value);
    }
  }
  return found;
}

template <typename Specs>
void check_names(const Node& names, std::string_view what, const Specs& specs, FaultList& faults) {
  if (names.kind != Kind::kMap) {
    faults.add(names.position, fmt::format("{} names are {}", what, to_text(names.kind)),
               "a map by name, or \"*\" for all");
    return;
  }
  std::vector<std::string_view> known;
  for (const auto& spec : specs) known.push_back(spec.name);
  for (const auto& [key, value] : names.entries) {
    if (key->text == "*" || std::ranges::find(known, key->text) != known.end()) continue;
    faults.add(key->position, fmt::format("no {} '{}' in the configuration", what, key->text),
               config::joined(known) + ", \"*\"", config::closest(key->text, known));
  }
}

void read_bus(const Node& node, BusFaults& bus, const BusSpec& spec, FaultList& faults) {
  MapReader map(node, kBusKeys, faults);
  map.read("noise", bus.noise, kProbability);
  map.read("echo", bus.echo, FlagRule{});
  if (const Node* babble = map.find("babble")) {
    MapReader inner(*babble, kBabbleKeys, faults);
    inner.read_required("rate", bus.babble, BoundedRule{0, 1000}, "bursts a second");
    inner.read("length", bus.babble_length, WholeRule{1, 256});
  }
  map.read("foreign", bus.foreign, BoundedRule{0, 1000});
  if (const Node* unplug = map.find("unplug")) read_unplug(*unplug, bus, faults);
  map.read("fifo", bus.fifo, WholeRule{0, 4096});
  const Node* devices = map.find("devices");
  if (devices == nullptr) return;
  check_names(*devices, "device", spec.devices, faults);
  for (const DeviceSpec& device : spec.devices) {
    for (const Node* found : about(*devices, device.name)) {
      read_device(*found, bus.devices[device.name], area_names(device), faults);
    }
  }
}

}  // namespace

LoadedFaults parse_faults(std::string_view text, const std::string& file_name,
                          const BridgeSpec& plant) {
  if (!config::is_empty(text) && !config::has_top_key(text, {"buses"}))
    return tl::unexpected(
        std::vector{config::Fault{file_name, 1, 1, "this is no file of faults", "buses: ..", {}}});
  FaultList faults;
  Faults all;
  const auto document = config::parse_yaml(config::Source{file_name, std::string(text), 0}, faults);
  if (document->root != nullptr) {
    MapReader map(*document->root, kFileKeys, faults);
    if (const Node* buses = map.require("buses", "a map of buses by name")) {
      check_names(*buses, "bus", plant.buses, faults);
      for (const BusSpec& bus : plant.buses) {
        for (const Node* found : about(*buses, bus.name))
          read_bus(*found, all.buses[bus.name], bus, faults);
      }
    }
  }
  if (!faults.empty()) return tl::unexpected(faults.take());
  return all;
}

LoadedFaults load_faults(const std::string& path, const BridgeSpec& plant) {
  const auto text = config::disk_reader().read(path);
  if (!text)
    return tl::unexpected(std::vector{
        config::Fault{path, 1, 1, fmt::format("the file {}", to_text(text.error())), {}, {}}});
  return parse_faults(*text, path, plant);
}

}  // namespace fieldcast::sim
