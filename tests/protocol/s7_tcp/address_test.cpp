#include <gtest/gtest.h>

#include "core/protocol/families/registry.hpp"
#include "core/protocol/s7_tcp/areas.hpp"

namespace fieldcast::test {
namespace {

// "DB 65556.3 1 bits": area, first item, bit, width; "WHAT; SUGGESTION" for a fault.
std::string parsed(std::string_view at) {
  static const auto protocol = std::move(*find_protocol("s7-tcp")->make({.address = 1}));
  const auto address = protocol->parse_address(at);
  if (!address) return address.error().what + "; " + address.error().suggestion;
  std::string text(protocol->areas()[address->area].name);
  text += ' ' + std::to_string(address->first);
  if (address->bit) text += '.' + std::to_string(*address->bit);
  if (address->width_bits) text += ' ' + std::to_string(*address->width_bits) + " bits";
  if (address->text_layout != TextLayout::kPlain)
    text += " text " + std::to_string(address->text_characters);
  return text;
}

TEST(S7TcpAddress, NamesAreaNumberAndWidth) {
  EXPECT_EQ(parsed("DB1.DBB0"), "DB 0 8 bits");
  EXPECT_EQ(parsed("DB2.DBW20"), "DB 65556 16 bits");
  EXPECT_EQ(parsed("DB2.DBD20"), "DB 65556 32 bits");
  EXPECT_EQ(parsed("DB2.DBL20"), "DB 65556 64 bits");
  EXPECT_EQ(parsed("DB2.DBX20.7"), "DB 65556.7 1 bits");
  EXPECT_EQ(parsed("DB65535.DBB65535"), "DB 4294901759 8 bits");
  EXPECT_EQ(parsed("DB1.DBS4"), "DB 4 text 0");
  EXPECT_EQ(parsed("DB1.DTL4"), "DB 4 text 29");
  EXPECT_EQ(parsed("DB1.DT4"), "DB 4 text 23");
  EXPECT_EQ(parsed("MB16383"), "M 16383 8 bits");
  EXPECT_EQ(parsed("M4.0"), "M 4.0 1 bits");
  EXPECT_EQ(parsed("IW2"), "I 2 16 bits");
  EXPECT_EQ(parsed("QL0"), "Q 0 64 bits");
  EXPECT_EQ(parsed("PIW752"), "PI 752 16 bits");
  EXPECT_EQ(parsed("T5"), "T 5");
  EXPECT_EQ(parsed("C2047"), "C 2047");
}

TEST(S7TcpAddress, AValueEndsWithinItsArea) {
  EXPECT_EQ(parsed("MW16381"), "M 16381 16 bits");
  EXPECT_EQ(parsed("MW16383"), "'MW16383' is beyond the end of M; ");
  EXPECT_EQ(parsed("MB16384"), "'MB16384' is beyond the end of M; ");
  EXPECT_EQ(parsed("DB1.DBW65534"), "DB 65534 16 bits");
  EXPECT_EQ(parsed("DB1.DBW65535"), "'DB1.DBW65535' is beyond the end of a data block; ");
  EXPECT_EQ(parsed("C2048"), "'C2048' is beyond the end of C; ");
}

TEST(S7TcpAddress, OtherNotationsAreSuggested) {
  EXPECT_EQ(parsed("%MW4"), "area '%MW' is unknown; MW4");
  EXPECT_EQ(parsed("mw4"), "area 'mw' is unknown; MW4");
  EXPECT_EQ(parsed("EW4"), "area 'EW' is unknown; IW4");
  EXPECT_EQ(parsed("AB4"), "area 'AB' is unknown; QB4");
  EXPECT_EQ(parsed("PEW4"), "area 'PEW' is unknown; PIW4");
  EXPECT_EQ(parsed("Z3"), "area 'Z' is unknown; C3");
  EXPECT_EQ(parsed("DB10,DBW4"), "area 'DB' is unknown; DB10.DBW4");
  EXPECT_EQ(parsed("DB10.W20"), "area 'W' is unknown; DB10.DBW20");
  EXPECT_EQ(parsed("DB10.dt4"), "area 'dt' is unknown; DB10.DT4");
}

TEST(S7TcpAddress, AFaultNamesThePart) {
  EXPECT_EQ(parsed("DB0.DBW0"), "data block '0' is not 1..65535; ");
  EXPECT_EQ(parsed("DB65536.DBW0"), "data block '65536' is not 1..65535; ");
  EXPECT_EQ(parsed("DBx.DBW0"), "data block 'x' is not 1..65535; ");
  EXPECT_EQ(parsed("DB1.DBQ4"), "area 'DBQ' is unknown; ");
  EXPECT_EQ(parsed("TW4"), "area 'TW' is unknown; ");
  EXPECT_EQ(parsed("MW"), "'MW' has no number; ");
  EXPECT_EQ(parsed("M4"), "'M4' says neither a bit nor a width; M4.0");
  EXPECT_EQ(parsed("MW4.1"), "'MW4.1' has no bits; MW4");
  EXPECT_EQ(parsed("T5.1"), "'T5.1' has no bits; T5");
  EXPECT_EQ(parsed("DB1.DBS4.1"), "'DB1.DBS4.1' has no bits; DB1.DBS4");
  EXPECT_EQ(parsed("M4.8"), "bit '8' is not 0..7; M4.0");
  EXPECT_EQ(parsed("M4."), "bit '' is not 0..7; M4.0");
}

}  // namespace
}  // namespace fieldcast::test
