#include "tools/station/web/route_table.hpp"

#include <gtest/gtest.h>

namespace fieldcast::web {
namespace {

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
    table_.add({Method::kPost, "/api/drafts", Access::kEngineer, saying("engineer")});
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
  EXPECT_EQ(ask(Method::kPost, "/api/drafts", Role::kProgrammer), "403");
  EXPECT_EQ(ask(Method::kPost, "/api/drafts", Role::kEngineer), "engineer");
  EXPECT_EQ(ask(Method::kPost, "/api/commands", Role::kEngineer), "command");
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
  EXPECT_EQ(paths, (std::vector<std::string>{"/", "/api/alarms", "/api/commands", "/api/commands",
                                             "/api/drafts"}));
}

TEST_F(Routes, ARouteIsAddedOnce) {
  EXPECT_DEATH(table_.add({Method::kGet, "/", Access::kPublic, saying("again")}), "broken rule");
}

}  // namespace
}  // namespace fieldcast::web
