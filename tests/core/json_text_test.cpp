#include <gtest/gtest.h>

#include <cmath>

#include "core/base/json.hpp"

namespace fieldcast {
namespace {

std::string text_of(std::string_view text) {
  std::string out;
  append_json_text(out, text);
  return out;
}
std::string value_of(const Value& value) {
  std::string out;
  append_json_value(out, value);
  return out;
}

TEST(JsonText, TextsAreEscaped) {
  EXPECT_EQ(text_of("press-1"), R"("press-1")");
  EXPECT_EQ(text_of("a\"b\\c\n\t\x01\x7F"), R"("a\"b\\c\n\t\u0001\u007f")");
  EXPECT_EQ(text_of("21 °C 压力"), "\"21 °C 压力\"");
  EXPECT_EQ(text_of("\xE4 \xC3"), "\"\xEF\xBF\xBD \xEF\xBF\xBD\"");
  EXPECT_EQ(text_of(""), "\"\"");
}

TEST(JsonText, ValuesAreExact) {
  EXPECT_EQ(value_of(true), "true");
  EXPECT_EQ(value_of(0.1), "0.1");
  EXPECT_EQ(value_of(std::nan("")), "null");
  EXPECT_EQ(value_of(std::int64_t{-9007199254740992}), "-9007199254740992");
  EXPECT_EQ(value_of(std::int64_t{-9007199254740993}), R"("-9007199254740993")");
  EXPECT_EQ(value_of(std::uint64_t{18446744073709551615u}), R"("18446744073709551615")");
  EXPECT_EQ(value_of(std::string("a\xE4")), R"("a\\xE4")");
}

TEST(JsonText, AnObjectSetsItsCommas) {
  EXPECT_EQ(JsonObject().take(), "{}");
  EXPECT_EQ(JsonObject()
                .add("a", "x")
                .add("b", 1.5)
                .add("c", 7u)
                .add("d", true)
                .add("e", UtcTime{1'500'000})
                .add("f", UtcTime{})
                .add_json("g", "[]")
                .take(),
            R"({"a":"x","b":1.5,"c":7,"d":true,"e":1.5,"f":null,"g":[]})");
}

}  // namespace
}  // namespace fieldcast
