#include "config/channel.hpp"

#include <array>

#include "config/channel_limits.hpp"
#include "config/limits.hpp"
#include "config/scalars.hpp"

namespace fieldcast::config {
namespace {

std::string quoted(std::string_view text) { return "'" + std::string(text) + "'"; }

// What a channel says and where, while its rules are checked.
struct Draft {
  ChannelSpec spec;
  const Area* area = nullptr;  // nothing: unknown
  std::optional<ParsedAddress> address;
  bool typed = false;  // spec.encoding is what the file means
};

void read_address(MapReader& map, const ChannelContext& context, Draft& draft) {
  if (!map.read_required("at", draft.spec.at, TextRule{kMaxNameLength}, "an address in the notation of the PLC")) return;
  if (context.protocol == nullptr) return;
  const auto parsed = context.protocol->parse_address(draft.spec.at);
  if (!parsed) {
    map.faults().add(map.place_of("at"), parsed.error().what, parsed.error().allowed, parsed.error().suggestion);
    return;
  }
  draft.address = *parsed;
  draft.area = &context.protocol->areas()[parsed->area];
}

// The type, by the key or by the notation; and the bit of a word.
void read_type(MapReader& map, Draft& draft) {
  auto& encoding = draft.spec.encoding;
  draft.typed = map.read("type", encoding, TypeRule{});
  const bool fixed = draft.address && (draft.address->bit || draft.address->width_bits == 1u || draft.area->item_bits == 1);
  if (!map.has("type")) {
    if (fixed)
      encoding.type = ValueType::kBool, draft.typed = true;
    else if (draft.address) {
      map.faults().add(map.place(), "'type' is missing in a channel",
                       "bool, int16, uint16, int32, uint32, int64, uint64, float32, float64, bcd16, bcd32, string(n)");
    }
  }
  std::uint8_t bit = 0;
  const bool has_bit = map.read("bit", bit, WholeRule{0, 63});
  if (has_bit) encoding.bit = bit;
  if (!draft.address) return;
  if (has_bit && draft.address->bit) {
    map.faults().add(map.place_of("bit"), "the bit is named twice: " + quoted(draft.spec.at) + " has one already",
                     "one of 'at', 'bit'");
  }
  if (draft.address->bit) encoding.bit = draft.address->bit;
}

void read_presentation(MapReader& map, ChannelSpec& spec) {
  map.read("unit", spec.unit, TextRule{kMaxUnit});
  map.read("description", spec.description, TextRule{kMaxDescription});
  map.read("scale", spec.encoding.scale, NumberRule{});
  map.read("offset", spec.encoding.offset, NumberRule{});
  map.read("deadband", spec.deadband, NumberRule{});
}

// Type against notation, bit and area.
void check_type(MapReader& map, Draft& draft) {
  if (!draft.address || !draft.typed) return;
  const auto& encoding = draft.spec.encoding;
  const bool is_bool = encoding.type == ValueType::kBool;
  const std::string type(fieldcast::to_text(encoding.type));
  const unsigned item_bits = draft.area->item_bits;
  const unsigned notation_bits = item_bits == 1 ? 1u : draft.address->width_bits.value_or(0);
  const Place type_place = map.place_of(map.has("type") ? "type" : "at");
  if (encoding.bit && item_bits == 1) {
    map.faults().add(map.place_of("bit"), "a bit of " + quoted(draft.spec.at) + ", which is a bit already", "no 'bit'");
  } else if (encoding.bit && !is_bool) {
    map.faults().add(type_place, "type " + type + " with a bit of a word", "bool", "bool");
  } else if (encoding.bit && *encoding.bit >= item_bits) {
    map.faults().add(map.place_of(map.has("bit") ? "bit" : "at"),
                     "bit " + std::to_string(*encoding.bit) + " is beyond " + quoted(draft.spec.at),
                     "0 to " + std::to_string(item_bits - 1));
  } else if (is_bool && !encoding.bit && item_bits > 1 && !map.has("bit")) {
    map.faults().add(type_place, "a bool in " + quoted(draft.spec.at) + " needs a bit",
                     "a bit in 'at', or 'bit': 0 to " + std::to_string(item_bits - 1), draft.spec.at + ".0");
  } else if (notation_bits == 1 && !is_bool) {
    map.faults().add(type_place, "type " + type + " does not fit " + quoted(draft.spec.at) + ", which is one bit", "bool",
                     "bool");
  } else if (notation_bits > 1 && !is_bool && encoding.type != ValueType::kString && width_bits(encoding) != notation_bits) {
    map.faults().add(type_place,
                     "type " + type + " has " + std::to_string(width_bits(encoding)) + " bits, " + quoted(draft.spec.at) +
                         " has " + std::to_string(notation_bits),
                     "a type of " + std::to_string(notation_bits) + " bits");
  }
}

// The range against its area and the blocks that the device can take.
void place_range(MapReader& map, const ChannelContext& context, Draft& draft) {
  if (!draft.address || !draft.typed) return;
  const auto& area = *draft.area;
  auto& range = draft.spec.range;
  range = {draft.address->area, draft.address->first, item_count(draft.spec.encoding, area.item_bits)};
  const std::string count = std::to_string(range.count);
  if (range.first >= area.items || range.count > area.items - range.first) {
    map.faults().add(map.place_of("at"),
                     quoted(draft.spec.at) + " with " + count + " items reaches beyond the area " + std::string(area.name),
                     "items 0 to " + std::to_string(area.items - 1));
  }
  const std::uint32_t block = context.max_block == 0 ? area.max_read : std::min(area.max_read, context.max_block);
  if (range.count > block) {
    map.faults().add(map.place_of(map.has("type") ? "type" : "at"),
                     quoted(draft.spec.at) + " needs " + count + " items in one read",
                     "at most " + std::to_string(block) + (block < area.max_read ? " (max-block)" : ""));
  }
}

std::uint32_t spec_items(const Draft& draft) { return draft.typed ? draft.spec.range.count : 0; }

void check_access(MapReader& map, Draft& draft) {
  auto& access = draft.spec.access;
  if (draft.area != nullptr && !draft.area->writable && access != Access::kReadOnly) {
    if (map.has("access")) {
      map.faults().add(map.place_of("access"), "area " + std::string(draft.area->name) + " cannot be written", "read-only",
                       "read-only");
    }
    access = Access::kReadOnly;  // a default from above holds where it can
  }
  if (access == Access::kReadOnly && map.has("write")) {
    map.faults().add(map.place_of("write"), "'write' at a channel that is read-only", "access: read-write, access: write-only");
  }
  if (draft.area != nullptr && access != Access::kReadOnly && spec_items(draft) > draft.area->max_write) {
    map.faults().add(map.place_of("at"),
                     quoted(draft.spec.at) + " needs " + std::to_string(spec_items(draft)) + " items in one write",
                     "at most " + std::to_string(draft.area->max_write));
  }
  if (draft.spec.mode == Mode::kOnDemand && draft.spec.on_interest && map.has("mode") && map.has("acquire")) {
    map.faults().add(map.place_of("acquire"), "'acquire: on-interest' at a channel that is read by command only",
                     "one of acquire: on-interest, mode: on-demand");
  }
  if (access != Access::kWriteOnly) return;
  for (const std::string_view key : {"deadband", "limits"}) {
    if (map.has(key)) map.faults().add(map.place_of(key), quoted(key) + " at a channel that is write-only", "access: read-write");
  }
}

// What only numbers can have.
void check_numbers(MapReader& map, Draft& draft) {
  auto& spec = draft.spec;
  const std::string type(fieldcast::to_text(spec.encoding.type));
  const bool number = spec.encoding.type != ValueType::kBool && spec.encoding.type != ValueType::kString;
  if (spec.encoding.scale == 0) map.faults().add(map.place_of("scale"), "scale is 0", "any other number");
  check_deadband(map, spec);
  if (draft.typed && number) check_write_span(map, spec);
  if (!draft.typed || number) return;
  for (const std::string_view key : {"scale", "offset", "limits"}) {
    if (map.has(key)) map.faults().add(map.place_of(key), quoted(key) + " at a " + type, "a channel of a numeric type");
  }
  if (spec.deadband.value_or(0) != 0)
    map.faults().add(map.place_of("deadband"), "a deadband other than 0 at a " + type, "0: every change");
  if (spec.write_min || spec.write_max) map.faults().add(map.place_of("write"), "write limits at a " + type, "interval");
}

void check_heartbeat(MapReader& map, const ChannelDefaults& inherited, ChannelSpec& spec) {
  if (!spec.deadband) {
    spec.heartbeat.reset();  // a default from above holds where there is a deadband
    if (map.has("heartbeat")) map.faults().add(map.place_of("heartbeat"), "'heartbeat' without 'deadband'", "both, or neither");
  } else if (spec.heartbeat && *spec.heartbeat < spec.refresh) {
    const bool own = map.has("heartbeat") || map.has("refresh");
    if (!own && inherited.heartbeat) return;
    map.faults().add(map.place_of(map.has("heartbeat") ? "heartbeat" : "refresh"),
                     "heartbeat " + fieldcast::to_text(*spec.heartbeat) + " is shorter than the refresh",
                     fieldcast::to_text(spec.refresh) + " and above");
  }
}

}  // namespace

ChannelSpec read_channel(const Node& node, const ChannelContext& context, FaultList& faults) {
  MapReader map(node, kChannelKeys, faults);
  ChannelDefaults values = context.defaults;
  Draft draft;
  ChannelSpec& spec = draft.spec;
  map.read_required("name", spec.name, NameRule{}, "a name for the channel");
  read_channel_defaults(map, values);
  read_address(map, context, draft);
  read_type(map, draft);
  read_presentation(map, spec);
  read_limits(map, spec);

  spec.refresh = values.refresh;
  spec.mode = values.mode;
  spec.access = values.access;
  spec.on_interest = values.on_interest;
  spec.priority = values.priority;
  spec.elasticity = values.elasticity;
  spec.heartbeat = values.heartbeat;
  spec.encoding.word_order = values.word_order;
  spec.encoding.byte_order = values.byte_order;
  read_write(map, spec);

  check_type(map, draft);
  place_range(map, context, draft);
  check_access(map, draft);
  check_numbers(map, draft);
  check_heartbeat(map, context.defaults, spec);
  return spec;
}

}  // namespace fieldcast::config
