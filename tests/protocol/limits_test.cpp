// What every protocol refuses: requests outside of its areas, and bytes without an end.
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "core/protocol/families/registry.hpp"

namespace fieldcast::test {
namespace {

struct Variant {
  const ProtocolEntry* entry;
  std::unique_ptr<Protocol> protocol;
  std::vector<Range> reads;  // of the addresses of the documents, the least that can be read
  std::string text;
};

std::vector<Variant> every_variant() {
  std::vector<Variant> all;
  for (const ProtocolEntry& entry : protocols()) {
    for (const ProtocolVariant& variant : entry.variants) {
      DeviceLink link{.address = 1};
      std::string text(entry.name);
      for (const auto& [name, value] : variant.options) {
        link.options.emplace(name, value);
        text += ' ' + std::string(name) + '=' + std::string(value);
      }
      Variant made{&entry, std::move(entry.make(link).value()), {}, text};
      for (const std::string_view at : variant.addresses) {
        const auto parsed = made.protocol->parse_address(at);
        if (!parsed) continue;
        const Area& area = made.protocol->areas()[parsed->area];
        const Range range{parsed->area, parsed->first - parsed->first % area.alignment,
                          area.alignment};
        if (made.protocol->size(ReadRequest{{range}})) made.reads.push_back(range);
      }
      EXPECT_FALSE(made.reads.empty()) << text;
      all.push_back(std::move(made));
    }
  }
  return all;
}

// The same range with one fault each.
std::vector<Range> faulty(const Protocol& protocol, Range range, bool write) {
  const auto areas = protocol.areas();
  const Area& area = areas[range.area];
  std::vector<Range> faults(5, range);
  faults[0].area = static_cast<AreaIndex>(areas.size());
  faults[1].count = 0;
  faults[2].first = area.items;
  faults[3].first = area.items - area.alignment;
  faults[3].count = 2u * area.alignment;
  faults[4].count = std::uint32_t{write ? area.max_write : area.max_read} + area.alignment;
  return faults;
}

TEST(Limits, ARequestOutsideOfTheAreasHasNoSize) {
  for (const Variant& each : every_variant()) {
    const Protocol& protocol = *each.protocol;
    const auto expect_refused = [&](const Request& request, const std::string& what) {
      EXPECT_FALSE(protocol.size(request)) << each.text << ": " << what;
    };
    expect_refused(ReadRequest{}, "no range");
    const std::size_t too_many = protocol.traits().max_ranges + std::size_t{1};
    for (const Range& range : each.reads) {
      const Area& area = protocol.areas()[range.area];
      const std::string name(area.name);
      expect_refused(ReadRequest{std::vector(too_many, range)}, name + ", too many ranges");
      for (const Range& fault : faulty(protocol, range, false))
        expect_refused(ReadRequest{{fault}}, name + ", read " + std::to_string(fault.first) + ' ' +
                                                 std::to_string(fault.count));
      const WriteRequest right{range, Bytes(image_bytes(area.item_bits, range.count))};
      if (!area.writable) {
        expect_refused(right, name + ", not writable");
        continue;
      }
      if (!protocol.size(right)) continue;  // only bits of it
      for (const Range& fault : faulty(protocol, range, true)) {
        WriteRequest write{fault, Bytes(image_bytes(area.item_bits, fault.count))};
        expect_refused(write, name + ", write " + std::to_string(fault.first) + ' ' +
                                  std::to_string(fault.count));
      }
      WriteRequest write = right;
      write.items.push_back(0);
      expect_refused(write, name + ", more bytes than items");
      if (area.item_bits == 1) continue;
      write = right;
      write.bit = 64;
      expect_refused(write, name + ", a bit beyond the item");
      write.bit = 0;
      if (!area.bit_write) expect_refused(write, name + ", no bit can be written");
      write.range.count = 2;
      write.items = Bytes(image_bytes(area.item_bits, 2));
      expect_refused(write, name + ", a bit of two items");
    }
  }
}

TEST(Limits, AWriteWithReadIsRefusedAsItsParts) {
  for (const Variant& each : every_variant()) {
    const Protocol& protocol = *each.protocol;
    std::size_t possible = 0;
    for (const Range& range : each.reads) {
      const Area& area = protocol.areas()[range.area];
      const WriteReadRequest right{{range, Bytes(image_bytes(area.item_bits, range.count))}, range};
      if (!protocol.size(right)) continue;
      ++possible;
      const auto expect_refused = [&](const WriteReadRequest& request, const std::string& what) {
        EXPECT_FALSE(protocol.size(request)) << each.text << ' ' << area.name << ": " << what;
      };
      for (const Range& fault : faulty(protocol, range, false))
        expect_refused({right.write, fault},
                       "read " + std::to_string(fault.first) + ' ' + std::to_string(fault.count));
      for (const Range& fault : faulty(protocol, range, true))
        expect_refused({{fault, Bytes(image_bytes(area.item_bits, fault.count))}, range},
                       "write " + std::to_string(fault.first) + ' ' + std::to_string(fault.count));
      WriteReadRequest wrong = right;
      wrong.write.items.push_back(0);
      expect_refused(wrong, "more bytes than items");
      wrong = right;
      wrong.write.bit = 64;
      expect_refused(wrong, "a bit beyond the item");
    }
    EXPECT_TRUE(possible != 0 || !protocol.traits().write_read) << each.text;
  }
}

const std::uint8_t kNoise[] = {0x00, 0x02, 0x03, 0x10, '0', '1', ':', '@', 'D', 0x68, 0xFF};

std::vector<Request> a_read_and_a_write(const Variant& variant) {
  std::vector<Request> requests{ReadRequest{{variant.reads.front()}}};
  for (const Range& range : variant.reads) {
    const Area& area = variant.protocol->areas()[range.area];
    const WriteRequest write{range, Bytes(image_bytes(area.item_bits, range.count))};
    if (requests.size() == 1 && variant.protocol->size(write)) requests.emplace_back(write);
  }
  EXPECT_EQ(requests.size(), 2u) << variant.text;
  return requests;
}

// A line that never becomes silent must not fill the memory.
TEST(Limits, AnExchangeEndsWithinNoiseWithoutAnEnd) {
  constexpr std::size_t kStep = 509, kMost = 160 * kStep;
  for (const Variant& each : every_variant()) {
    for (const std::uint8_t noise : kNoise) {
      for (const Request& request : a_read_and_a_write(each)) {
        const auto exchange = each.protocol->begin(request, {1, nullptr});
        Bytes out;
        (void)exchange->start(out);
        Bytes all;
        Step step = Step::need_response();
        while (step.kind == Step::Kind::kNeedMore && all.size() < kMost) {
          all.resize(all.size() + kStep, noise);
          step = exchange->on_bytes(all, out);
        }
        EXPECT_EQ(step.kind, Step::Kind::kFailed) << each.text << ", noise " << int{noise};
      }
    }
  }
}

// What follows the longest frame of a protocol is not looked at.
TEST(Limits, ExplanationOfEndlessBytesStaysWithinThem) {
  for (const ProtocolEntry& entry : protocols()) {
    for (const std::uint8_t noise : kNoise) {
      const Bytes bytes(70000, noise);
      const auto fields = entry.explain(bytes);
      EXPECT_FALSE(fields.empty()) << entry.name << ", bytes " << int{noise};
      for (const FrameField& field : fields)
        EXPECT_LE(field.offset + field.length, bytes.size()) << entry.name << ": " << field.name;
      if (entry.seen_request == nullptr) continue;
      EXPECT_FALSE(entry.seen_request(bytes)) << entry.name << ", bytes " << int{noise};
    }
  }
}

}  // namespace
}  // namespace fieldcast::test
