// Neuron tags: JSON of its API (nodes, groups, tags), and tables exported from its pages.
//
// Source: emqx/neuron docs/api/english/http.md (JSON), plugins/modbus/modbus-tcp.json and
// modbus-rtu.json (settings), plugins/modbus/modbus_point.c and src/base/tag.c (addresses, #BB),
// docs.emqx.com/en/neuron (columns of the tables).
#include <algorithm>
#include <array>
#include <functional>

#include "tools/import/formats/format.hpp"
#include "tools/import/points/address.hpp"
#include "tools/import/points/names.hpp"
#include "tools/import/points/types.hpp"
#include "tools/import/text/table.hpp"

namespace fieldcast::importing {
namespace {

constexpr unsigned kMaxShells = 8;  // lists and maps around the nodes

// Baud rates by their number in the settings of a serial node.
constexpr std::array kBauds{115200u, 57600u, 38400u, 19200u, 9600u, 4800u, 2400u,
                            1800u,   1200u,  600u,   300u,   200u,  150u};
// Types by their number. "bytes" has no counterpart.
constexpr std::array<std::string_view, 19> kTypes{
    "",       "int8", "uint8", "int16",  "uint16", "int32", "uint32", "int64", "uint64", "float",
    "double", "bit",  "bool",  "string", "bytes",  "",      "word",   "dword", "lword"};

struct NeuronOrder {
  std::string_view suffixes;  // of the address, after '#'
  unsigned setting;           // equivalent setting of the node
  Orders orders;
};
constexpr NeuronOrder kOrders[] = {
    {"LL L", 1, {WordOrder::kBigEndian, ByteOrder::kBigEndian}},
    {"LB", 2, {WordOrder::kBigEndian, ByteOrder::kLittleEndian}},
    {"BB B", 3, {WordOrder::kLittleEndian, ByteOrder::kLittleEndian}},
    {"BL", 4, {WordOrder::kLittleEndian, ByteOrder::kBigEndian}}};

struct NeuronOrders {
  unsigned of_32 = 1, of_64 = 1;
  std::uint32_t base = 1;  // first address
};

constexpr std::string_view kTagKeys = "name address type attribute decimal bias description";
using TextAt = std::function<std::string_view(std::string_view key)>;  // keys of kTagKeys

class TagReader {
 public:
  TagReader(TextAt at, const NeuronOrders& orders) : at_(std::move(at)), orders_(orders) {}

  MayFail read(Point& point) {
    point.description = at_("description");
    if (auto fault = read_type(point)) return fault;
    if (auto fault = read_address(point)) return fault;
    if (auto fault = read_orders(point)) return fault;
    read_attribute(point);
    if (const auto factor = number_from(at_("decimal")); factor && *factor != 0)
      point.scale = *factor;
    point.offset = number_from(at_("bias")).value_or(0);
    return std::nullopt;
  }
  [[nodiscard]] std::uint16_t slave() const { return slave_; }

 private:
  MayFail read_type(Point& point) const {
    std::string word = lower(at_("type"));
    if (const auto number = whole_from(word)) word = *number < kTypes.size() ? kTypes[*number] : "";
    const bool known = !word.empty() && std::ranges::find(kTypes, word) != kTypes.end();
    const auto type = known ? type_by_name(word) : std::nullopt;
    if (!type) return fmt::format("the type {} has no counterpart", at_("type"));
    point.type = type->type;
    return std::nullopt;
  }

  // "1!400001", "1!400001.4", "1!400010.20H", "1!400001#BB"
  MayFail read_address(Point& point) {
    const std::string_view text = at_("address");
    const auto [slave_text, behind] = halves(trimmed(text), '!');
    const auto [place, suffix] = halves(behind, '#');
    const auto [digits, part] = halves(place, '.');
    const auto slave = whole_from<std::uint16_t>(slave_text, 0, 255);
    const auto area = digits.empty() ? std::nullopt : area_of_digit(digits[0]);
    const auto number =
        area ? whole_from(digits.substr(1), orders_.base, 65535 + std::uint64_t{orders_.base})
             : std::nullopt;
    if (!slave || !number) return fmt::format("'{}' is no address of Modbus (1!400001)", text);
    slave_ = *slave;
    suffix_ = suffix;
    area_ = *area;
    if (auto fault = read_part(part, point)) return fault;
    point.at = address_text(area_, *number - orders_.base, point.bit);
    return std::nullopt;
  }

  MayFail read_part(std::string_view part, Point& point) const {
    if (point.type == ValueType::kString) {
      const bool low = part.ends_with('L');
      if (part.ends_with('D') || part.ends_with('E')) return kSparseText;
      if (low || part.ends_with('H')) part.remove_suffix(1);
      const auto bytes = whole_from<std::uint16_t>(part, 1, kMaxStringBytes);
      if (!bytes) return "a text without a length of 1 to 250 bytes";
      point.string_bytes = *bytes;
      point.set_orders(false, low);
    } else if (holds_bits(area_)) {
      if (point.type != ValueType::kBool) return "a number at a single bit";
    } else if (point.type == ValueType::kBool) {
      point.bit = whole_from<std::uint8_t>(part, 0, 15);
      if (!point.bit) return "a bit of a register without its number";
    } else if (is_byte(point.type)) {
      point.byte = 0;
    }
    return std::nullopt;
  }

  MayFail read_orders(Point& point) const {
    if (!is_number(point.type) || point.byte) return std::nullopt;
    const unsigned registers = registers_of(point.type, 0);
    const auto found = std::ranges::find_if(kOrders, [&](const NeuronOrder& order) {
      if (!suffix_.empty()) return is_one_of(suffix_, order.suffixes);
      return registers == 1 || order.setting == (registers == 4 ? orders_.of_64 : orders_.of_32);
    });
    if (found == std::end(kOrders))
      return fmt::format("an order of bytes that no channel has (#{})", suffix_);
    if (registers > 1) point.word_order = found->orders.words;
    point.byte_order = found->orders.bytes;
    return std::nullopt;
  }

  // A sum of 1 (read), 2 (write) and 4 (subscribe), or words.
  void read_attribute(Point& point) const {
    const std::string words = lower(at_("attribute"));
    const auto number = whole_from(words);
    const bool writes = number ? (*number & 2) != 0 : contains(words, "write");
    const bool reads =
        number ? (*number & 5) != 0 : contains(words, "read") || contains(words, "subscribe");
    if (writes && can_be_written(area_))
      point.access = reads ? Access::kReadWrite : Access::kWriteOnly;
  }

  const TextAt at_;
  const NeuronOrders& orders_;
  std::uint16_t slave_ = 0;
  std::string_view suffix_;
  ModbusArea area_ = ModbusArea::kHolding;
};

class NeuronReader : TreeReader {
 public:
  NeuronReader(const SourceText& source, const ReadOptions& options, Found& found)
      : TreeReader(source, found), base_(options.base) {}

  void read_tree(const Node& root) {
    read(root, 0);
    tell_others();
  }

  void read_table(const Table& table) {
    std::vector<std::string> titles;
    for (const std::string& title : table.rows[0].cells) {
      const std::string& word = titles.emplace_back(column_word(title));
      if (!word.empty() && !is_one_of(word, kTagKeys) && !is_one_of(word, "group interval"))
        found_.note("{}: column '{}' is not moved", source_.file, title);
    }
    const auto cell_at = [&](const Row& row, std::string_view key) {
      return row.cell(static_cast<std::size_t>(std::ranges::find(titles, key) - titles.begin()));
    };
    Bus& bus = found_.buses.emplace_back();
    NeuronOrders orders;
    tell_base(orders, std::nullopt);
    const std::span rows = std::span(table.rows).subspan(1);
    const bool grouped = std::ranges::any_of(
        rows, [&](const Row& row) { return cell_at(row, "group") != cell_at(rows[0], "group"); });
    for (const Row& row : rows)
      add(
          bus, stem_of(source_.file), [&](std::string_view key) { return cell_at(row, key); },
          grouped ? cell_at(row, "group") : std::string_view(), grouped, cell_at(row, "interval"),
          orders, row.line);
    if (bus.devices.size() == 1) bus.devices.front().name = stem_of(source_.file);
  }

 private:
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

  void read_node(const Node& node) {
    other_keys_.look(node, "a node", "name node plugin params setting groups tags group interval");
    const std::string name(first_text(node, {"name", "node"}));
    const std::string plugin = lower(text_at(node, "plugin"));
    if (!plugin.empty() && !contains(plugin, "modbus"))
      return refuse(node, name, fmt::format("its plugin {} is not Modbus", plugin));
    Bus bus;
    bus.name = name;
    bus.origin = origin_of(node);
    NeuronOrders orders;
    const Node* settings = child(node, "params");
    if (settings == nullptr) settings = child(node, "setting");
    Device common;
    if (is_map(settings)) read_settings(*settings, plugin, bus, common, orders);
    tell_base(orders, is_map(settings) ? whole_at(*settings, "address_base") : std::nullopt);
    const Node* groups = child(node, "groups");
    if (is_list(groups)) {
      for (const Node* group : groups->items)
        read_group(*group, groups->items.size() > 1, bus, name, orders);
    } else {
      read_group(node, false, bus, name, orders);
    }
    for (Device& device : bus.devices) {
      device.timeout = common.timeout;
      device.pause = common.pause;
      if (bus.devices.size() == 1) device.name = name;
    }
    found_.buses.push_back(std::move(bus));
  }

  void read_settings(const Node& settings, std::string_view plugin, Bus& bus, Device& common,
                     NeuronOrders& orders) {
    other_keys_.look(settings, "the settings",
                     "host port device link baud parity data stop connection_mode timeout interval "
                     "address_base endianess endianess_64");
    const auto device = text_at(settings, "device");
    if (!device.empty() && whole_at(settings, "link").value_or(0) == 0) {
      bus.port.serial = device;
      bus.protocol = "modbus-rtu";
      if (const auto baud = whole_at(settings, "baud"); baud && *baud < kBauds.size())
        bus.port.line.baud = kBauds[*baud];
      bus.port.usual = {9600, "Neuron's page"};
      const auto parity = whole_at(settings, "parity").value_or(0);
      if (parity >= 3)
        bus.fault = "its line has the parity mark or space; a bus has none, odd or even";
      bus.port.line.format = fmt::format(
          "{}{}{}", 5 + std::min<std::uint64_t>(whole_at(settings, "data").value_or(3), 3),
          std::string_view("NOE")[parity < 3 ? parity : 0],
          whole_at(settings, "stop") == 1u ? 2 : 1);
    } else if (!text_at(settings, "host").empty()) {
      bus.port.tcp = tcp_at(settings, "host", "port");
      bus.protocol = contains(plugin, "rtu") ? "modbus-rtu" : "modbus-tcp";
    }
    if (whole_at(settings, "connection_mode") == 1u)
      found_.note("{}: devices that connect to Neuron are not moved; they are asked at {}",
                  bus.name, bus.port.tcp);
    common.timeout = milliseconds_from(text_at(settings, "timeout"), 1, 60'001);
    common.pause = milliseconds_from(text_at(settings, "interval"), 1, 60'001);
    orders.of_32 = static_cast<unsigned>(whole_at(settings, "endianess").value_or(1));
    orders.of_64 = static_cast<unsigned>(whole_at(settings, "endianess_64").value_or(1));
  }

  void read_group(const Node& group, bool several, Bus& bus, const std::string& node,
                  const NeuronOrders& orders) {
    const Node* tags = child(group, "tags");
    if (!is_list(tags)) return;
    const std::string_view name = first_text(group, {"group", "name"});
    for (const Node* tag : tags->items) {
      other_keys_.look(*tag, "a tag", kTagKeys);
      add(
          bus, node, [tag](std::string_view key) { return text_at(*tag, key); }, name, several,
          text_at(group, "interval"), orders, line_of(*tag));
    }
  }

  // `in_group`: the name of the group is part of the point's name. `interval`: in ms.
  void add(Bus& bus, const std::string& node, const TextAt& text, std::string_view group,
           bool in_group, std::string_view interval, const NeuronOrders& orders, unsigned line) {
    Point point;
    point.name = in_group ? fmt::format("{}.{}", group, text("name")) : std::string(text("name"));
    point.origin = {source_.file, line};
    point.refresh = milliseconds_from(interval, 1, 8e7);
    TagReader tag(text, orders);
    if (auto fault = tag.read(point))
      return found_.refuse(point.name, point.origin, std::move(*fault));
    Device& device = device_at(bus, tag.slave());
    if (device.name.empty()) device.name = fmt::format("{}-{}", node, tag.slave());
    device.points.push_back(std::move(point));
  }

  // `said`: the first address in the settings; the user's own has priority.
  void tell_base(NeuronOrders& orders, std::optional<std::uint64_t> said) {
    orders.base = base_ ? *base_ : said == 0u ? 0 : 1;
    if (!said && !base_)
      found_.guesses.push_back(
          {source_.file, 1, "a node of Neuron has its setting Start Address at 1 by default"});
  }

  const std::optional<unsigned> base_;  // set by the user
};

bool is_neuron_table(const Table& table) {
  if (table.rows.size() < 2) return false;
  return std::ranges::count_if(table.rows[0].cells, [](const std::string& cell) {
           return is_one_of(column_word(cell), "group name address attribute type");
         }) == 5;
}

bool is_json(std::string_view text) {
  const std::string_view begin = trimmed(text.substr(0, 1000));
  return begin.starts_with('{') || begin.starts_with('[');
}

Confidence recognise_neuron(const SourceText& source) {
  const std::string_view text = source.text;
  if (is_json(text))
    return confidence_by(
        text, {{R"("tags" "address" "attribute" !)", kCertain}, {R"("tags" "address")", kLikely}});
  const auto table = read_table(text.substr(0, text.find('\n', 4096)));
  if (!table || !is_neuron_table(*table)) return 0;
  return contains(text, "!") ? kCertain : kLikely;
}

Read read_neuron(Sources sources, const ReadOptions& options) {
  return read_each(sources, [&](const SourceText& source, Found& found) -> MayFail {
    NeuronReader reader(source, options, found);
    if (is_json(source.text)) {
      const auto tree = read_json(source.text);
      if (!tree) return tree.error();
      reader.read_tree(*(*tree)->root);
    } else {
      const auto table = read_table(source.text);
      if (!table) return table.error();
      if (!is_neuron_table(*table))
        return "no columns group, name, address, attribute, type in its first row";
      reader.read_table(*table);
    }
    return std::nullopt;
  });
}

}  // namespace

constinit const Format kNeuronFormat{"neuron", "Neuron tags (JSON, CSV, Excel)", recognise_neuron,
                                     read_neuron};

}  // namespace fieldcast::importing
