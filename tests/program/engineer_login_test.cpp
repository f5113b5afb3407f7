#include <gmock/gmock.h>

#include "tests/program/engineer_bench.hpp"

namespace fieldcast::program {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Bench = EngineerBench;

TEST(Engineer, ALoginIsDemandedWhereItIsNeeded) {
  EngineerRules rules;
  rules.login_needed = true;
  Bench b(rules);
  b.sends("@@17FEFF");
  EXPECT_EQ(b.received(), "@@0004FEFF");
  EXPECT_THAT(b.taken, IsEmpty());
  EXPECT_EQ(b.hung_up, 1);
  EXPECT_EQ(b.remarks.back().kind, Remark::Kind::kLoginFailed);
}

TEST(Engineer, ARightLoginOpensTheWayAndAWrongOneClosesIt) {
  EngineerRules rules;
  rules.login_needed = true;
  Bench good(rules), bad(rules);
  for (Bench* b : {&good, &bad})
    b->sends("@@AU616e6e61:736563726574FEFF@@V217FEFF");  // anna, secret
  EXPECT_THAT(good.logins, ElementsAre("anna/secret"));
  EXPECT_THAT(good.taken, IsEmpty());
  good.tell(LoginChecked{true, ""});
  EXPECT_THAT(good.taken, ElementsAre("17"));
  bad.tell(LoginChecked{false, "wrong password"});
  EXPECT_EQ(bad.received(), "@@0004FEFF");
  EXPECT_EQ(bad.hung_up, 1);
  EXPECT_EQ(bad.remarks.back().kind, Remark::Kind::kLoginFailed);
  EXPECT_THAT(bad.taken, IsEmpty());
}

TEST(Engineer, ACertificateIsTheLoginOnceItsUserIsFound) {
  EngineerRules rules;
  rules.login_needed = rules.by_certificate = true;
  Bench good(rules), bad(rules);
  for (Bench* b : {&good, &bad}) {
    b->sends("@@V217FEFF");
    EXPECT_THAT(b->taken, IsEmpty()) << "before it is known who it is";
  }
  good.tell(LoginChecked{true, ""});
  EXPECT_THAT(good.taken, ElementsAre("17"));
  bad.tell(LoginChecked{false, "no such user"});
  EXPECT_EQ(bad.received(), "@@0004FEFF");
  EXPECT_EQ(bad.hung_up, 1);
  EXPECT_THAT(bad.taken, IsEmpty());
}

TEST(Engineer, ALoginThatCannotBeReadIsRefused) {
  for (const char* login :
       {"@@AU:FEFF", "@@AU6:6FEFF", "@@AUzz:00FEFF", "@@AU610a62:00FEFF", "@@AU616E6E61:00FEFF"}) {
    Bench b;
    b.sends(login);
    EXPECT_EQ(b.received(), "@@0004FEFF") << login;
    EXPECT_TRUE(b.engineer.over()) << login;
    EXPECT_THAT(b.logins, IsEmpty()) << login;
  }
}

}  // namespace
}  // namespace fieldcast::program
