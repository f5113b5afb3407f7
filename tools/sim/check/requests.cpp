#include "tools/sim/check/requests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "core/protocol/declared/frame.hpp"

namespace fieldcast::sim {

Requests::Requests(const Subject& subject) : subject_(subject), protocol_(subject.protocol()) {
  if (!protocol_) throw std::runtime_error("no protocol " + subject.device.protocol);
}

namespace {

constexpr int kFewestExponent = -9, kMostExponent = 3;

// Values that share an exponent have the same decimals, so that each shows what it holds.
void describe_scaled(const declared::Frame& frame, const declared::Field& value, Slot& slot) {
  slot.text_bytes = declared::kScaledCharacters;
  slot.negative = value.is_signed || value.sign || value.text_size > 1;
  slot.exponents.emplace();
  if (value.text_size != 0) {
    const int digits = value.text_size - (slot.negative && !value.sign ? 1 : 0);
    slot.largest = static_cast<std::uint64_t>(std::pow(10.0, std::min(digits, 6))) - 1;
  } else {
    slot.largest = largest_magnitude(value);
  }
  if (!value.exponent) return;
  const auto range = exponents_of(frame.fields[*value.exponent]);
  slot.exponents = {std::clamp(range.lowest, kFewestExponent, kMostExponent),
                    std::clamp(range.highest, kFewestExponent, kMostExponent)};
  const auto shared = std::ranges::count(frame.fields, value.exponent, &declared::Field::exponent);
  if (shared > 1) slot.exponents->highest = slot.exponents->lowest;
}

Bytes scaled_contents(const Slot& slot, std::mt19937& random) {
  const int exponents = slot.exponents->highest - slot.exponents->lowest + 1;
  declared::Decimal decimal;
  decimal.negative = slot.negative && random() % 2 != 0;
  decimal.digits = random() % (std::min<std::uint64_t>(slot.largest, 999'999) + 1);
  decimal.exponent =
      slot.exponents->lowest + static_cast<int>(random() % static_cast<unsigned>(exponents));
  const std::string text = declared::to_text(decimal);
  Bytes image(text.begin(), text.end());
  image.resize(declared::kScaledCharacters);
  return image;
}

// Returns false if the frame has no such value.
bool describe(const declared::Frame& frame, Slot& slot) {
  bool found = false;
  for (std::size_t i = 0; i < frame.fields.size(); ++i) {
    const declared::Field& field = frame.fields[i];
    if (field.kind != declared::FieldKind::kValue || field.place != slot.range.first) continue;
    found = true;
    slot.text_bytes = field.text_size;
    if (field.text_size == 0) slot.largest = declared::largest(field.word);
    if (field.scaled()) describe_scaled(frame, field, slot);
    const auto mark = field.variable ? declared::mark_behind(frame, i) : std::nullopt;
    if (!mark) continue;
    const declared::Field& next = frame.fields[*mark];
    slot.end_of_text = next.text.empty() ? static_cast<std::uint8_t>(next.number)
                                         : static_cast<std::uint8_t>(next.text[0]);
  }
  return found;
}

// An odd text leaves its last byte empty.
Bytes text_contents(const Slot& slot, std::mt19937& random) {
  Bytes image(image_bytes(slot.item_bits, slot.range.count));
  for (std::size_t i = 0; i < std::min<std::size_t>(slot.text_bytes, image.size()); ++i) {
    do image[i] = static_cast<std::uint8_t>('A' + random() % 26);
    while (image[i] == slot.end_of_text);
  }
  return image;
}

}  // namespace

std::vector<Slot> Requests::places(AreaIndex area) const {
  std::vector<Slot> slots;
  if (!subject_.device.declaration) return slots;
  const declared::Declaration& declaration = *subject_.device.declaration.value;
  for (const declared::Place& place : declaration.areas[area].places) {
    Slot slot{{area, place.first, place.items}, 16, place.bits, place.is_signed};
    bool sent = false;
    for (const declared::Operation& operation : declaration.operations) {
      if (operation.area == area && !operation.write)
        sent = describe(operation.form(subject_.form), slot) || sent;
    }
    if (sent) slots.push_back(slot);
  }
  return slots;
}

std::vector<Slot> Requests::slots(AreaIndex area, std::uint32_t count) const {
  const Area& row = protocol_->areas()[area];
  std::vector<Slot> slots;
  if (count == 0 || count > row.items) return slots;
  std::set<std::uint32_t> firsts{0, row.items / 2, row.items - count};
  for (const std::uint32_t first : firsts) {
    const Range range{area, first, count};
    if (first + count <= row.items && allows(ReadRequest{{range}})) slots.push_back(slot(range));
  }
  return slots;
}

Slot Requests::slot(const Range& range) const {
  const Area& area = protocol_->areas()[range.area];
  Slot slot{range, area.item_bits};
  if (area.counted) {
    slot.by_item = true;
    slot.value_bits = area.item_bits;
    slot.largest = area.bank - 1;
    slot.counts = range.first % area.bank == 0 && range.count > 1;
  }
  if (!subject_.device.declaration || slot.item_bits == 1) return slot;
  for (const declared::Operation& operation : subject_.device.declaration.value->operations) {
    for (const declared::Field& field : operation.response.fields) {
      if (operation.area != range.area || field.kind != declared::FieldKind::kItems) continue;
      const std::uint64_t largest = declared::largest(field.word);
      if (largest >= UINT64_MAX >> (64 - slot.item_bits)) continue;
      slot.by_item = true;
      slot.value_bits = slot.item_bits;
      slot.is_signed = field.is_signed;
      slot.largest = std::min(slot.largest, largest);
    }
  }
  return slot;
}

std::optional<Range> Requests::largest_read(AreaIndex area) const {
  const Area& row = protocol_->areas()[area];
  for (std::uint32_t count = std::min<std::uint32_t>(row.max_read, row.items); count > 0; --count) {
    if (allows(ReadRequest{{Range{area, 0, count}}})) return Range{area, 0, count};
  }
  return std::nullopt;
}

std::optional<Range> Requests::largest_write(AreaIndex area) const {
  const Area& row = protocol_->areas()[area];
  for (std::uint32_t count = std::min<std::uint32_t>(row.max_write, row.items);
       row.writable && count > 0; --count) {
    const Range range{area, row.items - count, count};
    if (allows(WriteRequest{.range = range, .items = Bytes(image_bytes(row.item_bits, count))}))
      return range;
  }
  return std::nullopt;
}

std::vector<NamedRequest> Requests::examples() const {
  std::vector<NamedRequest> all;
  ReadRequest list;
  // Item widths that already have a largest read: one for each width is enough.
  std::set<unsigned> large;
  const auto add = [&](const std::string& name, Request request) {
    if (allows(request)) all.push_back({name, std::move(request)});
  };
  for (std::size_t i = 0; i < protocol_->areas().size(); ++i) {
    const auto area = static_cast<AreaIndex>(i);
    const Area& row = protocol_->areas()[i];
    const std::string name(row.name);
    std::vector<Slot> tried = places(area);
    if (tried.empty())
      tried = {slot(
          {area, 0,
           std::clamp<std::uint32_t>(row.max_read, 1, std::min<std::uint32_t>(3, row.items))})};
    for (const Slot& slot : tried) {
      add("read " + name, ReadRequest{{slot.range}});
      WriteRequest write{.range = slot.range,
                         .items = Bytes(image_bytes(slot.item_bits, slot.range.count))};
      write.items.back() = 1;
      if (slot.exponents) write.items.back() = 0, write.items.front() = '1';
      if (!allows(write)) write.range.count = 1, write.items.resize(image_bytes(slot.item_bits, 1));
      add("write " + name, write);
      if (protocol_->traits().write_read)
        add("write and read " + name, WriteReadRequest{write, write.range});
      if (row.bit_write && row.item_bits > 1) {
        WriteRequest bit{.range = {area, slot.range.first, 1},
                         .items = Bytes(image_bytes(row.item_bits, 1), 0xFF),
                         .bit = 3};
        add("write a bit of " + name, bit);
      }
    }
    if (const auto range = largest_read(area);
        range && range->count > 3 && large.insert(row.item_bits).second) {
      add(fmt::format("read {}, most", name), ReadRequest{{*range}});
    }
    list.ranges.push_back({area, 0, 1});
    list.ranges.push_back({area, row.items - 1, 1});
    if (!allows(list)) list.ranges.resize(list.ranges.size() - 2);
  }
  if (protocol_->traits().max_ranges > 1 && list.ranges.size() > 1)
    add("read a list of all areas", list);
  return all;
}

namespace {

std::uint64_t image_number(ByteView image) {
  std::uint64_t number = 0;
  for (const std::uint8_t byte : image) number = number << 8 | byte;
  return number;
}

}  // namespace

Bytes Requests::contents(const Slot& slot, std::mt19937& random) {
  if (slot.exponents) return scaled_contents(slot, random);
  if (slot.text_bytes != 0) return text_contents(slot, random);
  Bytes image(image_bytes(slot.item_bits, slot.range.count));
  for (std::uint8_t& byte : image)
    byte = static_cast<std::uint8_t>(slot.item_bits == 1 ? random() % 2 : random());
  if (slot.value_bits == 0) return image;
  const std::size_t each = slot.by_item ? image_bytes(slot.item_bits, 1) : image.size();
  for (std::size_t at = 0; at < image.size(); at += each) {
    std::uint64_t number = image_number(ByteView(image).subspan(at, each));
    const bool below = slot.is_signed && number % 2 != 0;
    number &= UINT64_MAX >> (64 - slot.value_bits);
    if (slot.largest != UINT64_MAX && number > slot.largest) {
      number %= slot.largest + 1;
      if (below) number = (0 - number) & (UINT64_MAX >> (64 - slot.value_bits));
    }
    const bool negative = slot.is_signed && (number >> (slot.value_bits - 1) & 1u) != 0;
    if (negative && slot.value_bits < 64) number |= UINT64_MAX << slot.value_bits;
    for (std::size_t i = at + each; i-- > at; number >>= 8)
      image[i] = static_cast<std::uint8_t>(number);
  }
  if (slot.counts) image[each - 1] = static_cast<std::uint8_t>(slot.range.count - 1);
  return image;
}

bool Requests::holds(const Slot& slot, ByteView image) {
  if (!slot.by_item) return true;
  const std::size_t each = image_bytes(slot.item_bits, 1);
  for (std::size_t at = 0; at < image.size(); at += each) {
    const std::uint64_t number = image_number(image.subspan(at, each));
    const std::uint64_t below = (0 - number) & (UINT64_MAX >> (64 - slot.item_bits));
    if (number > slot.largest && !(slot.is_signed && below <= slot.largest)) return false;
  }
  return true;
}

bool Requests::poke(SimDevice& device, std::string_view area, const Slot& slot, ByteView image) {
  const std::size_t each = image_bytes(slot.item_bits, 1);
  for (std::uint32_t i = 0; i < slot.range.count; ++i) {
    std::uint64_t item = 0;
    for (std::size_t byte = 0; byte < each; ++byte) item = item << 8 | image[i * each + byte];
    if (!device.poke(area, slot.range.first + i, item)) return false;
  }
  return true;
}

std::optional<Bytes> Requests::peek(SimDevice& device, std::string_view area, const Slot& slot,
                                    Instant now) {
  Bytes image;
  const std::size_t each = image_bytes(slot.item_bits, 1);
  for (std::uint32_t i = 0; i < slot.range.count; ++i) {
    const auto item = device.peek(area, slot.range.first + i, now);
    if (!item) return std::nullopt;
    for (std::size_t byte = each; byte-- > 0;)
      image.push_back(static_cast<std::uint8_t>(*item >> 8 * byte));
  }
  return image;
}

bool frame_begins_in(const Subject& subject, ByteView bytes, std::size_t noise) {
  if (!subject.device.declaration) return false;
  for (std::size_t at = 0; at < noise; ++at) {
    if (declared::begins_checked_response(*subject.device.declaration.value, bytes.subspan(at)))
      return true;
  }
  return false;
}

namespace {

// Uses the base of the declaration; hexadecimal digits in both cases.
void add_numbered(const declared::DeclaredArea& area, std::vector<std::string>& all) {
  const std::uint32_t last = area.origin + area.items - 1;
  const auto add = [&](std::uint32_t item) {
    const std::string upper = declared::item_text(area, item - area.origin);
    std::string lower = upper;
    std::transform(upper.begin() + static_cast<std::ptrdiff_t>(area.prefix.size()), upper.end(),
                   lower.begin() + static_cast<std::ptrdiff_t>(area.prefix.size()), [](char c) {
                     return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
                   });
    all.push_back(lower);
    if (upper != lower) all.push_back(upper);
  };
  add(area.origin);
  if (area.items > 1) add(last);
  if (area.items > 31) add(area.origin + 30);
  if (area.item_bits > 1 && area.items > 2) all.push_back(declared::item_text(area, 1) + ".3");
}

}  // namespace

std::vector<std::string> notations_of(const Subject& subject) {
  if (!subject.device.declaration) return {subject.addresses.begin(), subject.addresses.end()};
  std::vector<std::string> all;
  for (const declared::DeclaredArea& area : subject.device.declaration.value->areas) {
    if (!area.record && !area.trigger) add_numbered(area, all);
    for (const declared::Place& place : area.places) {
      all.push_back(place.name);
      if (place.bits != 0) all.push_back(fmt::format("{}.{}", place.name, place.bits - 1));
    }
  }
  return all;
}

Encoding natural_encoding(const ParsedAddress& address, const Area& area,
                          const declared::Declaration* declaration) {
  Encoding encoding;
  encoding.word_order = area.word_order;
  encoding.bit = address.bit;
  if (area.item_bits == 1 || address.bit) {
    encoding.type = ValueType::kBool;
    return encoding;
  }
  encoding.layout = address.text_layout;
  if (address.text_layout == TextLayout::kCounted) {
    encoding.type = ValueType::kString;
    encoding.string_bytes = 8;
    return encoding;
  }
  if (declaration == nullptr && address.text_characters != 0) {
    encoding.type = ValueType::kString;
    encoding.string_bytes = address.text_characters;
    return encoding;
  }
  if (declaration != nullptr && declaration->areas[address.area].record && !address.width_bits) {
    for (const declared::Place& place : declaration->areas[address.area].places) {
      if (place.first != address.first) continue;
      encoding.type = ValueType::kString;
      encoding.string_bytes = place.characters;
    }
    return encoding;
  }
  switch (address.width_bits.value_or(area.item_bits)) {
    case 8: encoding.type = ValueType::kUint8; break;
    case 32: encoding.type = ValueType::kUint32; break;
    case 64: encoding.type = ValueType::kUint64; break;
    default: encoding.type = ValueType::kUint16;
  }
  return encoding;
}

}  // namespace fieldcast::sim
