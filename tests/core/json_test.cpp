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

TEST(Json, RealNumbersAreToldFromIntegers) {
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
}

}  // namespace
}  // namespace fieldcast
