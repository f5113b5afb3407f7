#include "bridge/store/users/user_table.hpp"
#include "tests/tools/station/api/api_support.hpp"
#include "tools/station/api/administration.hpp"
#include "tools/station/api/api_routes.hpp"

namespace fieldcast::web {
namespace {

using test::utc;
using AuditApiTest = test::ApiTest;

TEST_F(AuditApiTest, TheNewestEntriesComeFirst) {
  store([](Store& to) {
    for (int i = 0; i < 5; ++i)
      to.append({.at = utc(kNow - 10 + i),
                 .who = "anna",
                 .what = "write " + std::to_string(i),
                 .target = "line/d/c",
                 .result = "done"});
  });
  add_routes(table_, {.database = database(), .now = now()});
  const auto entries = json("/api/audit?limit=2").at("entries");
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[0].at("what"), "write 4");
  EXPECT_EQ(entries[1].at("what"), "write 3");
  EXPECT_EQ(entries[0].at("at_ms"), utc(kNow - 6).nanoseconds / 1'000'000);
  EXPECT_EQ(json("/api/audit?to=1700000000000").at("entries").size(), 0u);
}

TEST_F(AuditApiTest, OnlyOperatorsSeeTheAuditAndTheUsers) {
  add_routes(table_, {});
  for (const char* const path : {"/api/audit", "/api/users"}) {
    const auto refused = table_.find(Method::kGet, path, Role::kViewer);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().status, 403u);
  }
}

TEST_F(AuditApiTest, UsersAreShownWithoutTheirHashes) {
  {
    const auto connection = open_store(address(), IfMissing::kCreate);
    ASSERT_TRUE(UserTable(*connection).add("anna", Role::kOperator, "a long password", utc(1)));
  }
  add_routes(table_, {.database = database()});
  const HttpResponse response = ask("/api/users");
  EXPECT_EQ(response.body,
            R"({"users":[{"user":"anna","role":"operator","created_ms":1700000001000}]})");
}

}  // namespace
}  // namespace fieldcast::web
