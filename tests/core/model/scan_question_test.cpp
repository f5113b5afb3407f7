#include "core/model/scan_question.hpp"

#include <gtest/gtest.h>

#include "core/protocol/families/registry.hpp"

namespace fieldcast {
namespace {

// "holding:0 1, input:0 1": address and items of each question.
std::string questions_of(std::string_view protocol) {
  const auto made = find_protocol(protocol)->make({.address = 1});
  std::string text;
  for (const ScanQuestion& each : scan_questions(**made, {}))
    text += (text.empty() ? "" : ", ") + each.at + ' ' + std::to_string(each.range.count);
  return text;
}

TEST(ScanQuestion, AtMostTwoAreasOfRegistersAreRead) {
  EXPECT_EQ(questions_of("modbus-rtu"), "holding:0 1, input-register:0 1");
  EXPECT_EQ(questions_of("mitsubishi-fx"), "D0 1, T0 1");
  EXPECT_EQ(questions_of("omron-hostlink"), "CIO0 1, LR0 1");
  EXPECT_EQ(questions_of("s7-ppi"), "VB0 1, MB0 1");
  EXPECT_EQ(questions_of("s7-freeport"), "window:0 1");
  EXPECT_EQ(questions_of("allen-bradley-df1"), "S:0 1, O:0 1");
  EXPECT_EQ(questions_of("dtc"), "int16:0 1, int32:0 1");
}

TEST(ScanQuestion, AnItemMayIdentifyTheDevice) {
  const auto identity = [](std::string_view protocol) {
    return identity_question(**find_protocol(protocol)->make({.address = 1}));
  };
  const auto modbus = identity("modbus-tcp");
  ASSERT_TRUE(modbus);
  EXPECT_EQ(modbus->question.at, "id:basic");
  EXPECT_EQ(identity_text(*modbus, "Schneider Electric, PM5110"), "Schneider Electric, PM5110");
  const auto fx = identity("mitsubishi-fx");
  ASSERT_TRUE(fx);
  EXPECT_EQ(fx->question.at, "D8001");
  EXPECT_EQ(fx->question.range.count, 1u);
  EXPECT_EQ(identity_text(*fx, "24123"), "type and version 24123 (D8001 is 24123)");
  EXPECT_FALSE(identity("dtc"));
}

}  // namespace
}  // namespace fieldcast
