#include "tests/tools/station/api/api_support.hpp"
#include "tools/station/api/api_routes.hpp"

namespace fieldcast::web {
namespace {

using PlanApiTest = test::ApiTest;

TEST_F(PlanApiTest, IsWhatTheBridgeTells) {
  LiveModel model;
  add_routes(table_, {.model = &model});
  const HttpResponse none = ask("/api/plan?bus=line");
  EXPECT_EQ(none.status, 404u);
  EXPECT_NE(none.body.find("no bridge publishes a plan"), std::string::npos);
  EXPECT_EQ(json("/api/plan").size(), 0u);
  StationReadPlan plan;
  plan.bus = "line";
  model.put(plan);
  EXPECT_EQ(json("/api/plan?bus=line").at("bus"), "line");
  EXPECT_EQ(json("/api/plan").size(), 1u);
}

}  // namespace
}  // namespace fieldcast::web
