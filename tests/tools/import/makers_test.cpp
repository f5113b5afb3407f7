#include "tests/tools/import/support.hpp"

namespace fieldcast::importing {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

TEST(ImportMakers, APowerOfTenInTheUnitIsTheScale) {
  const auto outcome = imported("meter.csv",
                                "Address,Name,Type,Unit\n0,A,U16,0.1kWh\n1,B,S16,0.01 ℃\n"
                                "2,C,U16,1/10 °C\n3,D,S16,0.001\n4,E,U16,10 W\n5,F,U16,V x10\n"
                                "6,G,U16,0.3 V\n7,H,U16,3/min\n8,I,U16,1/min\n9,J,U16,m3\n");
  EXPECT_THAT(channel_line(outcome, "A"), HasSubstr("scale: 0.1, unit: kWh"));
  EXPECT_EQ(fate_of(outcome, "A"), "unit '0.1kWh' is taken for the scale 0.1");
  expect_channels(outcome, {"B -> scale: 0.01, unit: \"℃\"", "C -> scale: 0.1, unit: \"°C\"",
                            "D -> scale: 0.001 }", "E -> scale: 10, unit: W"});
  for (const char* name : {"F", "G", "H"}) {
    EXPECT_THAT(fate_of(outcome, name), HasSubstr("holds a number, which is no part")) << name;
    EXPECT_THAT(channel_line(outcome, name), Not(HasSubstr("scale"))) << name;
  }
  for (const char* name : {"I", "J"}) EXPECT_EQ(fate_of(outcome, name), "ok") << name;
}

TEST(ImportMakers, AScaleInAColumnCountsMoreThanOneInTheUnit) {
  const auto outcome = imported("meter.csv", "Address,Name,Type,Scale,Unit\n0,A,U16,0.5,0.1 V\n");
  EXPECT_THAT(channel_line(outcome, "A"), HasSubstr("scale: 0.5"));
  EXPECT_THAT(fate_of(outcome, "A"), HasSubstr("holds a number, which is no part of the scale"));
}

TEST(ImportMakers, AValueWeightInTheRemarkDivides) {
  const auto outcome = imported(
      "meter.csv",
      "Address,Name,Type,Notes\n0,A,INT32,Value weight: Volt*10\n"
      "2,B,INT16,\"Negative: lead(C). VALUE WEIGHT: PF*1000\"\n3,C,INT16,Value weight: Volt\n"
      "4,D,INT16,Value weight: Volt*0\n");
  EXPECT_THAT(channel_line(outcome, "A"), HasSubstr("scale: 0.1"));
  EXPECT_EQ(fate_of(outcome, "A"), "the value weight 10 of the remark divides the raw value");
  EXPECT_THAT(channel_line(outcome, "B"), HasSubstr("scale: 0.001"));
  for (const char* name : {"C", "D"})
    EXPECT_THAT(channel_line(outcome, name), Not(HasSubstr("scale"))) << name;
}

TEST(ImportMakers, AnOffsetIsTheAddressWhereNoColumnHasIt) {
  const auto offset =
      imported("m.csv", "Offset,Name,Format,Access\n55,A,Float,R\n801,B,Unsigned short,R/WC\n");
  EXPECT_EQ(offset.rows[0].at, "holding:55");
  EXPECT_EQ(offset.rows[1].type, "uint16");
  EXPECT_EQ(fate_of(offset, "B"), "ok");
  EXPECT_EQ(offset.rows[1].access, Access::kReadOnly);
  const auto both = imported("m.csv", "Offset,Name,Type,Address\n5,A,U16,7\n");
  EXPECT_THAT(channel_line(both, "A"), HasSubstr("at: \"holding:7\", type: uint16, offset: 5"));
}

TEST(ImportMakers, AReferenceOfSixDigitsIsComparedWithTheSecondColumn) {
  const auto outcome =
      imported("m.csv", "Modicom address,Physical address,Name,Type\n300013,000Ch,A,INT32\n");
  EXPECT_EQ(outcome.rows[0].at, "input-register:12");
  EXPECT_THAT(outcome.notes,
              Contains(HasSubstr("count from 1, as the column 'Physical address' beside them")));
}

}  // namespace
}  // namespace fieldcast::importing
