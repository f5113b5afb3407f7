#include <gtest/gtest.h>

#include "core/program/frame.hpp"

namespace fieldcast::program {
namespace {

TEST(DeviceNumber, IsOneToSixteenLettersOrDigits) {
  for (const char* good :
       {"1", "17", "Press01", "ABCDEFGHIJKLMNOP", "0010", "00012", "000A", "EDX", "FEF", "V1"}) {
    EXPECT_TRUE(is_device_number(good)) << good;
  }
  for (const char* bad :
       {"", "ABCDEFGHIJKLMNOPQ", "press-1", "press 1", "\xC3\xA4", "a:b", "1\r"}) {
    EXPECT_FALSE(is_device_number(bad)) << bad;
  }
}

TEST(DeviceNumber, IsNothingThatAFrameCouldTakeForSomethingElse) {
  for (const char* bad :
       {"ED", "HB", "0000", "0003", "0009", "FEFF", "1FEFF", "AFEFFB", "V2", "V217"}) {
    EXPECT_FALSE(is_device_number(bad)) << bad;
  }
}

}  // namespace
}  // namespace fieldcast::program
