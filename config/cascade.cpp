#include "config/cascade.hpp"

#include "config/limits.hpp"
#include "config/scalars.hpp"

namespace fieldcast::config {
namespace {

constexpr std::pair<std::string_view, Mode> kModes[] = {{"intensive", Mode::kIntensive},
                                                        {"scheduled", Mode::kScheduled},
                                                        {"on-demand", Mode::kOnDemand}};
constexpr std::pair<std::string_view, Access> kAccesses[] = {{"read-only", Access::kReadOnly},
                                                             {"read-write", Access::kReadWrite},
                                                             {"write-only", Access::kWriteOnly}};
constexpr std::pair<std::string_view, bool> kAcquires[] = {{"always", false},
                                                           {"on-interest", true}};
constexpr std::pair<std::string_view, WordOrder> kWordOrders[] = {
    {"big-endian", WordOrder::kBigEndian}, {"little-endian", WordOrder::kLittleEndian}};
constexpr std::pair<std::string_view, ByteOrder> kByteOrders[] = {
    {"big-endian", ByteOrder::kBigEndian}, {"little-endian", ByteOrder::kLittleEndian}};

constexpr std::pair<std::string_view, Charset> kCharsets[] = {{"utf-8", Charset::kUtf8},
                                                              {"latin-1", Charset::kLatin1},
                                                              {"gbk", Charset::kGbk},
                                                              {"shift-jis", Charset::kShiftJis}};

}  // namespace

void read_channel_defaults(MapReader& map, ChannelDefaults& defaults) {
  map.read("refresh", defaults.refresh, DurationRule{kMinRefresh, kMaxRefresh});
  map.read("mode", defaults.mode, ChoiceRule<Mode>{kModes});
  map.read("access", defaults.access, ChoiceRule<Access>{kAccesses});
  map.read("acquire", defaults.on_interest, ChoiceRule<bool>{kAcquires});
  map.read("priority", defaults.priority, WholeRule{-kMaxPriority, kMaxPriority});
  map.read("elasticity", defaults.elasticity, NumberRule{kMinElasticity, kMaxElasticity});
  map.read("word-order", defaults.word_order, ChoiceRule<WordOrder>{kWordOrders});
  map.read("byte-order", defaults.byte_order, ChoiceRule<ByteOrder>{kByteOrders});
  map.read("encoding", defaults.charset, ChoiceRule<Charset>{kCharsets});
  map.read("heartbeat", defaults.heartbeat, DurationRule{kMinRefresh, kMaxRefresh});
}

void read_device_defaults(MapReader& map, DeviceDefaults& defaults) {
  map.read("timeout", defaults.timeout, DurationRule{kMinTimeout, kMaxTimeout});
  map.read("retries", defaults.retries, WholeRule{0, kMaxRetries});
  map.read("pause", defaults.pause, DurationRule{Duration{}, kMaxPause});
  map.read("max-block", defaults.max_block, WholeRule{1, 65535});
  map.read("max-gap", defaults.max_gap, WholeRule{0, 65535});
  read_channel_defaults(map, defaults.channels);
}

// allow: [raw-read, raw-write]
void read_allow(MapReader& map, DeviceDefaults& defaults) {
  const Node* node = map.find("allow");
  if (node == nullptr) return;
  static constexpr std::pair<std::string_view, int> kRights[] = {{"raw-read", 0}, {"raw-write", 1}};
  if (node->kind != Kind::kList) {
    map.faults().add(node->place, "allow is " + std::string(to_text(node->kind)),
                     "a list of raw-read, raw-write",
                     node->kind == Kind::kScalar ? '[' + node->text + ']' : "");
    return;
  }
  defaults.allow_raw_read = defaults.allow_raw_write = false;
  for (const Node* item : node->items) {
    const auto right = ChoiceRule<int>{kRights}(*item, "allow", map.faults());
    if (right) (*right == 0 ? defaults.allow_raw_read : defaults.allow_raw_write) = true;
  }
}

// options: { name: value }
void read_options(MapReader& map, DeviceDefaults& defaults) {
  const Node* node = map.find("options");
  if (node == nullptr) return;
  if (node->kind != Kind::kMap || node->entries.size() > kMaxOptions) {
    map.faults().add(
        node->place,
        node->kind == Kind::kMap ? "too many options"
                                 : "options is " + std::string(to_text(node->kind)),
        "a map of at most " + std::to_string(kMaxOptions) + " options of the protocol");
    return;
  }
  for (const auto& [key, value] : node->entries) {
    const auto text = TextRule{kMaxDescription}(*value, key->text, map.faults());
    if (!text) continue;
    defaults.options.texts[key->text] = *text;
    defaults.options.places[key->text] = key->place;
  }
}

}  // namespace fieldcast::config
