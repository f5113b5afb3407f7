#include <fmt/format.h>

#include <algorithm>

#include "core/codec/value_codec.hpp"
#include "tools/sim/check/requests.hpp"
#include "tools/sim/check/sim_check.hpp"

namespace fieldcast::sim {
namespace {

struct TypedValues {
  Encoding encoding;
  std::vector<Value> values;
};

std::vector<TypedValues> all_types() {
  const auto i = [](std::int64_t value) { return Value{value}; };
  const auto u = [](std::uint64_t value) { return Value{value}; };
  std::vector<TypedValues> plain{
      {{.type = ValueType::kBool}, {Value{true}, Value{false}}},
      {{.type = ValueType::kInt8}, {i(-128), i(-2), i(0), i(127)}},
      {{.type = ValueType::kUint8}, {u(0), u(0x12), u(255)}},
      {{.type = ValueType::kBcd8}, {u(0), u(12), u(99)}},
      {{.type = ValueType::kInt16}, {i(-32768), i(-2), i(0), i(32767)}},
      {{.type = ValueType::kUint16}, {u(0), u(0x1234), u(65535)}},
      {{.type = ValueType::kInt32}, {i(-2147483648LL), i(-2), i(0x12345678)}},
      {{.type = ValueType::kUint32}, {u(0), u(0x12345678), u(4294967295U)}},
      {{.type = ValueType::kInt64}, {i(INT64_MIN), i(-2), i(0x123456789ABCDEF0)}},
      {{.type = ValueType::kUint64}, {u(0), u(0x123456789ABCDEF0), u(UINT64_MAX)}},
      {{.type = ValueType::kFloat32}, {Value{0.0}, Value{-1.5}, Value{123456.75}}},
      {{.type = ValueType::kFloat64}, {Value{0.0}, Value{-1e100}, Value{0.1}}},
      {{.type = ValueType::kBcd16}, {u(0), u(1234), u(9999)}},
      {{.type = ValueType::kBcd32}, {u(0), u(12345678), u(99999999)}},
      {{.type = ValueType::kString, .string_bytes = 5},
       {Value{std::string("LOT-1")}, Value{std::string("ab")}}},
      {{.type = ValueType::kString, .string_bytes = 29, .layout = TextLayout::kDtl},
       {Value{std::string("2026-11-28T10:15:00.123456789")}}},
      {{.type = ValueType::kString, .string_bytes = 23, .layout = TextLayout::kDateAndTime},
       {Value{std::string("1999-12-31T23:59:59.999")}}},
      {{.type = ValueType::kFloat64,
        .string_bytes = 7,
        .text_number = {.kind = TextNumber::Kind::kDecimal,
                        .decimals = 2,
                        .leading_zeros = true,
                        .plus = true}},
       {Value{25.0}, Value{-0.25}, Value{999.99}}},
      {{.type = ValueType::kInt32,
        .string_bytes = 8,
        .text_number = {.kind = TextNumber::Kind::kDecimalComma}},
       {i(0), i(-1234567), i(12345678)}},
      {{.type = ValueType::kInt16,
        .string_bytes = 4,
        .text_number = {.kind = TextNumber::Kind::kHex}},
       {i(-2), i(0x1234)}},
  };
  std::vector<TypedValues> all;
  for (const TypedValues& each : plain) {
    all.push_back(each);
    if (width_bits(each.encoding) < 16) continue;
    all.push_back(each);
    all.back().encoding.byte_order = ByteOrder::kLittleEndian;
    if (width_bits(each.encoding) < 32 || each.encoding.is_text()) continue;
    all.push_back(each);
    all.back().encoding.word_order = WordOrder::kLittleEndian;
  }
  return all;
}

class ValueCheck {
 public:
  ValueCheck(const Subject& subject, CheckRows& rows)
      : requests_(subject), live_(subject), rows_(rows) {}

  void run() {
    const auto types = all_types();
    for (std::size_t i = 0; i < requests_.protocol().areas().size(); ++i) {
      const auto area = static_cast<AreaIndex>(i);
      if (requests_.protocol().areas()[i].unsolicited > Duration::zero()) continue;
      const auto places = requests_.places(area);
      rows_.push_back({.check = "read", .where = name(area)});
      read_ = rows_.size() - 1;
      rows_.push_back({.check = "write and read back", .where = name(area)});
      write_ = rows_.size() - 1;
      for (const Slot& place : places) {
        for (int round = 0; round < 8; ++round) raw(place);
      }
      if (places.empty()) {
        for (const TypedValues& each : types) typed(area, each);
        if (const auto range = requests_.largest_read(area)) raw(requests_.slot(*range));
        if (const auto range = requests_.largest_write(area)) raw(requests_.slot(*range));
        bit(area);
        byte(area);
      }
      if (rows_[write_].tried == 0) {
        const bool readable = requests_.protocol().areas()[i].max_read != 0;
        rows_[write_].note = readable ? "read-only" : "a command without a value: see splits";
        if (!readable) rows_[read_].note = "cannot be read";
      }
    }
    lists();
  }

 private:
  std::string name(AreaIndex area) const { return std::string(requests_.area_name(area)); }
  unsigned bits(AreaIndex area) const { return requests_.protocol().areas()[area].item_bits; }
  RunOutcome ask(const Request& request) {
    return live_.run(requests_.protocol().begin(request, live_.context(++sequence_)));
  }

  void typed(AreaIndex area, const TypedValues& type) {
    if (bits(area) == 1 && type.encoding.type != ValueType::kBool) return;
    if (bits(area) > 1 && type.encoding.type == ValueType::kBool) return;  // see bit()
    const std::uint32_t count = item_count(type.encoding, bits(area));
    for (const Slot& slot : requests_.slots(area, count)) {
      for (const Value& value : type.values) {
        const auto image = encode_value(type.encoding, bits(area), value);
        if (!image || !Requests::holds(slot, *image)) continue;
        const auto judge = [&](ByteView items) {
          return decode_value(type.encoding, bits(area), items) == value;
        };
        read(slot, *image, judge, std::string(to_text(type.encoding.type)));
        write(slot, *image, std::string(to_text(type.encoding.type)));
      }
    }
  }

  void raw(const Slot& slot) {
    const Bytes image = Requests::contents(slot, random_);
    read(
        slot, image, [&](ByteView items) { return std::ranges::equal(items, image); }, "items");
    write(slot, Requests::contents(slot, random_), "items");
  }

  template <typename Judge>
  void read(const Slot& slot, const Bytes& image, const Judge& judge, const std::string& what) {
    const ReadRequest request{{slot.range}};
    if (!requests_.allows(request)) return;
    if (!Requests::poke(live_.device(), name(slot.range.area), slot, image)) {
      rows_[read_].note = "the simulated device has no such items";
      return;
    }
    const RunOutcome outcome = ask(request);
    const bool right = outcome.done && outcome.reply.size() == 1 &&
                       outcome.reply[0].cause == Cause::kNone && judge(outcome.reply[0].items);
    right ? rows_[read_].pass()
          : rows_[read_].fail(fmt::format("{} from {}, held {}: {}", what, slot.range.first,
                                          to_hex(image), outcome.text()),
                              frames(outcome.sent));
  }

  void write(const Slot& slot, const Bytes& image, const std::string& what) {
    const std::size_t each = image_bytes(slot.item_bits, 1);
    WriteRequest whole{.range = slot.range, .items = image};
    std::vector<WriteRequest> writes{whole};
    if (!requests_.allows(whole)) {  // single items if the protocol allows no more
      writes.clear();
      for (std::uint32_t i = 0; i < slot.range.count; ++i) {
        writes.push_back(
            {.range = {slot.range.area, slot.range.first + i, 1},
             .items = Bytes(image.begin() + static_cast<std::ptrdiff_t>(i * each),
                            image.begin() + static_cast<std::ptrdiff_t>((i + 1) * each))});
      }
      if ((slot.value_bits != 0 && !slot.by_item) || writes.empty() || !requests_.allows(writes[0]))
        return;
    }
    for (const WriteRequest& request : writes) {
      const RunOutcome outcome = ask(request);
      if (outcome.cause == Cause::kDeviceError && slot.range.first == 0) {
        rows_[write_].note = "the device refuses to have its first items written";
        return;
      }
      if (!outcome.done)
        return rows_[write_].fail(
            fmt::format("{} to {}: {}", what, slot.range.first, outcome.text()),
            frames(outcome.sent));
    }
    const auto held = Requests::peek(live_.device(), name(slot.range.area), slot, live_.now());
    const RunOutcome back = ask(ReadRequest{{slot.range}});
    const bool right =
        held == image && back.done && back.reply.size() == 1 && back.reply[0].items == image;
    right ? rows_[write_].pass()
          : rows_[write_].fail(fmt::format("{} to {} of {}: the device holds {}, read back {}",
                                           what, slot.range.first, to_hex(image),
                                           held ? to_hex(*held) : "nothing", back.text()),
                               frames(back.sent));
  }

  // The last item of an area; the write changes some of its bits or bytes.
  Slot last_item(AreaIndex area) const {
    const Area& row = requests_.protocol().areas()[area];
    return {{area, row.items - 1, 1}, row.item_bits};
  }

  // Writes a part of an item; the device must then hold `after`.
  void part(const Slot& slot, const WriteRequest& request, const Bytes& after,
            const std::string& what) {
    const RunOutcome outcome = ask(request);
    const auto held = Requests::peek(live_.device(), name(slot.range.area), slot, live_.now());
    outcome.done&& held == after
        ? rows_[write_].pass()
        : rows_[write_].fail(fmt::format("{}: {}, the device holds {}", what, outcome.text(),
                                         held ? to_hex(*held) : "nothing"),
                             frames(outcome.sent));
  }

  void bit(AreaIndex area) {
    const Area& row = requests_.protocol().areas()[area];
    if (!row.bit_write || row.item_bits == 1) return;
    const Slot slot = last_item(area);
    for (unsigned at = 0; at < row.item_bits; ++at) {
      for (const bool on : {true, false}) {
        Bytes image = Requests::contents(slot, random_);
        if (!Requests::poke(live_.device(), name(area), slot, image)) return;
        const WriteRequest request{.range = slot.range,
                                   .items = Bytes(image.size(), on ? 0xFF : 0x00),
                                   .bit = static_cast<std::uint8_t>(at)};
        if (!requests_.allows(request)) return;
        // With a window the protocol stores what it wrote: start from there.
        if (row.window && !ask(WriteRequest{.range = slot.range, .items = image}).done) return;
        merge_bit(image, at, on);
        part(slot, request, image, fmt::format("bit {}", at));
      }
    }
  }

  void byte(AreaIndex area) {
    if (!requests_.protocol().areas()[area].byte_write) return;
    const Slot slot = last_item(area);
    for (unsigned at = 0; at < slot.item_bits; at += 8) {
      Bytes image = Requests::contents(slot, random_);
      if (!Requests::poke(live_.device(), name(area), slot, image)) return;
      const auto own = static_cast<std::uint8_t>(random_());
      const WriteRequest request{.range = slot.range,
                                 .items = Bytes(image.size(), own),
                                 .bit = static_cast<std::uint8_t>(at),
                                 .bits = 8};
      image[image.size() - 1 - at / 8] = own;
      part(slot, request, image, fmt::format("byte {}", at / 8));
    }
  }

  void lists() {
    const unsigned most = requests_.protocol().traits().max_ranges;
    if (most < 2) return;
    rows_.push_back({.check = "read", .where = "lists"});
    CheckRow& row = rows_.back();
    for (int round = 0; round < 50; ++round) {
      ReadRequest request;
      std::vector<Bytes> expected;
      for (unsigned i = 0; i < std::min(most, 12u); ++i) {
        const auto area = static_cast<AreaIndex>(random_() % requests_.protocol().areas().size());
        const Area& shape = requests_.protocol().areas()[area];
        const Slot slot =
            requests_.slot({area, static_cast<std::uint32_t>(random_() % shape.items), 1});
        const bool twice = std::ranges::find(request.ranges, slot.range) != request.ranges.end();
        request.ranges.push_back(slot.range);
        const Bytes image = Requests::contents(slot, random_);
        const bool there = !twice && requests_.allows(request) &&
                           Requests::poke(live_.device(), name(area), slot, image);
        there ? expected.push_back(image) : request.ranges.pop_back();
      }
      const RunOutcome outcome = ask(request);
      bool right = outcome.done && outcome.reply.size() == expected.size();
      for (std::size_t i = 0; right && i < expected.size(); ++i)
        right = outcome.reply[i].items == expected[i];
      right ? row.pass()
            : row.fail(fmt::format("{} ranges: {}", expected.size(), outcome.text()),
                       frames(outcome.sent));
    }
  }

  Requests requests_;
  LiveDevice live_;
  CheckRows& rows_;
  std::size_t read_ = 0, write_ = 0;
  std::uint16_t sequence_ = 0;
  std::mt19937 random_{1};
};

}  // namespace

void check_values(const Subject& subject, CheckRows& rows) { ValueCheck(subject, rows).run(); }

}  // namespace fieldcast::sim
