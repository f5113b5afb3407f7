// Lists of makers and of people: what is not understood is never guessed without a word.
#include "tests/tools/import/support.hpp"
#include "tools/import/formats/list_address.hpp"

namespace fieldcast::importing {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

// The place of a value, "no: .." if it was refused.
std::string place_of(const Outcome& outcome, const std::string& name) {
  const auto row = std::ranges::find(outcome.rows, name, &PointFate::name);
  if (row == outcome.rows.end()) return "not in the list";
  return row->fate == Fate::kRefused ? "no: " + row->words : row->at;
}

TEST(ImportListAddress, IsUnderstoodWholeOrNotAtAll) {
  const auto read = [](std::string_view cell) -> std::string {
    const auto address = list_address_from(cell, false);
    if (!address) return "no: " + address.error();
    std::string text = address->plain ? std::to_string(*address->plain) : "reference";
    if (address->bit) text += "." + std::to_string(*address->bit);
    if (address->registers > 0) text += " x" + std::to_string(address->registers);
    return text;
  };
  EXPECT_EQ(read("100"), "100");
  EXPECT_EQ(read("0x64"), "100");
  EXPECT_EQ(read("70 (46h)"), "70");
  EXPECT_EQ(read("40001 (0x0000)"), "reference");
  EXPECT_EQ(read("5004 - 5005"), "5004 x2");
  EXPECT_EQ(read("5033 – 5034"), "5033 x2");
  EXPECT_EQ(read("0x0010..0x0013"), "16 x4");
  EXPECT_EQ(read("40010 to 40011"), "40010 x2");
  EXPECT_EQ(read("3-4"), "3 x2");
  EXPECT_EQ(read("3-0007"), "reference");
  EXPECT_EQ(read("90,91,92,93"), "90 x4");
  EXPECT_EQ(read("80, 81"), "80 x2");
  EXPECT_EQ(read("30001/2"), "30001 x2");
  EXPECT_EQ(read("40007 Bit 3"), "40007.3");
  EXPECT_EQ(read("1234.0"), "1234.0");
  EXPECT_EQ(read("40001,00"), "40001");
  for (const char* odd : {"1,234", "1 234", "40,101", "1.000", "40.001", "1'234", "100,101"})
    EXPECT_THAT(read(odd), HasSubstr("is it one number with separators, or two?")) << odd;
  for (const char* odd :
       {"40003:6", "40003#9", "40003[7]", "40003_10", "*40010", "4 0010", "n/a", "-", "100 (0x65)",
        "100 (R)", "40003,5", "100-90", "100-400", "40001.16", "1.2E3", "40010.3-40011"})
    EXPECT_THAT(read(odd), HasSubstr("no: ")) << odd;
}

TEST(ImportList, ARowThatIsNotUnderstoodDecidesNothingForTheOthers) {
  for (const char* odd : {"-", "n/a", "40003:6", "*40010", "4 0010", "see below", "\"1,234\""}) {
    const auto outcome =
        import_text("meter.csv", "Register,Name,Type,Unit\n40001,A,INT16,V\n40002,B,INT16,V\n" +
                                     std::string(odd) + ",E,UINT64,Wh\n");
    ASSERT_TRUE(outcome) << outcome.error();
    EXPECT_EQ(place_of(*outcome, "A"), "holding:0") << odd;
    EXPECT_EQ(place_of(*outcome, "B"), "holding:1") << odd;
    EXPECT_THAT(place_of(*outcome, "E"), HasSubstr("no: ")) << odd;
  }
  const auto range = import_text("meter.csv",
                                 "Register,Name,Type,Unit\n40001,A,INT16,V\n"
                                 "40010..40013,E,UINT64,Wh\n");
  EXPECT_EQ(place_of(*range, "A"), "holding:0");
  EXPECT_EQ(place_of(*range, "E"), "holding:9");
}

TEST(ImportList, RowsThatCannotBeReferencesAreNamed) {
  for (const char* odd : {"50000", "40000", "12"}) {
    const auto outcome =
        import_text("meter.csv", "Register,Name,Type,Unit\n40001,A,INT16,V\n40002,B,INT16,V\n" +
                                     std::string(odd) + ",E,UINT16,Wh\n");
    ASSERT_TRUE(outcome) << outcome.error();
    EXPECT_EQ(place_of(*outcome, "A"), "holding:40001");
    EXPECT_THAT(outcome->notes,
                Contains(AllOf(HasSubstr("numbers such as '40001' (line 2) are taken as they are"),
                               HasSubstr("line 4 ('" + std::string(odd) + "')"))));
  }
  const auto agree = import_text("meter.csv", "Register,Name,Type\n40001,A,INT16\n");
  EXPECT_THAT(agree->notes, Not(Contains(HasSubstr("are taken as they are"))));
}

TEST(ImportList, ASingleFunctionThatContradictsIsRefusedByItself) {
  const auto outcome = import_text("meter.csv",
                                   "Register,Function,Name,Type\n30001,4,Volts,FLOAT\n"
                                   "30003,4,Amps,FLOAT\n40001,4,Typo,FLOAT\n40003,3,Set,FLOAT\n"
                                   "4x0009,4,Odd,FLOAT\n");
  ASSERT_TRUE(outcome) << outcome.error();
  EXPECT_EQ(place_of(*outcome, "Volts"), "input-register:0");
  EXPECT_EQ(place_of(*outcome, "Set"), "holding:2");
  for (const char* name : {"Typo", "Odd"})
    EXPECT_THAT(place_of(*outcome, name), HasSubstr("name different tables"));
}

TEST(ImportList, NumbersWithZerosInFrontAreNoCoils) {
  const auto outcome =
      import_text("meter.csv", "Address,Name,Type\n00100,A,UINT16\n00102,B,INT32\n");
  ASSERT_TRUE(outcome) << outcome.error();
  EXPECT_EQ(place_of(*outcome, "A"), "holding:100");
  EXPECT_EQ(place_of(*outcome, "B"), "holding:102");
}

}  // namespace
}  // namespace fieldcast::importing
