// Tests how requests of declared protocols name a range, and areas that continue each other.
#include <gtest/gtest.h>

#include "tests/support/declared_device.hpp"
#include "tests/support/drive.hpp"

namespace fieldcast::test {
namespace {

// Registers D0 to D99 begin at 1000, D100 to D149 at 5000. A request names the first and the last.
constexpr std::string_view kRanges = R"(
summary: registers by their first and last number
addresses: { from: 1, to: 9 }
areas:
  - { name: D, prefix: D, items: 100 }
  - { name: D-high, prefix: D, origin: 100, items: 50 }
operations:
  - name: read
    read: D
    count: 20
    request: [{ name: ask, constant: "R" }, { is: first, as: decimal, digits: 4, plus: 1000 },
              { is: last, as: decimal, digits: 4, plus: 1000 }]
    answer: [{ name: ask, constant: "r" }, { is: last, as: decimal, digits: 4, plus: 1000 },
             { is: items, as: hex }]
  - name: write
    write: D
    count: 20
    request: &set [{ name: ask, constant: "W" }, { is: first, as: decimal, digits: 4, plus: 1000 },
                   { is: last, as: decimal, digits: 4, plus: 1000 }, { is: items, as: hex }]
    answer: *set
  - name: read the higher ones
    read: D-high
    count: 20
    request: [{ name: ask, constant: "R" },
              { is: first, as: decimal, digits: 4, times: 2, plus: 5000 },
              { is: last, as: decimal, digits: 4, times: 2, plus: 5000 }]
    answer: [{ name: ask, constant: "r" },
             { is: last, as: decimal, digits: 4, times: 2, plus: 5000 }, { is: items, as: hex }]
)";

Device ranges() {
  const auto loaded = config::load_declaration_text(kRanges, "test.yaml");
  if (!loaded) throw std::invalid_argument(config::to_text(std::span(loaded.error())));
  return Device(std::move(*declared::make(loaded->value, {.address = 1})));
}

std::string range_text(const Device& device, const Request& request) {
  const Bytes sent = device.request_bytes(request);
  return {sent.begin(), sent.end()};
}

Outcome driven(const Device& device, const Request& request, std::string_view response) {
  return drive(*device.begin(request), Bytes(response.begin(), response.end()));
}

TEST(DeclaredArea, ARequestNamesTheLastItem) {
  const Device device = ranges();
  EXPECT_EQ(range_text(device, device.read("D5", 3)), "R10051007");
  EXPECT_EQ(range_text(device, device.read("D99", 1)), "R10991099");
  EXPECT_EQ(range_text(device, device.write("D5", "12 34 56 78")), "W1005100612345678");
  const Request read = device.read("D5", 2);
  EXPECT_TRUE(driven(device, read, "r100612345678").done());
  EXPECT_FALSE(driven(device, read, "r100712345678").done());
}

TEST(DeclaredArea, AreasWithOnePrefixContinueEachOther) {
  const Device device = ranges();
  EXPECT_EQ(range_text(device, device.read("D100", 3)), "R50005004");
  EXPECT_EQ(range_text(device, device.read("D149", 1)), "R50985098");
  EXPECT_EQ(device.protocol().parse_address("D100.3")->area, 1u);
  for (const char* at : {"D150", "D100.16"})
    EXPECT_FALSE(device.protocol().parse_address(at)) << at;
  EXPECT_EQ(device.protocol().parse_address("D150").error().suggestion, "D99");
}

}  // namespace
}  // namespace fieldcast::test
