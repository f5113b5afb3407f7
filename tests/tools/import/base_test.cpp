#include "tests/tools/import/support.hpp"

namespace fieldcast::importing {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

std::string at_of(const Outcome& outcome, const std::string& name) {
  const auto row = std::ranges::find(outcome.rows, name, &PointFate::name);
  return row == outcome.rows.end() ? "not in the list" : row->at;
}

TEST(ImportBase, AGuessIsPrintedWithItsReasonAndACheck) {
  const auto plain = imported("m.csv", "Address,Name,Type\n100,A,U16\n102,B,U16\n");
  EXPECT_EQ(at_of(plain, "A"), "holding:100");
  EXPECT_THAT(
      plain.notes,
      Contains(AllOf(HasSubstr("taken to count from 0: "), HasSubstr("try --base 1"),
                     HasSubstr("fieldcast read /dev/ttyUSB0 --protocol modbus-rtu --baud "
                               "9600 --format 8N1 --address 1 holding:100 --type uint16"))));
  const auto digit = import_text("m.csv", "Register,Name,Type\n40101,A,U16\n");
  EXPECT_THAT(digit->notes, Contains(HasSubstr("'40101' (line 2) begins with the digit")));
}

TEST(ImportBase, TheUserSaysIt) {
  const std::string list = "Address,Name,Type\n100,A,U16\n4x0101,B,U16\n";
  const auto one = import_text("m.csv", list, {.base = 1});
  EXPECT_EQ(at_of(*one, "A"), "holding:99");
  EXPECT_EQ(at_of(*one, "B"), "holding:100");
  const auto zero = import_text("m.csv", list, {.base = 0});
  EXPECT_EQ(at_of(*zero, "A"), "holding:100");
  EXPECT_EQ(at_of(*zero, "B"), "holding:101");
  for (const auto& outcome : {one, zero})
    EXPECT_THAT(outcome->notes, Not(Contains(HasSubstr("taken to count from"))));
}

TEST(ImportBase, ASecondColumnOfAddressesShowsIt) {
  const auto outcome =
      imported("m.csv", "Register,Address (hex),Name,Type\n3000,0BB7,A,U16\n3028,0BD3,B,U16\n");
  EXPECT_EQ(at_of(outcome, "A"), "holding:2999");
  EXPECT_THAT(outcome.notes, Contains(HasSubstr("the column 'Address (hex)' beside them shows")));
}

TEST(ImportListAddress, AnOpenOrMalformedRangeIsRefusedWithItsPlace) {
  for (const char* odd : {"40003..", "40003-", "40003 ..", "40003...", "40003,", "..40003"}) {
    const auto outcome =
        imported("m.csv", std::string("Name,Register,Type\nA,\"") + odd + "\",U16\nB,40001,U16\n");
    EXPECT_THAT(fate_of(outcome, "A"), HasSubstr("no: ")) << odd;
    EXPECT_EQ(outcome.rows[0].origin.line, 2u) << odd;
    EXPECT_EQ(outcome.rows[0].origin.column, 2u) << odd;
    EXPECT_EQ(at_of(outcome, "B"), "holding:0") << odd;
  }
  const auto open = import_text("m.csv", "Name,Register,Type\nA,40003..,U16\nB,40001,U16\n");
  EXPECT_THAT(fate_of(*open, "A"), HasSubstr("the range '40003..' is open"));
}

TEST(ImportKepware, AnAddressOfTheLetterOfHexadecimalAloneIsRefused) {
  const auto outcome = imported(
      "tags.csv",
      "Tag Name,Address,Data Type,Client Access\nA,H,Word,RO\nB,h4,Word,RO\nC,H40001,Word,RO\n",
      {.from = "kepware"});
  EXPECT_EQ(fate_of(outcome, "A"), "no: 'H' is no address");
  EXPECT_EQ(fate_of(outcome, "B"), "no: 'H4' is no address");
  EXPECT_EQ(at_of(outcome, "C"), "holding:0");
}

TEST(ImportBits, ThatTheListInvertsAreRefused) {
  const auto list = imported("m.csv",
                             "Address,Name,Type,Function,Scale,Offset\n1,A,BOOL,1,-1,1\n"
                             "2,B,BOOL,1,1,0\n");
  EXPECT_THAT(fate_of(list, "A"), HasSubstr("no: the list inverts this bit (scale -1, offset 1)"));
  EXPECT_EQ(fate_of(list, "B"), "ok");
  const auto wb = imported("config-a.json",
                           R"({"device_type":"a","device":{"name":"A","id":"a","channels":[
      {"name":"x","reg_type":"coil","address":1,"scale":-1,"offset":1},
      {"name":"y","reg_type":"coil","address":2}]}})");
  EXPECT_THAT(fate_of(wb, "x"), HasSubstr("no: the list inverts this bit"));
  EXPECT_EQ(fate_of(wb, "y"), "ok");
}

TEST(ImportList, AColumnResIsTheResolution) {
  const auto outcome = imported("m.csv", "Address,Name,Type,Res.\n0,A,U16,0.1\n");
  EXPECT_THAT(channel_line(outcome, "A"), HasSubstr("scale: 0.1"));
}

}  // namespace
}  // namespace fieldcast::importing
