#include "bridge/http/http_message.hpp"

#include <gtest/gtest.h>

namespace fieldcast::web {
namespace {

TEST(HttpMessage, ATargetIsDecodedIntoPathAndQuery) {
  const auto target =
      parse_target("/api/history?channel=a%2Fb%2fc&channel=d+e&points=10&flag&=x&&");
  ASSERT_TRUE(target);
  EXPECT_EQ(target->path, "/api/history");
  EXPECT_EQ(
      target->query,
      (TextPairs{
          {"channel", "a/b/c"}, {"channel", "d e"}, {"points", "10"}, {"flag", ""}, {"", "x"}}));
  EXPECT_EQ(parse_target("/a%20b+c")->path, "/a b+c");
  EXPECT_EQ(parse_target("/?a=b=c")->query, (TextPairs{{"a", "b=c"}}));
}

TEST(HttpMessage, ABadTargetIsNone) {
  for (const char* text : {"", "x", "*", "http://a/", "/%", "/%2", "/%zz", "/%00", "/?a=%", "/?%0"})
    EXPECT_FALSE(parse_target(text)) << text;
  std::string many = "/?";
  for (int i = 0; i < 65; ++i) many += "a&";
  EXPECT_FALSE(parse_target(many));
}

TEST(HttpMessage, ParametersAreFoundByName) {
  HttpRequest request;
  request.query = {{"channel", "1"}, {"from", "5"}, {"channel", "2"}};
  EXPECT_EQ(request.parameter("channel"), "1");
  EXPECT_EQ(request.parameter("to"), std::nullopt);
  EXPECT_EQ(request.parameters("channel"), (std::vector<std::string>{"1", "2"}));
}

TEST(HttpMessage, MethodsHaveTheirWords) {
  EXPECT_EQ(method_from("POST"), Method::kPost);
  EXPECT_EQ(method_from("get"), std::nullopt);
  EXPECT_EQ(to_text(Method::kDelete), "DELETE");
}

TEST(HttpMessage, AnErrorSaysWhatAndWhatToDo) {
  const HttpResponse response = error_response(404, "no such \"bus\"", "see /api/buses \xff");
  EXPECT_EQ(response.status, 404u);
  EXPECT_EQ(response.body,
            "{\"error\":\"no such \\\"bus\\\"\",\"hint\":\"see /api/buses \xEF\xBF\xBD\"}");
}

}  // namespace
}  // namespace fieldcast::web
