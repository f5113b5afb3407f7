#include <gtest/gtest.h>

#include "core/base/message_text.hpp"

namespace fieldcast {
namespace {

TEST(NearMiss, OneSlipOfTheFingerIsUnderstood) {
  constexpr std::string_view words[]{"coil", "holding", "input-register"};
  EXPECT_EQ(near_miss("holdin", words), "holding");
  EXPECT_EQ(near_miss("hodling", words), "holding");
  EXPECT_EQ(near_miss("Coil", words), "coil");
  EXPECT_EQ(near_miss("imput-regster", words), "input-register");
  EXPECT_EQ(near_miss("modbus-rut", std::vector<std::string>{"modbus-tcp", "modbus-rtu"}),
            "modbus-rtu");
}

TEST(NearMiss, AnotherWordIsNoNearMiss) {
  constexpr std::string_view words[]{"coil", "holding"};
  EXPECT_EQ(near_miss("banana", words), "");
  EXPECT_EQ(near_miss("", words), "");
  EXPECT_EQ(near_miss(std::string(1000, 'c'), words), "");
}

}  // namespace
}  // namespace fieldcast
