#include "tools/cli/command/secure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/bridge/security/scratch_folder.hpp"

namespace fieldcast::cli {
namespace {

using enum SecureOptions::Action;
using security::MemberRole;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr UtcTime kToday{1'800'000'000'000'000'000};

class SecureTest : public testing::Test {
 protected:
  ExitCode run(SecureOptions::Action action, security::Member member = {}, UtcTime now = kToday) {
    SecureOptions options{.action = action, .folder = folder_, .member = std::move(member)};
    options.json = json_;
    std::istringstream in;
    std::ostringstream out, err;
    const ExitCode code = secure(options, now, Streams{in, out, err});
    out_ = out.str();
    err_ = err.str();
    return code;
  }

  test::ScratchFolder scratch_;
  std::string folder_ = scratch_.path("plant");
  std::string out_, err_;
  bool json_ = false;
};

TEST_F(SecureTest, MakesShowsRevokesAndChecks) {
  ASSERT_EQ(run(kInit), ExitCode::kOk);
  EXPECT_THAT(out_, HasSubstr("secure add bridge NAME"));
  ASSERT_EQ(run(kAdd, {MemberRole::kBridge, "line-7", {}}), ExitCode::kOk);
  EXPECT_THAT(out_, HasSubstr("dds: { security: FOLDER }"));
  ASSERT_EQ(run(kAdd, {MemberRole::kPlant, "mes", {"press-*"}}), ExitCode::kOk);
  EXPECT_THAT(out_, HasSubstr("for buses press-*"));
  EXPECT_EQ(run(kCheck), ExitCode::kOk);
  EXPECT_THAT(out_, HasSubstr("in order"));
  EXPECT_EQ(run(kRevoke, {MemberRole::kPlant, "mes", {}}), ExitCode::kOk);
  EXPECT_THAT(out_, HasSubstr("every other member"));
  EXPECT_EQ(run(kShow), ExitCode::kOk);
  EXPECT_THAT(out_, HasSubstr("revoked"));
  EXPECT_THAT(out_, HasSubstr("until 2028-01-15"));
  json_ = true;
  EXPECT_EQ(run(kShow), ExitCode::kOk);
  EXPECT_THAT(out_, HasSubstr(R"("name":"mes","role":"plant","buses":["press-*"])"));
  EXPECT_THAT(out_, HasSubstr(R"("revoked":true)"));
}

TEST_F(SecureTest, WarnsAheadAndFailsAtTheEnd) {
  ASSERT_EQ(run(kInit), ExitCode::kOk);
  ASSERT_EQ(run(kAdd, {MemberRole::kStation, "wall", {}}), ExitCode::kOk);
  const auto in = [](int days) {
    return UtcTime{kToday.nanoseconds + (days * security::kDay).count()};
  };
  EXPECT_EQ(run(kCheck, {}, in(340)), ExitCode::kOk);
  EXPECT_THAT(out_, HasSubstr("soon: "));
  EXPECT_EQ(run(kCheck, {}, in(370)), ExitCode::kFound);
  EXPECT_THAT(out_, HasSubstr("fault: "));
  EXPECT_EQ(run(kRenew, {MemberRole::kStation, "wall", {}}, in(370)), ExitCode::kOk);
  EXPECT_EQ(run(kCheck, {}, in(370)), ExitCode::kOk);
}

TEST_F(SecureTest, SaysWhatItCannotDo) {
  EXPECT_EQ(run(kAdd, {MemberRole::kBridge, "line-7", {}}), ExitCode::kRejected);
  EXPECT_THAT(err_, HasSubstr("fieldcast secure init"));
  ASSERT_EQ(run(kInit), ExitCode::kOk);
  EXPECT_EQ(run(kInit), ExitCode::kRejected);
  EXPECT_THAT(err_, HasSubstr("nothing was changed"));
  EXPECT_EQ(run(kAdd, {MemberRole::kBridge, "line-7", {"press-*"}}), ExitCode::kRejected);
  EXPECT_THAT(err_, HasSubstr("only a plant"));
  EXPECT_EQ(run(kRevoke, {MemberRole::kBridge, "nobody", {}}), ExitCode::kRejected);
  EXPECT_THAT(err_, HasSubstr("no member nobody"));
  EXPECT_THAT(out_, IsEmpty());
}

TEST_F(SecureTest, NamesWhatItCannotReadAndGoesOn) {
  ASSERT_EQ(run(kInit), ExitCode::kOk);
  ASSERT_EQ(run(kAdd, {MemberRole::kStation, "wall", {}}), ExitCode::kOk);
  ASSERT_EQ(run(kAdd, {MemberRole::kPlant, "mes", {}}), ExitCode::kOk);
  std::ofstream(folder_ + "/members/x.tgz") << "an archive";
  EXPECT_EQ(run(kCheck), ExitCode::kOk);
  EXPECT_THAT(out_, AllOf(HasSubstr("stray: "), HasSubstr("x.tgz is no member's folder"),
                          HasSubstr("in order")));
  const std::ofstream unread(folder_ + "/issued/0123.pem");
  for (const auto action : {kShow, kRevoke}) {
    EXPECT_EQ(run(action, {MemberRole::kPlant, "mes", {}}), ExitCode::kFound);
    EXPECT_THAT(err_, HasSubstr("/issued/0123.pem is empty"));
    EXPECT_THAT(out_, HasSubstr(action == kShow ? "wall" : "mes is revoked"));
  }
  EXPECT_EQ(run(kCheck), ExitCode::kFound);
  EXPECT_THAT(out_, HasSubstr("fault: " + folder_ + "/issued/0123.pem is empty"));
  EXPECT_EQ(run(kAdd, {MemberRole::kPlant, "mes", {}}), ExitCode::kRejected);
  EXPECT_THAT(err_, AllOf(HasSubstr("is revoked"), Not(HasSubstr("renew"))));
}

TEST_F(SecureTest, QuotesAFolderInACommandForTheShell) {
  for (const auto& [name, word] : {std::pair{"plant", "plant"},
                                   {"Anlage Süd", "'Anlage Süd'"},
                                   {"joe's", "'joe'\\''s'"},
                                   {"a$b", "'a$b'"}}) {
    folder_ = scratch_.path(name);
    ASSERT_EQ(run(kInit), ExitCode::kOk);
    EXPECT_THAT(out_, HasSubstr(word[0] == '\'' ? "--authority '" + scratch_.path(word + 1)
                                                : "--authority " + scratch_.path(word)));
  }
}

TEST_F(SecureTest, AFolderThatOthersMayChangeIsAFault) {
  ASSERT_EQ(run(kInit), ExitCode::kOk);
  std::filesystem::permissions(folder_, std::filesystem::perms(0777));
  EXPECT_EQ(run(kCheck), ExitCode::kFound);
  EXPECT_THAT(out_, HasSubstr("fault: " + folder_ + ": others may change it; chmod go-w"));
  EXPECT_EQ(run(kAdd, {MemberRole::kBridge, "line-7", {}}), ExitCode::kRejected);
  EXPECT_THAT(err_, HasSubstr("chmod go-w"));
}

}  // namespace
}  // namespace fieldcast::cli
