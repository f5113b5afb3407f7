// Areas, addresses, requests and explanations of the declarations that are shipped:
// facts/PROTOCOL.txt.
#include "tests/protocol/facts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/model/scan_question.hpp"
#include "tests/support/declared_device.hpp"

namespace fieldcast::test {
namespace {

std::string explained(const declared::Declaration& declaration, const Bytes& frame) {
  std::string text;
  for (const FrameField& field : declared::explain(declaration, frame, declared::Sender::kUnknown))
    text += "      " + std::to_string(field.offset) + '+' + std::to_string(field.length) + ' ' +
            field.name + ": " + field.value + (field.fault.empty() ? "" : " !! ") + field.fault +
            '\n';
  const SeenRequest seen = declared::seen_request(declaration, frame);
  return text + "      request: " + std::to_string(seen.size) +
         (seen.certain ? " bytes\n" : " bytes, or a response\n");
}

std::string asked(const declared::Declaration& declaration, const Protocol& protocol,
                  const Request& request) {
  std::string text = request_text(protocol, request);
  if (!protocol.size(request)) return text;
  Bytes out;
  (void)protocol.begin(request, {1})->start(out);
  return text + explained(declaration, out);
}

std::string facts(const std::string& name) {
  const declared::SharedDeclaration shared{declaration(name)};
  const auto protocol = std::move(*declared::make(shared.value, {.address = 1}));
  std::string text;
  for (AreaIndex index = 0; index < protocol->areas().size(); ++index) {
    const declared::DeclaredArea& declared = shared.value->areas[index];
    const Area& area = protocol->areas()[index];
    text += area_text(area);
    for (const declared::Place& place : declared.places)
      text += "    " + address_text(*protocol, place.name);
    const std::uint32_t items =
        declared.record ? area.items : std::min<std::uint32_t>(2, area.max_read);
    if (items != 0)
      text += "    read " + asked(*shared.value, *protocol, ReadRequest{{{index, 0, items}}});
    if (!area.writable) continue;
    const std::uint32_t written = declared.places.empty() ? 1 : declared.places[0].items;
    const Bytes image(image_bytes(area.item_bits, written), 1);
    text +=
        "    write " + asked(*shared.value, *protocol, WriteRequest{{index, 0, written}, image});
  }
  for (const ScanQuestion& each : scan_questions(*protocol, shared))
    text += "  question " + each.at + ' ' + std::to_string(each.range.count) + '\n';
  return text;
}

std::vector<std::string> shipped() {
  std::vector<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(FIELDCAST_PROTOCOLS)) {
    if (file.path().extension() == ".yaml") names.push_back(file.path().stem());
  }
  std::ranges::sort(names);
  return names;
}

class DeclaredFacts : public testing::TestWithParam<std::string> {};

TEST_P(DeclaredFacts, AreAsWritten) {
  const std::string name = FIELDCAST_DECLARED_FACTS "/" + GetParam() + ".txt";
  std::ifstream file(name);
  ASSERT_TRUE(file) << name;
  std::ostringstream whole;
  whole << file.rdbuf();
  EXPECT_EQ(facts(GetParam()), whole.str());
}

TEST_P(DeclaredFacts, ARequestOutsideOfTheAreasHasNoSize) {
  const auto shared = declaration(GetParam());
  const auto protocol = std::move(*declared::make(shared, {.address = 1}));
  const auto expect_refused = [&](const Request& request, const std::string& what) {
    EXPECT_FALSE(protocol->size(request)) << what;
  };
  expect_refused(ReadRequest{}, "no range");
  for (AreaIndex index = 0; index < protocol->areas().size(); ++index) {
    const Area& area = protocol->areas()[index];
    const std::string name(area.name);
    const Range range{index, 0, area.window ? area.items : 1};
    std::vector<Range> faults(4, range);
    faults[0].area = static_cast<AreaIndex>(protocol->areas().size());
    faults[1].count = 0;
    faults[2].first = area.items;
    faults[3].count = area.items + 1;
    expect_refused(ReadRequest{{range, range}}, name + ", two ranges");
    WriteRequest write{range, Bytes(image_bytes(area.item_bits, range.count), 1)};
    expect_refused(WriteReadRequest{write, range}, name + ", write and read");
    for (const Range& fault : faults) {
      expect_refused(ReadRequest{{fault}}, name + ", read " + std::to_string(fault.first) + ' ' +
                                               std::to_string(fault.count));
      expect_refused(
          WriteRequest{fault, Bytes(image_bytes(area.item_bits, fault.count), 1)},
          name + ", write " + std::to_string(fault.first) + ' ' + std::to_string(fault.count));
    }
    write.items.push_back(0);
    expect_refused(write, name + ", more bytes than items");
    write.items.pop_back();
    write.bit = 0;
    if (area.item_bits != 1) expect_refused(write, name + ", a bit of an item");
    const Request right = ReadRequest{{range}}, wrong = ReadRequest{{faults[1]}};
    if (!protocol->size(right)) continue;
    EXPECT_TRUE(protocol->mistakable(right, {1}, wrong, {1})) << name << ": in doubt, true";
    EXPECT_TRUE(protocol->mistakable(wrong, {1}, right, {1})) << name << ": in doubt, true";
  }
}

TEST_P(DeclaredFacts, EndlessBytesAreNoFrame) {
  const auto shared = declaration(GetParam());
  const auto fields = declared::explain(*shared, Bytes(70000, '0'));
  ASSERT_EQ(fields.size(), 1u);
  EXPECT_EQ(fields.front().fault, "longer than any frame of a declared protocol");
}

INSTANTIATE_TEST_SUITE_P(Shipped, DeclaredFacts, testing::ValuesIn(shipped()), [](const auto& row) {
  std::string name = row.param;
  std::ranges::replace(name, '-', '_');
  return name;
});

}  // namespace
}  // namespace fieldcast::test
