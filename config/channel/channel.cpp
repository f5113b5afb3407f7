#include "config/channel/channel.hpp"

#include <fmt/format.h>

#include "config/channel/channel_encoding.hpp"
#include "config/channel/channel_keys.hpp"
#include "config/channel/channel_limits.hpp"
#include "config/document/common_forms.hpp"
#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "core/codec/raw_items.hpp"
#include "core/model/fit.hpp"

namespace fieldcast::config {
namespace {

struct Draft : ChannelDefaults {
  const Area* area = nullptr;  // null if unknown
  std::optional<ParsedAddress> address;
  bool typed = false;  // spec.encoding is valid
};

void read_address(MapReader& map, const ChannelContext& context, Draft& draft) {
  if (!map.read_required("at", draft.spec.at, TextRule{kMaxNameLength},
                         "an address in the notation of the PLC"))
    return;
  if (context.protocol == nullptr) return;
  const auto parsed = context.protocol->parse_address(draft.spec.at);
  if (!parsed) {
    map.fault("at", parsed.error().what, parsed.error().allowed, parsed.error().suggestion);
    return;
  }
  draft.address = *parsed;
  draft.area = &context.protocol->areas()[parsed->area];
  draft.spec.unsolicited = draft.area->unsolicited > Duration::zero();
}

// The byte of an item; low and high are those of a word.
void read_byte(MapReader& map, Draft& draft) {
  std::uint8_t byte = 0;
  if (!map.read("byte", byte, ChoiceRule<std::uint8_t>{kByteWords})) return;
  draft.spec.encoding.bit = static_cast<std::uint8_t>(8 * byte);
  const bool wider = draft.area != nullptr && draft.area->item_bits > 16;
  const std::string& text = map.find("byte")->text;
  if (wider && (text == "low" || text == "high")) {
    map.fault("byte", fmt::format("'{}' at '{}', which is no word", text, draft.spec.at),
              byte_names(draft.area->item_bits));
  }
  if (map.has("bit")) map.fault("byte", "a bit and a byte of one item", "one of bit, byte");
}

// An address of several items, such as VW10, has its lowest bits in its last item.
void set_bit(MapReader& map, unsigned bit, Draft& draft) {
  const unsigned item = draft.area->item_bits;
  const unsigned bits = bits_of_value(*draft.address, *draft.area);
  if (bits == item || bits == 1) {
    draft.spec.encoding.bit = static_cast<std::uint8_t>(bit);  // check_type() checks it
  } else if (bit >= bits) {
    map.fault("bit", fmt::format("bit {} is beyond '{}'", bit, draft.spec.at),
              fmt::format("0 to {}", bits - 1));
  } else {
    draft.address->first += draft.address->width_bits.value_or(item) / item - 1 - bit / item;
    draft.spec.encoding.bit = static_cast<std::uint8_t>(bit % item);
  }
}

void read_bit(MapReader& map, Draft& draft) {
  std::uint8_t bit = 0;
  const bool has_bit = map.read("bit", bit, WholeRule{0, 63});
  if (!draft.address) {
    if (has_bit) draft.spec.encoding.bit = bit;
  } else if (!draft.address->bit) {
    if (has_bit) set_bit(map, bit, draft);
  } else {
    if (has_bit)
      map.fault("bit", fmt::format("the bit is named twice: '{}' has one already", draft.spec.at),
                "one of 'at', 'bit'");
    draft.spec.encoding.bit = draft.address->bit;
  }
}

void read_type(MapReader& map, Draft& draft) {
  auto& encoding = draft.spec.encoding;
  Encoding type;
  draft.typed = map.read("type", type, TypeRule{});
  encoding.type = type.type;
  encoding.string_bytes = type.string_bytes;
  if (draft.address) encoding.layout = draft.address->text_layout;
  if (!map.has("type") && draft.address) {
    const auto fixed = fixed_type(*draft.address, *draft.area);
    draft.typed = fixed && (fixed->type == ValueType::kBool || is_date_time(encoding.layout));
    if (draft.typed)
      encoding.type = fixed->type, encoding.string_bytes = fixed->string_bytes;
    else
      map.faults().add(map.position(), "'type' is missing in a channel", allowed_types(),
                       fixed ? "type: " + fieldcast::to_text(*fixed) : std::string());
  }
  read_byte(map, draft);
  read_bit(map, draft);
}

bool is_number(const Encoding& encoding) {
  return encoding.type != ValueType::kBool && encoding.type != ValueType::kString;
}

// The digits are the bits of the type: a float has them all, an integer may have fewer. The device
// may add "0x" and leading zeros.
void check_hex(MapReader& map, const ChannelSpec& spec) {
  constexpr unsigned kMostHex = 18;  // 64 bits and "0x"
  const ValueType type = spec.encoding.type;
  const unsigned least = is_float(type) ? width_bits(Encoding{.type = type}) / 4 : 1;
  if (spec.encoding.string_bytes >= least && spec.encoding.string_bytes <= kMostHex) return;
  const bool has_key = map.has("text");  // otherwise the declared place gives the form
  map.fault(has_key ? "text" : "type",
            fmt::format("hex({}) does not spell a {}", spec.encoding.string_bytes,
                        fieldcast::to_text(type)),
            has_key ? fmt::format("hex({}) to hex({})", least, kMostHex) : "an integer type");
}

// The key, or the declaration of the value, gives the format. check_type() checks the type.
void read_text(MapReader& map, Draft& draft) {
  auto& encoding = draft.spec.encoding;
  TextForm form;
  const bool given = map.read("text", form, TextFormRule{});
  if (!draft.typed || !draft.address) return;
  const std::uint16_t there = draft.address->text_characters;
  const bool number = is_number(encoding) && !is_bcd(encoding.type);
  if (map.has("text") && !number) {
    map.fault("text", fmt::format("'text' at a {}", fieldcast::to_text(encoding.type)),
              "a channel of an integer type, float32 or float64");
    return;
  }
  if (!map.has("text") && number) form = {draft.address->text_number, there};
  if (form.characters == 0) form.characters = there;
  if (form.number) encoding.string_bytes = form.characters;
  encoding.text_number = form.number;
  if (given && form.characters == 0) {
    map.fault("text", "'text' does not say how many characters the number has", kTextNumberForms);
    draft.typed = false;
  } else if (given && there != 0 && form.characters != there) {
    map.fault("text",
              fmt::format("a number of {} characters at '{}', which is a text of {} characters",
                          form.characters, draft.spec.at, there),
              fmt::format("{} characters", there));
    draft.typed = false;
  } else if (map.has("text") && !given) {
    draft.typed = false;  // a fault was already added
  } else if (form.number.kind == TextNumber::Kind::kHex &&
             (there == 0 || is_float(encoding.type))) {
    check_hex(map, draft.spec);
  }
}

void read_order(Draft& draft) {
  const Area family = draft.area != nullptr ? *draft.area : Area{};
  Encoding& encoding = draft.spec.encoding;
  const bool text = encoding.is_text();
  encoding.word_order = draft.word_order.value_or(family.word_order);
  encoding.byte_order = draft.byte_order.value_or(text ? family.text_order : ByteOrder::kBigEndian);
}

void check_type(MapReader& map, Draft& draft) {
  if (!draft.address || !draft.typed) return;
  const auto& encoding = draft.spec.encoding;
  const bool both = map.has("bit") && map.has("byte");
  // A fault was already added.
  if (both || ((map.has("bit") || map.has("byte")) && !encoding.bit)) return;
  const std::string type(fieldcast::to_text(encoding.type));
  const bool one_byte = !encoding.is_text() && width_bits(encoding) == 8;
  if (map.has("byte") && !one_byte) {
    return map.fault("byte", "'byte' with type " + type, "int8, uint8, bcd8");
  }
  if (map.has("bit") && one_byte) {
    return map.fault("bit", fmt::format("type {} with a bit of a word", type), "byte");
  }
  const auto misfit = check_fit(draft.spec.at, *draft.address, *draft.area, encoding);
  if (!misfit) return;
  const std::string_view part = map.has("byte") ? "byte" : map.has("bit") ? "bit" : "at";
  const std::string_view own = map.has("type") ? "type" : "at";
  map.fault(misfit->about == FitFault::About::kPart ? part : own, misfit->what, misfit->allowed,
            misfit->suggestion);
  draft.typed = false;  // prevents further faults for the same mistake
}

void set_range(MapReader& map, const ChannelContext& context, Draft& draft) {
  if (!draft.address || !draft.typed) return;
  const auto& area = *draft.area;
  auto& range = draft.spec.range;
  const std::int32_t distance = draft.spec.encoding.exponent_distance;
  range = {draft.address->area,
           distance < 0 ? draft.address->first - static_cast<std::uint32_t>(-distance)
                        : draft.address->first,
           item_count(draft.spec.encoding, area.item_bits)};
  const std::string count = std::to_string(range.count);
  if (range.first >= area.items || range.count > area.items - range.first) {
    map.fault("at",
              fmt::format("'{}' with {} items reaches beyond the area {}", draft.spec.at, count,
                          area.name),
              fmt::format("items 0 to {}", area.items - 1));
  } else if (distance == 0 && !in_one_bank(area, range.first, range.end())) {
    map.fault("at",
              fmt::format("'{}' with {} items reaches beyond its bank of area {}", draft.spec.at,
                          count, area.name),
              fmt::format("items within a bank of {}", area.bank));
  }
  const std::uint32_t block =
      context.max_block == 0 ? area.max_read : std::min(area.max_read, context.max_block);
  const std::string allowed =
      fmt::format("at most {}{}", block, block < area.max_read ? " (max-block)" : "");
  if (distance != 0 && (range.count > block || !in_one_bank(area, range.first, range.end()))) {
    map.fault(kExponentKey,
              fmt::format("'{}' and its exponent at '{}' need {} items in one read", draft.spec.at,
                          draft.spec.exponent_from, count),
              range.count > block ? allowed : "a register of the same bank");
  } else if (range.count > block && area.max_read != 0) {
    map.fault(map.has("type") ? "type" : "at",
              fmt::format("'{}' needs {} items in one read", draft.spec.at, count), allowed);
  }
}

std::uint32_t spec_items(const Draft& draft) { return draft.typed ? draft.spec.range.count : 0; }

void check_byte_write(MapReader& map, Draft& draft) {
  auto& access = draft.spec.access;
  const Encoding& encoding = draft.spec.encoding;
  if (draft.area == nullptr || !draft.typed || access == Access::kReadOnly ||
      encoding.type == ValueType::kBool || !is_part(encoding, draft.area->item_bits))
    return;
  const auto why = why_no_byte_write(fmt::format("'{}'", draft.spec.at), *draft.area);
  if (!why) return;
  if (map.has("access")) {
    map.fault("access", *why,
              "read-only, the whole item, or on Modbus the option mask-write: true");
  }
  access = Access::kReadOnly;
}

void check_access(MapReader& map, Draft& draft) {
  auto& access = draft.spec.access;
  if (draft.spec.encoding.exponent_distance != 0 && access != Access::kReadOnly) {
    if (map.has("access")) {
      map.fault(
          "access",
          fmt::format("a channel with '{}' cannot be written: its exponent belongs to the device",
                      kExponentKey),
          "read-only; to write, a second channel of the raw number");
    }
    access = Access::kReadOnly;
  }
  if (draft.area != nullptr && !draft.area->writable && access != Access::kReadOnly) {
    if (map.has("access")) {
      map.fault("access", fmt::format("area {} cannot be written", draft.area->name), "read-only",
                "read-only");
    }
    access = Access::kReadOnly;  // an inherited default only applies if it is possible
  }
  if (access == Access::kReadOnly && map.has("write")) {
    map.fault("write", "'write' at a channel that is read-only",
              "access: read-write, access: write-only");
  }
  check_byte_write(map, draft);
  if (draft.area != nullptr && draft.area->max_read == 0 && !draft.spec.unsolicited &&
      access != Access::kWriteOnly) {
    map.fault(map.has("access") ? "access" : "at",
              fmt::format("'{}' cannot be read", draft.spec.at), "access: write-only");
  }
  if (draft.area != nullptr && access != Access::kReadOnly &&
      spec_items(draft) > draft.area->max_write) {
    map.fault("at",
              fmt::format("'{}' needs {} items in one write", draft.spec.at, spec_items(draft)),
              fmt::format("at most {}", draft.area->max_write));
  }
  if (draft.spec.mode == Mode::kOnDemand && draft.spec.on_interest && map.has("mode") &&
      map.has("acquire")) {
    map.fault("acquire", "'acquire: on-interest' at a channel that is read by command only",
              "one of acquire: on-interest, mode: on-demand");
  }
  if (access != Access::kWriteOnly) return;
  for (const std::string_view key : {"deadband", "limits"}) {
    if (map.has(key))
      map.fault(key, fmt::format("'{}' at a channel that is write-only", key),
                "access: read-write");
  }
}

void check_numbers(MapReader& map, Draft& draft) {
  auto& spec = draft.spec;
  const std::string type(fieldcast::to_text(spec.encoding.type));
  const bool number = is_number(spec.encoding);
  if (spec.encoding.scale == 0)
    map.fault("scale", "scale is 0", "any other number, with a decimal point: 0.1");
  check_deadband(map, spec);
  if (draft.typed && number) check_write_span(map, spec);
  if (!draft.typed || number) return;
  for (const std::string_view key : {"digits", "scale", "offset", "limits"}) {
    if (map.has(key))
      map.fault(key, fmt::format("'{}' at a {}", key, type), "a channel of a numeric type");
  }
  if (spec.deadband.value_or(0) != 0)
    map.fault("deadband", "a deadband other than 0 at a " + type, "0: every change");
  if (spec.write_min || spec.write_max) map.fault("write", "write limits at a " + type, "interval");
}

void check_heartbeat(MapReader& map, const ChannelDefaults& inherited, ChannelSpec& spec) {
  if (!spec.deadband) {
    spec.heartbeat.reset();  // an inherited default only applies with a deadband
    if (map.has("heartbeat"))
      map.fault("heartbeat", "'heartbeat' without 'deadband'", "both, or neither");
  } else if (spec.heartbeat && *spec.heartbeat < spec.refresh) {
    const bool own = map.has("heartbeat") || map.has("refresh");
    if (!own && inherited.spec.heartbeat) return;
    map.fault(map.has("heartbeat") ? "heartbeat" : "refresh",
              fmt::format("heartbeat {} is shorter than the refresh",
                          fieldcast::to_text(*spec.heartbeat)),
              fieldcast::to_text(spec.refresh) + " and above");
  }
}

// The refresh of a channel that is never requested is the longest accepted silence.
void check_unsolicited(MapReader& map, Draft& draft) {
  if (!draft.spec.unsolicited) return;
  if (draft.spec.mode == Mode::kOnDemand) {
    if (map.has("mode"))
      map.fault("mode",
                fmt::format("'{}' is sent by the device and never read on demand", draft.spec.at),
                "no 'mode'");
    draft.spec.mode = Mode::kScheduled;  // an inherited default only applies if it is possible
  }
  if (draft.spec.refresh > draft.area->unsolicited) return;
  map.fault("refresh",
            fmt::format("refresh {} is not longer than the time between two frames of the device",
                        fieldcast::to_text(draft.spec.refresh)),
            fmt::format("above {}, for example {}", fieldcast::to_text(draft.area->unsolicited),
                        fieldcast::to_text(3 * draft.area->unsolicited)));
}

// The loader completes it when all channels are known: inputs, formula and refresh.
ChannelSpec read_calculated(MapReader& map, const ChannelContext& context) {
  static constexpr std::string_view kOfRead[] = {
      "at",         "refresh", "mode",   "access",     "acquire",       "priority",
      "elasticity", "scale",   "offset", "word-order", "byte-order",    "encoding",
      "bit",        "byte",    "text",   kExponentKey, "not-available", "write"};
  static constexpr std::pair<std::string_view, ValueType> kTypes[] = {
      {"float64", ValueType::kFloat64}, {"bool", ValueType::kBool}};
  ChannelDefaults values{context.defaults};
  channel_rows().read(map, values);
  ChannelSpec& spec = values.spec;
  for (const std::string_view key : kOfRead) {
    if (map.find(key) != nullptr)
      map.fault(key, fmt::format("'{}' at a calculated channel", key),
                "name, calculate, type, unit, description, deadband, heartbeat, limits");
  }
  spec.encoding = {.type = ValueType::kFloat64};
  map.read("type", spec.encoding.type, ChoiceRule<ValueType>{kTypes});
  spec.mode = Mode::kScheduled;
  spec.access = Access::kReadOnly;
  spec.on_interest = false;
  read_limits(map, spec);
  check_deadband(map, spec);
  if (!spec.deadband) spec.heartbeat.reset();
  const bool is_bool = spec.encoding.type == ValueType::kBool;
  if (is_bool && map.has("limits"))
    map.fault("limits", "'limits' at a bool", "a channel of a numeric type");
  auto calculation = std::make_shared<Calculation>();
  map.read("calculate", calculation->expression, TextRule{kMaxExpression});
  spec.at = "= " + calculation->expression;
  spec.calculation.value = std::move(calculation);
  return std::move(spec);
}

}  // namespace

ChannelSpec read_channel(const Node& node, const ChannelContext& context, FaultList& faults) {
  MapReader map(node, channel_rows(), faults);
  if (map.find("calculate") != nullptr || map.has("calculate"))
    return read_calculated(map, context);
  Draft draft{context.defaults};
  ChannelSpec& spec = draft.spec;
  channel_rows().read(map, draft);
  read_address(map, context, draft);
  read_type(map, draft);
  read_text(map, draft);
  read_not_available(map, draft.typed, spec.encoding);
  read_limits(map, spec);
  read_write(map, spec);
  read_order(draft);
  const bool is_string = spec.encoding.type == ValueType::kString;
  if (is_string) spec.encoding.charset = draft.charset;
  if (map.has("encoding") && draft.typed && !is_string)
    map.fault("encoding", fmt::format("'encoding' at a {}", fieldcast::to_text(spec.encoding.type)),
              "a channel of type string(n)");

  check_type(map, draft);
  read_exponent(map, context.protocol, draft.address && draft.typed ? &*draft.address : nullptr,
                spec);
  set_range(map, context, draft);
  check_access(map, draft);
  check_numbers(map, draft);
  check_heartbeat(map, context.defaults, spec);
  check_unsolicited(map, draft);
  return std::move(spec);
}

}  // namespace fieldcast::config
