// Neuron tags: JSON of its API (nodes, groups, tags), and tables exported from its pages.
//
// Source: emqx/neuron docs/api/english/http.md (JSON), plugins/modbus/modbus-tcp.json and
// modbus-rtu.json (settings), plugins/modbus/modbus_point.c and src/base/tag.c (addresses, #BB),
// docs.emqx.com/en/neuron (columns of the tables).
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "tools/import/formats/format.hpp"
#include "tools/import/formats/neuron_tag.hpp"
#include "tools/import/points/address.hpp"
#include "tools/import/points/names.hpp"
#include "tools/import/text/table.hpp"
#include "tools/import/text/text.hpp"
#include "tools/import/text/tree.hpp"

namespace fieldcast::importing {
namespace {

constexpr unsigned kMaxShells = 8;  // lists and maps around the nodes

// Baud rates by their number in the settings of a serial node.
constexpr std::array kBauds{115200u, 57600u, 38400u, 19200u, 9600u, 4800u, 2400u,
                            1800u,   1200u,  600u,   300u,   200u,  150u};

class NeuronReader {
 public:
  NeuronReader(const SourceText& source, const ReadOptions& options, Found& found)
      : source_(source), found_(found), base_(options.base) {}

  void read(const Node& node, unsigned depth) {
    if (depth > kMaxShells) return;
    if (is_list(&node)) {
      for (const Node* item : node.items) read(*item, depth + 1);
      return;
    }
    for (const std::string_view shell : {"nodes", "drivers", "data"}) {
      if (const Node* inner = child(node, shell); is_list(inner)) return read(*inner, depth + 1);
    }
    if (is_list(child(node, "groups")) || is_list(child(node, "tags"))) read_node(node);
  }

  void tell_others() const { other_keys_.tell(source_.file, found_); }

  void read_table(const Table& table) {
    for (const std::string& title : table.rows[0].cells) {
      constexpr std::array kKnown{"group",     "interval", "name", "address",     "type",
                                  "attribute", "decimal",  "bias", "description", ""};
      if (std::ranges::find(kKnown, column_word(title)) == kKnown.end())
        found_.notes.push_back(fmt::format("{}: column '{}' is not moved", source_.file, title));
    }
    const auto column = [&](std::string_view word) -> std::size_t {
      const auto& titles = table.rows[0].cells;
      const auto found = std::ranges::find(titles, word, column_word);
      return static_cast<std::size_t>(found - titles.begin());
    };
    const std::size_t group = column("group"), interval = column("interval");
    const std::array columns{column("name"),       column("address"), column("type"),
                             column("attribute"),  column("decimal"), column("bias"),
                             column("description")};
    Bus& bus = found_.buses.emplace_back();
    NeuronOrders orders;
    orders.base = base_.value_or(1);
    tell_base(false);
    bool grouped = false;
    for (std::size_t i = 2; i < table.rows.size(); ++i)
      grouped |= table.rows[i].cell(group) != table.rows[1].cell(group);
    for (std::size_t i = 1; i < table.rows.size(); ++i) {
      const Row& row = table.rows[i];
      NeuronTag tag;
      tag.name = row.cell(columns[0]);
      if (grouped) tag.name = fmt::format("{}.{}", row.cell(group), tag.name);
      tag.address = row.cell(columns[1]);
      tag.type = row.cell(columns[2]);
      tag.attribute = row.cell(columns[3]);
      tag.decimal = number_from(row.cell(columns[4]));
      tag.bias = number_from(row.cell(columns[5]));
      tag.description = row.cell(columns[6]);
      tag.interval_ms = number_from(row.cell(interval));
      add(bus, stem_of(source_.file), tag, orders, {source_.file, row.line});
    }
    if (bus.devices.size() == 1) bus.devices.front().name = stem_of(source_.file);
  }

 private:
  void read_node(const Node& node) {
    other_keys_.look(
        node, "a node",
        {"name", "node", "plugin", "params", "setting", "groups", "tags", "group", "interval"});
    std::string name(text_at(node, "name"));
    if (name.empty()) name = text_at(node, "node");
    const std::string plugin = lower(text_at(node, "plugin"));
    if (!plugin.empty() && plugin.find("modbus") == std::string::npos) {
      found_.refusals.push_back({name,
                                 {source_.file, line_of(node)},
                                 fmt::format("its plugin {} is not Modbus", plugin)});
      return;
    }
    Bus bus;
    bus.name = name;
    bus.origin = {source_.file, line_of(node)};
    NeuronOrders orders;
    orders.base = base_.value_or(1);
    bool says_base = false;
    const Node* settings = child(node, "params");
    if (settings == nullptr) settings = child(node, "setting");
    if (is_map(settings)) read_settings(*settings, plugin, bus, orders, says_base);
    tell_base(says_base);
    const Node* groups = child(node, "groups");
    if (is_list(groups)) {
      for (const Node* group : groups->items)
        read_group(*group, groups->items.size() > 1, bus, name, orders);
    } else {
      read_group(node, false, bus, name, orders);
    }
    for (Device& device : bus.devices) {
      device.timeout = timeout_;
      device.pause = pause_;
      if (bus.devices.size() == 1) device.name = name;
    }
    found_.buses.push_back(std::move(bus));
  }

  void read_settings(const Node& settings, std::string_view plugin, Bus& bus, NeuronOrders& orders,
                     bool& says_base) {
    other_keys_.look(
        settings, "the settings",
        {"host", "port", "device", "link", "baud", "parity", "data", "stop", "connection_mode",
         "timeout", "interval", "address_base", "endianess", "endianess_64"});
    const auto host = text_at(settings, "host");
    const auto device = text_at(settings, "device");
    const bool rtu = plugin.find("rtu") != std::string_view::npos;
    if (!device.empty() && whole_at(settings, "link").value_or(0) == 0) {
      bus.port.serial = device;
      bus.protocol = "modbus-rtu";
      if (const auto baud = whole_at(settings, "baud"); baud && *baud < kBauds.size())
        bus.port.line.baud = kBauds[*baud];
      bus.port.usual = {9600, "Neuron's page"};
      constexpr std::string_view kParities = "NOE";
      const auto parity = whole_at(settings, "parity").value_or(0);
      if (parity >= 3)
        bus.fault = "its line has the parity mark or space; a bus has none, odd or even";
      bus.port.line.format = fmt::format(
          "{}{}{}", 5 + std::min<std::uint64_t>(whole_at(settings, "data").value_or(3), 3),
          kParities[parity < 3 ? parity : 0], 1 + (whole_at(settings, "stop") == 1u ? 1 : 0));
    } else if (!host.empty()) {
      bus.port.tcp = fmt::format("{}:{}", host, whole_at(settings, "port").value_or(502));
      bus.protocol = rtu ? "modbus-rtu" : "modbus-tcp";
    }
    if (whole_at(settings, "connection_mode") == 1u)
      found_.notes.push_back(
          fmt::format("{}: devices that connect to Neuron are not moved; they are asked at {}",
                      bus.name, bus.port.tcp));
    const auto span = [&](std::string_view key) -> std::optional<Duration> {
      const auto number = number_at(settings, key);
      if (!number || *number < 1 || *number > 60'000) return std::nullopt;
      return std::chrono::milliseconds{static_cast<std::int64_t>(*number)};
    };
    timeout_ = span("timeout");
    pause_ = span("interval");
    if (const auto base = whole_at(settings, "address_base"); base && !base_)
      orders.base = *base == 0 ? 0 : 1, says_base = true;
    orders.of_32 = static_cast<unsigned>(whole_at(settings, "endianess").value_or(1));
    orders.of_64 = static_cast<unsigned>(whole_at(settings, "endianess_64").value_or(1));
  }

  void read_group(const Node& group, bool several, Bus& bus, const std::string& node,
                  const NeuronOrders& orders) {
    const Node* tags = child(group, "tags");
    if (!is_list(tags)) return;
    std::string name(text_at(group, "group"));
    if (name.empty()) name = text_at(group, "name");
    for (const Node* item : tags->items) {
      other_keys_.look(*item, "a tag",
                       {"name", "address", "type", "attribute", "decimal", "bias", "description"});
      NeuronTag tag;
      tag.name = text_at(*item, "name");
      if (several) tag.name = fmt::format("{}.{}", name, tag.name);
      tag.address = text_at(*item, "address");
      tag.type = text_at(*item, "type");
      tag.attribute = text_at(*item, "attribute");
      tag.decimal = number_at(*item, "decimal");
      tag.bias = number_at(*item, "bias");
      tag.description = text_at(*item, "description");
      tag.interval_ms = number_at(group, "interval");
      add(bus, node, tag, orders, {source_.file, line_of(*item)});
    }
  }

  void add(Bus& bus, const std::string& node, const NeuronTag& tag, const NeuronOrders& orders,
           const Origin& origin) {
    auto read = read_neuron_tag(tag, orders);
    if (!read) {
      found_.refusals.push_back({tag.name, origin, std::move(read.error())});
      return;
    }
    read->point.origin = origin;
    const auto known = std::ranges::find(bus.devices, read->slave, &Device::address);
    Device& device = known == bus.devices.end() ? bus.devices.emplace_back() : *known;
    device.address = read->slave;
    if (device.name.empty()) device.name = fmt::format("{}-{}", node, read->slave);
    device.points.push_back(std::move(read->point));
  }

  const SourceText& source_;
  Found& found_;
  void tell_base(bool known) {
    if (!known && !base_)
      found_.guesses.push_back({source_.file, 1,
                                "a node of Neuron has its setting Start Address at 1 "
                                "by default"});
  }

  OtherKeys other_keys_;
  std::optional<unsigned> base_;  // set by the user
  std::optional<Duration> timeout_, pause_;
};

bool is_neuron_table(const Table& table) {
  if (table.rows.size() < 2) return false;
  std::size_t titles = 0;
  for (const std::string& cell : table.rows[0].cells) {
    const std::string word = column_word(cell);
    titles += word == "group" || word == "name" || word == "address" || word == "attribute" ||
              word == "type";
  }
  return titles == 5;
}

}  // namespace

Confidence recognise_neuron(const SourceText& source) {
  const std::string_view text = source.text;
  const auto has = [&](std::string_view word) { return text.find(word) != std::string_view::npos; };
  const std::string_view begin = trimmed(text.substr(0, 1000));
  if (begin.starts_with('{') || begin.starts_with('[')) {
    if (!has("\"tags\"") || !has("\"address\"")) return 0;
    return has("\"attribute\"") && has("!") ? kCertain : kLikely;
  }
  const auto table = read_table(text.substr(0, text.find('\n', 4096)));
  if (!table || !is_neuron_table(*table)) return 0;
  return has("!") ? kCertain : kLikely;
}

Read read_neuron(std::span<const SourceText> sources, const ReadOptions& options) {
  Found found;
  for (const SourceText& source : sources) {
    const auto fail = [&](const std::string& what) {
      return tl::unexpected(fmt::format("{}: {}", source.file, what));
    };
    const std::string_view begin = trimmed(std::string_view(source.text).substr(0, 1000));
    if (begin.starts_with('{') || begin.starts_with('[')) {
      const auto tree = read_json(source.text);
      if (!tree) return fail(tree.error());
      NeuronReader reader(source, options, found);
      reader.read(*(*tree)->root, 0);
      reader.tell_others();
    } else {
      const auto table = read_table(source.text);
      if (!table) return fail(table.error());
      if (!is_neuron_table(*table))
        return fail("no columns group, name, address, attribute, type in its first row");
      NeuronReader(source, options, found).read_table(*table);
    }
  }
  return found;
}

}  // namespace fieldcast::importing
