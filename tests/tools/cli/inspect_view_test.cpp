#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/cli/parsed_json.hpp"
#include "tools/cli/view/check_view.hpp"

namespace fieldcast::cli {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const Bytes kFrame{0x01, 0x03, 0x00, 0x64, 0x00, 0x02, 0x85, 0xD5};
const std::vector<FrameField> kFields{{0, 0, 1, "unit", "1", ""},
                                      {0, 1, 5, "request", "03 read holding registers", ""},
                                      {1, 2, 2, "first", "100", ""},
                                      {0, 6, 2, "CRC", "D585", "D485 is right"}};

TEST(InspectView, IndentsFieldsAndMarksFaults) {
  const auto lines = inspect_lines("modbus-rtu", kFrame, kFields, {});
  ASSERT_EQ(lines.size(), 6u);
  EXPECT_THAT(lines[3], HasSubstr("00 64           "));
  EXPECT_THAT(lines[3], HasSubstr("   first"));
  EXPECT_THAT(lines[4], StartsWith("!!"));
  EXPECT_THAT(lines[4], HasSubstr("<- D485 is right"));
  EXPECT_EQ(lines[5], "modbus-rtu, 8 bytes: 1 fault");
}

TEST(InspectView, FieldBeyondTheFrameShowsNoBytes) {
  const std::vector<FrameField> fields{{0, 7, 9, "data", "", "cut off"},
                                       {0, 100, 1, "CRC", "", "missing"}};
  const auto lines = inspect_lines("modbus-rtu", kFrame, fields, {});
  EXPECT_THAT(lines[1], HasSubstr("D5"));
  EXPECT_THAT(lines[2], HasSubstr("missing"));
}

TEST(InspectView, JsonCountsFaults) {
  const auto json = parsed(inspect_json("modbus-rtu", kFrame, kFields));
  EXPECT_EQ(json["frame"], "01030064000285D5");
  EXPECT_EQ(json["faults"], 1);
  EXPECT_EQ(json["fields"][2]["depth"], 1);
  EXPECT_EQ(json["fields"][3]["fault"], "D485 is right");
}

}  // namespace
}  // namespace fieldcast::cli
