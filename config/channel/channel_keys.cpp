#include "config/channel/channel_keys.hpp"

#include <fmt/format.h>

#include "config/calculate/expression.hpp"
#include "config/channel/channel.hpp"
#include "config/channel/channel_encoding.hpp"
#include "config/document/common_forms.hpp"
#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"

namespace fieldcast::config {

// allow: [raw-read, raw-write].
void read_allow(MapReader& map, DeviceDefaults& defaults) {
  const Node* node = map.find("allow");
  if (node == nullptr) return;
  static constexpr std::pair<std::string_view, int> kRights[] = {{"raw-read", 0}, {"raw-write", 1}};
  if (!is_list(*node, "allow", 0, kAnyCount, "a list of raw-read, raw-write", map.faults(),
               as_list(*node)))
    return;
  defaults.spec.allow_raw_read = defaults.spec.allow_raw_write = false;
  for (const Node* item : node->items) {
    const auto right = ChoiceRule<int>{kRights}(*item, "allow", map.faults());
    if (right) (*right == 0 ? defaults.spec.allow_raw_read : defaults.spec.allow_raw_write) = true;
  }
}

// options: { name: value }.
void read_options(MapReader& map, DeviceDefaults& defaults) {
  const Node* node = map.find("options");
  if (node == nullptr) return;
  if (node->kind != Kind::kMap || node->entries.size() > kMaxOptions) {
    map.faults().add(node->position,
                     node->kind == Kind::kMap ? "too many options"
                                              : fmt::format("options is {}", to_text(node->kind)),
                     fmt::format("a map of at most {} options of the protocol", kMaxOptions));
    return;
  }
  for (const auto& [key, value] : node->entries) {
    const auto text = TextRule{kMaxDescription}(*value, key->text, map.faults());
    if (!text) continue;
    defaults.options.texts[key->text] = *text;
    defaults.options.positions[key->text] = key->position;
  }
}

namespace {

constexpr std::pair<std::string_view, Mode> kModes[] = {{"intensive", Mode::kIntensive},
                                                        {"scheduled", Mode::kScheduled},
                                                        {"on-demand", Mode::kOnDemand}};
constexpr std::pair<std::string_view, Access> kAccesses[] = {{"read-only", Access::kReadOnly},
                                                             {"read-write", Access::kReadWrite},
                                                             {"write-only", Access::kWriteOnly}};
constexpr std::pair<std::string_view, AlarmPriority> kAlarmPriorities[] = {
    {"critical", AlarmPriority::kCritical},
    {"high", AlarmPriority::kHigh},
    {"medium", AlarmPriority::kMedium},
    {"low", AlarmPriority::kLow}};
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

using ChannelRow = Field<ChannelDefaults>;

template <typename T, typename Rule>
ChannelRow channel_row(Key key, T ChannelSpec::*member, Rule rule) {
  return field<ChannelDefaults>(
      std::move(key), [member](ChannelDefaults& channel) -> T& { return channel.spec.*member; },
      rule);
}
template <typename T, typename Rule>
ChannelRow channel_row(Key key, T Encoding::*member, Rule rule) {
  return field<ChannelDefaults>(
      std::move(key),
      [member](ChannelDefaults& channel) -> T& { return channel.spec.encoding.*member; }, rule);
}
template <typename T, typename Rule>
ChannelRow channel_row(Key key, T ChannelDefaults::*member, Rule rule) {
  return field<ChannelDefaults>(std::move(key), member, rule);
}

// Read by channel.cpp, as it depends on the address or the type.
template <typename Rule>
ChannelRow by_channel(Key key, const Rule& rule) {
  if (key.schema.empty()) key.schema = rule.schema();
  if (key.form.empty()) key.form = rule.form();
  return {std::move(key), {}};
}

std::vector<ChannelRow> channel_fields() {
  const ChoiceRule<std::uint8_t> byte{kByteWords};
  return {
      channel_row({.name = "name",
                   .fallback = "needed",
                   .text = "unique in the device",
                   .example = "a name for the channel"},
                  &ChannelSpec::name, NameRule{}),
      {{.name = "at",
        .fallback = "needed without `calculate`",
        .text = "the address, in the PLC's own notation: holding:100, 40101, coil:3, VW100",
        .schema = R"({ "type": ["string", "number"] })"}},
      {{.name = "calculate",
        .fallback = "none: the channel is read",
        .text = "the value follows from other channels of this bridge: `voltage * current`. A name "
                "with other characters than letters, digits and `_`, or of another device, is in "
                "braces: `{oil-temperature}`, `{BUS/DEVICE/CHANNEL}`. With operators, comparisons "
                "and the functions " +
                function_names() +
                ". The type is `float64`, or `bool` if `type` says so; the refresh is that of the "
                "slowest input",
        .schema = TextRule{kMaxExpression}.schema()}},
      by_channel({"type", "`bool` for a bit, `float64` with `calculate`, else needed",
                  "see above; may be left out where the address is one bit"},
                 TypeRule{}),
      channel_row({"refresh", "1s", "the promise that a sample is never older", kFlowsDown},
                  &ChannelSpec::refresh, DurationRule{kMinRefresh, kMaxRefresh}),
      channel_row({"mode", "scheduled",
                   "`scheduled` reads in time for the refresh, then the wire rests; `intensive` "
                   "reads without pause, the oldest first; `on-demand` reads by command only",
                   true},
                  &ChannelSpec::mode, ChoiceRule<Mode>{kModes}),
      channel_row({"access", "read-only", "what commands may do", kFlowsDown}, &ChannelSpec::access,
                  ChoiceRule<Access>{kAccesses}),
      channel_row({"acquire", "always",
                   "`on-interest` reads only while a station declares interest", kFlowsDown},
                  &ChannelSpec::on_interest, ChoiceRule<bool>{kAcquires}),
      channel_row({"priority", "0", "a higher one is kept fresh longer when the wire is too slow",
                   kFlowsDown},
                  &ChannelSpec::priority, WholeRule{-kMaxPriority, kMaxPriority}),
      channel_row({"elasticity", "1",
                   "its share of the stretch when the wire is too slow, beside the others of its "
                   "priority: with 2 its refresh grows by twice as much",
                   true},
                  &ChannelSpec::elasticity, NumberRule{kMinElasticity, kMaxElasticity}),
      channel_row({"unit", "none"}, &ChannelSpec::unit, TextRule{kMaxUnit}),
      channel_row({"digits",
                   "those of `scale` and `offset` for integers; of floats, about five "
                   "significant ones",
                   "decimals with which the pages of the station show the value; the published "
                   "value is not rounded"},
                  &ChannelSpec::digits, WholeRule{0, kMostDigits}),
      channel_row({"description", "none"}, &ChannelSpec::description, TextRule{kMaxDescription}),
      channel_row({"scale", "1", "value = raw × scale + offset"}, &Encoding::scale, NumberRule{}),
      channel_row({"offset", "0", "value = raw × scale + offset"}, &Encoding::offset, NumberRule{}),
      {{.name = kExponentKey,
        .fallback = "none",
        .text = "the register that holds the decimal exponent of the value, as in SunSpec "
                "(`_SF`): value = raw × 10^exponent × scale + offset. An int16 from -10 "
                "to 10; any other is BAD_RANGE, 0x8000 the reason `not available`. For "
                "integer and BCD types in 16-bit registers. One request reads the value, "
                "the exponent and the registers between; the channel is read-only",
        .schema = R"({ "type": ["string", "number"] })"}},
      channel_row({"word-order", "the family's own",
                   "of the 16-bit words of a wider value: `big-endian` has the high word first",
                   kFlowsDown},
                  &ChannelDefaults::word_order, ChoiceRule<WordOrder>{kWordOrders}),
      channel_row({"byte-order", "big-endian; of texts the family's own",
                   "of the two bytes of each word", kFlowsDown},
                  &ChannelDefaults::byte_order, ChoiceRule<ByteOrder>{kByteOrders}),
      channel_row(
          {.name = "encoding",
           .fallback = "utf-8",
           .text =
               "of the device's texts, for channels of type `string(n)`, read and written. What is "
               "no character of it, and control characters, are shown as `\\xE4`; a write that it "
               "has no character for is rejected. A text of more than 256 bytes of UTF-8 does not "
               "fit into a sample: BAD_RANGE",
           .flows_down = true},
          &ChannelDefaults::charset, ChoiceRule<Charset>{kCharsets}),
      by_channel({"bit", "none",
                  "of a word, for a bool; 0 is the least significant; another way to write "
                  "`holding:100.5`"},
                 WholeRule{0, 63}),
      by_channel({"byte", "none",
                  "of a wider item, with an 8-bit type: `low` or `high` of a word; of a "
                  "wider one `0` (the least significant) to `7`"},
                 byte),
      by_channel({"text", "none: the bytes are the number",
                  "the number stands as text of n characters: `decimal(7)`, "
                  "`decimal-comma(7)`, `hex(4)` (the bits of the type), or a picture whose "
                  "form a write keeps: `\"+000.00\"`, `\"000,0\"`. Read with sign, blanks "
                  "and exponent; what spells no number of the type is BAD_RANGE. Where a "
                  "declared place is a text, n may be left out"},
                 TextFormRule{}),
      {{.name = "not-available",
        .fallback = "none",
        .text = "raw values by which the device says that it has no value, before scale and "
                "offset: a value or a list of up to 8. `0x8000` is the bits of the type, `-1` a "
                "number of it, `nan` any NaN of a float. Such a reading is BAD_RANGE, and the last "
                "good value stays; a command cannot write it. In a cell of a channel list: "
                "`0x7FFF 0x8000`",
        .schema = not_available_schema()}},
      channel_row({.name = "deadband",
                   .fallback = "none: every reading is published",
                   .text = "changes of more than this are published; 0: every change",
                   .schema = R"({ "type": "number", "minimum": 0 })",
                   .form = "0 and above"},
                  &ChannelSpec::deadband, NumberRule{}),
      channel_row({"heartbeat", "the refresh",
                   "with a deadband the value is published at the latest after this, which is at "
                   "least the refresh",
                   true},
                  &ChannelSpec::heartbeat, DurationRule{kMinRefresh, kMaxRefresh}),
      {{.name = "limits",
        .fallback = "none",
        .text = "alarms, see below",
        .schema = R"({ "$ref": "#/$defs/limits" })"}},
      {{.name = "write",
        .fallback = "none",
        .text = "what commands may write, see below",
        .schema = R"({ "$ref": "#/$defs/write" })"}},
  };
}

}  // namespace

const Rows<ChannelDefaults>& channel_rows() {
  static const Rows<ChannelDefaults> rows("channel", "a channel", channel_fields(), {},
                                          {"at", "calculate"});
  return rows;
}

const Rows<Limits>& limit_rows() {
  static const Rows<Limits> rows(
      "limits", "'limits'",
      {
          field({"low-low", "none", "below `low`"}, &Limits::low_low, NumberRule{}),
          field({"low", "none", "a value below it is an alarm"}, &Limits::low, NumberRule{}),
          field({"high", "none", "a value above it is an alarm"}, &Limits::high, NumberRule{}),
          field({"high-high", "none", "above `high`"}, &Limits::high_high, NumberRule{}),
          field({.name = "hysteresis",
                 .fallback = "0",
                 .text = "how far a value must be back inside until the alarm is clear",
                 .schema = R"({ "type": "number", "minimum": 0 })",
                 .form = "0 and above"},
                &Limits::hysteresis, NumberRule{}),
          field({.name = "delay",
                 .fallback = "0ms",
                 .text = "how long a value must be outside until the alarm is raised",
                 .column = "alarm-delay"},
                &Limits::delay, DurationRule{Duration{}, kMaxAlarmDelay}),
          field({.name = "priority",
                 .fallback = "high for low-low and high-high, medium for low and high",
                 .text = "how soon somebody has to do something about the alarms of the channel",
                 .column = "alarm-priority"},
                &Limits::priority, ChoiceRule<AlarmPriority>{kAlarmPriorities}),
      },
      "Alarms: low-low < low < high < high-high. `--check` warns of a limit that no value of the "
      "type exceeds.");
  return rows;
}

const Rows<ChannelSpec>& write_rows() {
  static const Rows<ChannelSpec> rows(
      "write", "'write'",
      {
          field({.name = "min",
                 .fallback = "none",
                 .text = "the least value of a command",
                 .column = "write-min"},
                &ChannelSpec::write_min, NumberRule{}),
          field({.name = "max",
                 .fallback = "none",
                 .text = "the greatest value of a command",
                 .column = "write-max"},
                &ChannelSpec::write_max, NumberRule{}),
          field({.name = "interval",
                 .fallback = "0ms: none",
                 .text = "the least time between two commands",
                 .column = "write-interval"},
                &ChannelSpec::write_interval, DurationRule{Duration{}, kMaxRefresh}),
      },
      "What commands may write.");
  return rows;
}

}  // namespace fieldcast::config
