#include "config/calculate/calculations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "config/calculate/expression.hpp"
#include "config/document/suggest.hpp"

namespace fieldcast::config {
namespace {

// The position of a byte of the value, or of the value if its text is written in another way.
Position place_in(const Node& node, std::size_t byte) {
  Position position = node.position;
  std::string_view line = position.source->line(position.line);
  line = line.substr(std::min<std::size_t>(position.column, line.size()));
  const std::size_t quote = line.starts_with('"') || line.starts_with('\'') ? 1 : 0;
  if (line.substr(std::min(quote, line.size())).starts_with(node.text))
    position.column += static_cast<std::uint32_t>(quote + byte);
  return position;
}

constexpr std::size_t kMostCompared = 1'000;  // names, for a hint

// The nearest name of a list, by the member `name` of its items.
template <typename Items>
std::string nearest(std::string_view word, const Items& items) {
  std::vector<std::string_view> names;
  if (items.size() > kMostCompared) return {};
  for (const auto& item : items) names.emplace_back(item.name);
  return closest(word, names);
}

template <typename Items>
const auto* named(const Items& items, std::string_view name) {
  const auto found = std::ranges::find(
      items, name, [](const auto& item) -> std::string_view { return item.name; });
  return found == items.end() ? nullptr : &*found;
}

struct Item {
  ChannelPath path;
  ChannelSpec* channel;
  const Node* place;
  Expression expression;
  std::vector<ChannelPath> inputs;
  std::vector<ChannelSpec*> channels;  // of the inputs
  std::vector<std::size_t> items;      // the inputs that are calculated
  std::vector<std::size_t> users;      // calculated channels that have it as an input
  std::size_t waits_for = 0;           // of `items`: those that are not complete
  std::size_t depth = 1;
  bool bad = false;
};

class Completion {
 public:
  Completion(BridgeSpec& spec, std::span<const Node* const> places, FaultList& faults)
      : spec_(spec), faults_(faults) {
    for (BusSpec& bus : spec.buses) {
      for (DeviceSpec& device : bus.devices) {
        for (ChannelSpec& channel : device.channels) {
          channels_.emplace(ChannelPath{bus.name, device.name, channel.name}.text(), &channel);
          if (!channel.calculation || items_.size() == places.size()) continue;
          index_.emplace(&channel, items_.size());
          items_.push_back({{bus.name, device.name, channel.name},
                            &channel,
                            places[items_.size()],
                            {},
                            {},
                            {},
                            {}});
        }
      }
    }
  }

  void run() {
    for (Item& item : items_)
      if (!faults_.full()) find_inputs(item);
    in_order();
    report_cycle();
  }

 private:
  void fault(Item& item, std::size_t at, std::string_view what, std::string_view allowed = {},
             std::string_view suggestion = {}) {
    item.bad = true;
    faults_.add(place_in(*item.place, at), fmt::format("calculate, character {}: {}", at + 1, what),
                allowed, suggestion);
  }

  void find_inputs(Item& item) {
    item.bad = item.place == nullptr;
    if (item.bad) return;
    auto parsed = parse_expression(item.channel->calculation.value->expression);
    if (!parsed) {
      const ExpressionFault& error = parsed.error();
      return fault(item, error.at, error.what, error.allowed, error.suggestion);
    }
    item.expression = std::move(*parsed);
    for (const Expression::Name& name : item.expression.names) {
      ChannelSpec* const channel = find(item, name);
      if (channel == nullptr) continue;
      if (channel->encoding.type == ValueType::kString)
        fault(item, name.at, fmt::format("'{}' is a text", name.text), "a number or a bool");
      if (channel->access == Access::kWriteOnly)
        fault(item, name.at, fmt::format("'{}' is write-only and is never read", name.text),
              "a channel that is read");
      item.channels.push_back(channel);
      const auto calculated = index_.find(channel);
      if (calculated == index_.end()) continue;
      item.items.push_back(calculated->second);
      items_[calculated->second].users.push_back(static_cast<std::size_t>(&item - items_.data()));
      ++item.waits_for;
    }
  }

  // Null with a fault if there is no such channel.
  ChannelSpec* find(Item& item, const Expression::Name& name) {
    const auto parts = static_cast<std::size_t>(std::ranges::count(name.text, '/'));
    const auto path = ChannelPath::parse(name.text);
    if (parts != 0 && !path) {
      fault(item, name.at, fmt::format("'{}' is not the name of a channel", name.text),
            "CHANNEL of this device, or {BUS/DEVICE/CHANNEL}");
      return nullptr;
    }
    const ChannelPath wanted =
        path ? *path : ChannelPath{item.path.bus, item.path.device, name.text};
    if (const auto found = channels_.find(wanted.text()); found != channels_.end()) {
      item.inputs.push_back(wanted);
      return found->second;
    }
    const auto missing = [&](std::string_view kind, std::string_view part, std::string meant) {
      if (!meant.empty()) meant = as_written(path ? replaced(wanted, kind, meant) : meant);
      fault(item, name.at, fmt::format("there is no {} '{}'", kind, part),
            "CHANNEL of this device, or {BUS/DEVICE/CHANNEL} of this bridge", meant);
      return nullptr;
    };
    const auto* const bus = named(spec_.buses, wanted.bus);
    if (bus == nullptr) return missing("bus", wanted.bus, nearest(wanted.bus, spec_.buses));
    const auto* const device = named(bus->devices, wanted.device);
    if (device == nullptr)
      return missing("device", wanted.device, nearest(wanted.device, bus->devices));
    return missing("channel", wanted.channel, nearest(wanted.channel, device->channels));
  }

  static std::string replaced(ChannelPath path, std::string_view kind, const std::string& part) {
    (kind == "bus" ? path.bus : kind == "device" ? path.device : path.channel) = part;
    return path.text();
  }

  // Completes each channel behind its inputs; those of a cycle are left.
  void in_order() {
    std::vector<std::size_t> ready;
    for (std::size_t i = 0; i < items_.size(); ++i)
      if (items_[i].waits_for == 0) ready.push_back(i);
    while (!ready.empty()) {
      Item& item = items_[ready.back()];
      ready.pop_back();
      complete(item);
      for (const std::size_t user : item.users) {
        items_[user].depth = std::max(items_[user].depth, item.depth + 1);
        if (--items_[user].waits_for == 0) ready.push_back(user);
      }
    }
  }

  void complete(Item& item) {
    if (!item.bad && item.depth > kMaxCalculationDepth)
      fault(item, 0, "too many calculated channels that use each other",
            fmt::format("{} from the first to the last", kMaxCalculationDepth));
    if (item.bad) return;
    const auto formula = compile(item.expression);
    if (!formula)
      return fault(item, formula.error().at, formula.error().what, formula.error().allowed);
    ChannelSpec& channel = *item.channel;
    auto whole = std::make_shared<Calculation>();
    whole->expression = channel.calculation.value->expression;
    whole->inputs = item.inputs;
    whole->remark = remark_on(item);
    whole->compile = [expression = item.expression] { return compile(expression).value(); };
    channel.calculation.value = std::move(whole);
    set_refresh(item);
  }

  // The slowest input decides: each new sample of it leads to one of the channel.
  static void set_refresh(const Item& item) {
    ChannelSpec& channel = *item.channel;
    channel.refresh = Duration::zero();
    for (const ChannelSpec* input : item.channels) {
      const auto gap = promised_gap(*input);
      if (!gap) channel.mode = Mode::kOnDemand;  // without a promise
      channel.refresh = std::max(channel.refresh, gap.value_or(input->refresh));
    }
  }

  static std::string remark_on(const Item& item) {
    for (const auto& [left, right] : item.expression.sums) {
      const std::string& one = item.channels[left]->unit;
      const std::string& two = item.channels[right]->unit;
      if (!one.empty() && !two.empty() && one != two)
        return fmt::format("{}: + or - combines {} in {} with {} in {}", item.path.text(),
                           item.expression.names[left].text, one, item.expression.names[right].text,
                           two);
    }
    return {};
  }

  // Follows inputs that are not complete until one appears for the second time.
  void report_cycle() {
    for (std::size_t start = 0; start < items_.size(); ++start) {
      std::vector<std::size_t> way;
      std::size_t at = start;
      while (items_[at].waits_for != 0 && std::ranges::find(way, at) == way.end()) {
        way.push_back(at);
        at = *std::ranges::find_if(items_[at].items,
                                   [&](std::size_t input) { return items_[input].waits_for != 0; });
      }
      if (way.empty()) continue;
      const auto first = std::ranges::find(way, at);
      std::string names;
      for (auto each = first; each != way.end(); ++each)
        names += items_[*each].path.text() + " -> ";
      fault(items_[at], 0,
            fmt::format("calculated from itself: {}{}", names, items_[at].path.text()),
            "channels that do not use each other in a circle");
      return;
    }
  }

  BridgeSpec& spec_;
  FaultList& faults_;
  std::vector<Item> items_;
  std::map<const ChannelSpec*, std::size_t> index_;
  std::unordered_map<std::string, ChannelSpec*> channels_;  // by path
};

}  // namespace

void complete_calculations(BridgeSpec& spec, std::span<const Node* const> places,
                           FaultList& faults) {
  if (places.empty()) return;
  if (places.size() > kMaxCalculated) {
    const Node* const one_more = places[kMaxCalculated];
    if (one_more != nullptr)
      faults.add(one_more->position, "too many calculated channels",
                 fmt::format("{} of a bridge", kMaxCalculated));
    return;
  }
  Completion(spec, places, faults).run();
}

}  // namespace fieldcast::config
