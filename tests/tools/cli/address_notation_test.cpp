#include "tools/cli/model/address_notation.hpp"

#include <gtest/gtest.h>

namespace fieldcast::cli {
namespace {

TEST(AddressNotation, BitsAreBoolWithoutAWord) {
  for (const auto* at : {"coil:16", "input:3", "00017", "holding:100.5", "I0.3", "CIO12.03", "X17"})
    EXPECT_EQ(implied_type(at), "bool") << at;
}

TEST(AddressNotation, WidthsOfTheNotationAreTypes) {
  EXPECT_EQ(implied_type("VW100"), "uint16");
  EXPECT_EQ(implied_type("VD204"), "uint32");
}

TEST(AddressNotation, WhatItLeavesOpenIsNotGuessed) {
  for (const auto* at : {"holding:100", "40101", "DM100", "", "nowhere"})
    EXPECT_EQ(implied_type(at), "") << at;
}

TEST(AddressNotation, CodesHaveTheWordsOfTheFamilyThatWritesSo) {
  EXPECT_EQ(device_code_at("holding:100", 2), "02 illegal data address");
  EXPECT_EQ(device_code_at("VW100", 5), "05 address out of range");
  EXPECT_EQ(device_code_at("DM100", 0x14), "14 format error");
  EXPECT_EQ(device_code_at("DM100", 0x1103), "1103 start address out of range");
  EXPECT_EQ(device_code_at("nowhere", 2), "code 02");
}

}  // namespace
}  // namespace fieldcast::cli
