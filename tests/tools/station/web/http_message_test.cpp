#include "tools/station/http/http_message.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tools/station/http/route_table.hpp"

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

TEST(Gzip, WhatIsPackedIsUnpacked) {
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += std::to_string(i * 7919 % 1013);
  EXPECT_LT(packed(text).size(), text.size() / 2);
  EXPECT_EQ(unpacked(packed(text)), text);
  EXPECT_EQ(unpacked(packed("")), "");
}

TEST(Gzip, PiecesJoinToOneStream) {
  GzipPieces pieces;
  std::string all, text;
  for (int i = 0; i < 1000; ++i) {
    const std::string piece = std::to_string(i) + ",";
    text += piece;
    all += pieces.put(piece);
  }
  all += pieces.finish();
  EXPECT_EQ(unpacked(all), text);
}

TEST(Gzip, WhatIsCutIsNotAnEndlessLoop) {
  const std::string all = packed("some text that is long enough");
  for (std::size_t size = 0; size < all.size(); ++size)
    EXPECT_NE(unpacked(std::string_view(all).substr(0, size)), all);
}

const UtcTime kDate{784'111'777'000'000'000};

TEST(ResponseHead, NamesStatusDateAndLength) {
  HttpResponse response;
  response.headers = {{"etag", "\"1\""}};
  EXPECT_EQ(response_head(response, {kDate, true, 12, false}),
            "HTTP/1.1 200 OK\r\ndate: Sun, 06 Nov 1994 08:49:37 GMT\r\nconnection: keep-alive\r\n"
            "content-type: application/json\r\ncontent-length: 12\r\netag: \"1\"\r\n\r\n");
}

TEST(ResponseHead, AStreamComesInChunks) {
  EXPECT_EQ(response_head({}, {kDate, false, std::nullopt, true}),
            "HTTP/1.1 200 OK\r\ndate: Sun, 06 Nov 1994 08:49:37 GMT\r\nconnection: close\r\n"
            "content-type: application/json\r\ntransfer-encoding: chunked\r\n\r\n");
}

TEST(ResponseHead, WhatHasNoBodyHasNoLength) {
  HttpResponse response;
  response.status = 304;
  EXPECT_EQ(response_head(response, {kDate, true, 0, false}),
            "HTTP/1.1 304 Not Modified\r\ndate: Sun, 06 Nov 1994 08:49:37 GMT\r\n"
            "connection: keep-alive\r\n\r\n");
}

TEST(ResponseHead, NoHeaderBeginsAnother) {
  HttpResponse response;
  response.content_type = "text/plain\r\nx: y";
  response.headers = {{"a", "1\nset-cookie: x"}, {"b\r\nc", "2"}, {"d", std::string("3\0", 2)}};
  EXPECT_EQ(response_head(response, {kDate, true, 0, false}),
            "HTTP/1.1 200 OK\r\ndate: Sun, 06 Nov 1994 08:49:37 GMT\r\nconnection: keep-alive\r\n"
            "content-length: 0\r\n\r\n");
}

Handler saying(std::string word) {
  return [word = std::move(word)](const HttpRequest&, const Caller&, const Reply& reply) {
    HttpResponse response;
    response.body = word;
    reply(std::move(response));
  };
}

class Routes : public testing::Test {
 protected:
  Routes() {
    table_.add({Method::kGet, "/", Access::kPublic, saying("page")});
    table_.add({Method::kGet, "/api/alarms", Access::kViewer, saying("alarms")});
    table_.add({Method::kPost, "/api/commands", Access::kOperator, saying("command")});
    table_.add({Method::kDelete, "/api/commands", Access::kOperator, saying("cancel")});
  }
  std::string ask(Method method, const std::string& path, std::optional<Role> role) {
    const auto found = table_.find(method, path, role);
    if (!found) return std::to_string(found.error().status);
    std::string body;
    (*found)->handler({}, {}, [&](HttpResponse response) { body = response.body; });
    return body;
  }
  RouteTable table_;
};

TEST_F(Routes, EachIsFoundByMethodAndPath) {
  EXPECT_EQ(ask(Method::kGet, "/", {}), "page");
  EXPECT_EQ(ask(Method::kGet, "/api/alarms", Role::kViewer), "alarms");
  EXPECT_EQ(ask(Method::kPost, "/api/commands", Role::kOperator), "command");
  EXPECT_EQ(ask(Method::kDelete, "/api/commands", Role::kProgrammer), "cancel");
}

TEST_F(Routes, WhatIsNotInTheTableIsRefused) {
  for (const char* path : {"/x", "/api", "/api/alarms/", "/api/alarms/../commands", "//", ""})
    EXPECT_EQ(ask(Method::kGet, path, Role::kProgrammer), "404") << path;
}

TEST_F(Routes, TheRoleIsChecked) {
  EXPECT_EQ(ask(Method::kGet, "/api/alarms", {}), "401");
  EXPECT_EQ(ask(Method::kPost, "/api/commands", {}), "401");
  EXPECT_EQ(ask(Method::kPost, "/api/commands", Role::kViewer), "403");
}

TEST_F(Routes, AnotherMethodIsRefusedWithThoseThatAreAllowed) {
  const auto refused = table_.find(Method::kGet, "/api/commands", Role::kOperator);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().status, 405u);
  EXPECT_EQ(refused.error().headers, (TextPairs{{"allow", "POST, DELETE, OPTIONS"}}));
  EXPECT_EQ(ask(Method::kGet, "/api/commands", {}), "401");
  EXPECT_EQ(ask(Method::kGet, "/api/commands", Role::kViewer), "403");
}

TEST_F(Routes, RowsAreInTheOrderOfTheirPaths) {
  std::vector<std::string> paths;
  for (const Route* route : table_.rows()) paths.push_back(route->path);
  EXPECT_EQ(paths,
            (std::vector<std::string>{"/", "/api/alarms", "/api/commands", "/api/commands"}));
}

TEST_F(Routes, ARouteIsAddedOnce) {
  EXPECT_DEATH(table_.add({Method::kGet, "/", Access::kPublic, saying("again")}), "broken rule");
}

}  // namespace
}  // namespace fieldcast::web
