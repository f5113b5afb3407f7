#include "core/base/json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <vector>

namespace fieldcast {
namespace {

TEST(Json, ObjectKeepsTheOrderOfItsFields) {
  Json json{{"z", 1u}, {"a", true}, {"n", nullptr}, {"t", "x"}};
  json.add("inner", {{"b", "two"}, {"c", std::string("three")}});
  EXPECT_EQ(json.text(), R"({"z":1,"a":true,"n":null,"t":"x","inner":{"b":"two","c":"three"}})");
  EXPECT_EQ(Json::object().text(), "{}");
}

TEST(Json, ListsAreArraysAndMapsAreObjects) {
  EXPECT_EQ(Json(std::vector<std::string>{"a", "b"}).text(), R"(["a","b"])");
  EXPECT_EQ(Json(std::vector<Value>{std::int64_t{5}, true}).text(), "[5,true]");
  EXPECT_EQ(Json(std::map<std::string, std::uint64_t>{{"a", 1}, {"b", 2}}).text(),
            R"({"a":1,"b":2})");
  Json list = Json::array();
  list.push_back({{"a", 1}});
  list.push_back(2);
  EXPECT_EQ(list.text(), R"([{"a":1},2])");
}

TEST(Json, RealNumbersAreDistinguishedFromIntegers) {
  EXPECT_EQ(Json(2.0).text(), "2.0");
  EXPECT_EQ(Json(0.1).text(), "0.1");
  EXPECT_EQ(Json(1e-5).text(), "1e-05");
  EXPECT_EQ(Json(1e20).text(), "1e+20");
  EXPECT_EQ(Json(std::nan("")).text(), "null");
  EXPECT_EQ(Json(std::uint64_t{18446744073709551615u}).text(), "18446744073709551615");
  EXPECT_EQ(Json(std::optional<double>()).text(), "null");
}

TEST(Json, NamesAndTextsFromTheNetworkAreEscaped) {
  const std::string hostile = "\"},\"state\":\"stopped\n\u202E\xff";
  EXPECT_EQ((Json{{hostile, hostile}}).text(),
            "{\"\\\"},\\\"state\\\":\\\"stopped\\n\\u202e\uFFFD\":"
            "\"\\\"},\\\"state\\\":\\\"stopped\\n\\u202e\uFFFD\"}");
  EXPECT_EQ(Json(Value(std::string("K\xFChl"))).text(), R"("K\\xFChl")");
}

TEST(Json, AsciiFormEscapesEveryOtherCharacter) {
  EXPECT_EQ(ascii_json({{"°C", "😀"}}), R"({"\u00b0C":"\ud83d\ude00"})");
  EXPECT_EQ(ascii_json({{"\uFFFD", "\U00010000\U0010FFFF"}}),
            R"({"\ufffd":"\ud800\udc00\udbff\udfff"})");
}

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
  EXPECT_EQ(value_of(std::int64_t{9007199254740992}), "9007199254740992");
  EXPECT_EQ(value_of(std::int64_t{9007199254740993}), R"("9007199254740993")");
  EXPECT_EQ(value_of(std::uint64_t{9007199254740992u}), "9007199254740992");
  EXPECT_EQ(value_of(std::uint64_t{9007199254740993u}), R"("9007199254740993")");
  EXPECT_EQ(value_of(std::int64_t{-9007199254740992}), "-9007199254740992");
  EXPECT_EQ(value_of(std::int64_t{-9007199254740993}), R"("-9007199254740993")");
  EXPECT_EQ(value_of(std::uint64_t{18446744073709551615u}), R"("18446744073709551615")");
  EXPECT_EQ(value_of(std::string("a\xE4")), R"("a\\xE4")");
}

TEST(JsonText, TimesAreMilliseconds) {
  EXPECT_EQ(milliseconds(std::chrono::microseconds{1500}), 1.5);
  EXPECT_EQ(unix_ms({2'500'000}), 2.5);
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

TEST(JsonText, AnArraySetsItsCommas) {
  const auto array = [](const std::vector<std::string>& texts) {
    return json_array(texts, append_json_text);
  };
  EXPECT_EQ(array({}), "[]");
  EXPECT_EQ(array({"a"}), R"(["a"])");
  EXPECT_EQ(array({"a", "b", "c"}), R"(["a","b","c"])");
}

TEST(JsonText, AJoinedObjectHasTheMembersOfBoth) {
  const std::string one = JsonObject().add("a", 1u).take(), none = JsonObject().take();
  EXPECT_EQ(json_joined(one, JsonObject().add("b", 2u).take()), R"({"a":1,"b":2})");
  EXPECT_EQ(json_joined(one, none), one);
}

TEST(Json, AnOptionalHasItsValueOrNull) {
  EXPECT_EQ(Json(std::optional<double>(2.5)).text(), "2.5");
  EXPECT_EQ(Json(std::optional<std::string>("a")).text(), R"("a")");
  EXPECT_EQ(Json(std::optional<std::string>()).text(), "null");
}

TEST(JsonText, AnObjectHoldsValuesOfEachKind) {
  EXPECT_EQ(JsonObject()
                .add("off", false)
                .add_value("bool", false)
                .add_value("text", std::string("a\r\n"))
                .add_value("bytes", std::string("a\xE4"))
                .add_value("number", 0.5)
                .take(),
            R"({"off":false,"bool":false,"text":"a\r\n","bytes":"a\\xE4","number":0.5})");
}

}  // namespace
}  // namespace fieldcast
