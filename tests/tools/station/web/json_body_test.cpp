#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {
namespace {

TEST(JsonBody, AnObjectIsTaken) {
  const auto body = parse_object(R"({"user": "anna", "list": [{"a": 1}, {"a": 2}]})");
  ASSERT_TRUE(body);
  EXPECT_EQ((*body)["list"][1]["a"], 2);
  EXPECT_TRUE(parse_object(R"({"a":{"a":{"a":{"a":{"a":{"a":{"a":1}}}}}}})"));
}

TEST(JsonBody, AnythingElseIsRefused) {
  const std::string deep = std::string(40'000, '[');
  const std::string deeper = R"({"a":)" + std::string(9, '[') + std::string(9, ']') + "}";
  for (const std::string& text :
       {std::string(), std::string("null"), std::string("[]"), std::string("1"),
        std::string("\"x\""), std::string("{"), std::string("{}x"), std::string("{'a': 1}"),
        std::string(R"({"a": 1, "a": 2})"), std::string(R"({"b": {"a": 1, "a": 2}})"),
        std::string("{\"a\": \"\xff\"}"), std::string("{\"a\": NaN}"), deep, deeper})
    EXPECT_FALSE(parse_object(text)) << text.substr(0, 40);
  HttpRequest request;
  request.body = "[]";
  EXPECT_EQ(body_of(request).error().status, 400u);
}

}  // namespace
}  // namespace fieldcast::web
