#include "tools/cli/suggestion.hpp"

#include <gtest/gtest.h>

namespace fieldcast::cli {
namespace {

TEST(EditDistance, CountsSlipsOfTheHand) {
  EXPECT_EQ(edit_distance("modbus", "modbus"), 0u);
  EXPECT_EQ(edit_distance("Modbus", "modbus"), 0u);
  EXPECT_EQ(edit_distance("modubs", "modbus"), 1u);  // swapped
  EXPECT_EQ(edit_distance("mdbus", "modbus"), 1u);
  EXPECT_EQ(edit_distance("modbuss", "modbus"), 1u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("abc", ""), 3u);
}

TEST(Nearest, GivesNothingWhenNothingIsNear) {
  EXPECT_EQ(nearest("modbus-rut", {"modbus-tcp", "modbus-rtu"}), "modbus-rtu");
  EXPECT_EQ(nearest("hostlink", {"modbus-tcp", "modbus-rtu"}), "");
  EXPECT_EQ(nearest("x", {}), "");
}

}  // namespace
}  // namespace fieldcast::cli
