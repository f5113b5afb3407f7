#include <gmock/gmock.h>

#include "tools/station/web/logins.hpp"

namespace fieldcast::web {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAre;
using namespace std::chrono_literals;

class Book : public testing::Test {
 protected:
  std::string begin(const std::string& user, Role role = Role::kViewer) {
    Login login;
    login.user = user;
    login.role = role;
    login.credential_created_at = {1'000};
    return book_.begin(login, next_secret(), now_);
  }
  std::string begin_token(const std::string& name, Duration left) {
    Login login;
    login.user = name;
    login.by_token = true;
    login.credential_created_at = {1'000};
    login.ends = now_ + left;
    return book_.begin(login, next_secret(), now_);
  }
  SessionStore::Secret next_secret() {
    SessionStore::Secret secret{};
    secret[0] = static_cast<unsigned char>(++secrets_);
    secret[1] = static_cast<unsigned char>(secrets_ >> 8);
    return secret;
  }
  std::string user_of(const std::string& cookie) {
    const Login* login = book_.find(cookie, now_);
    return login ? login->user : "-";
  }
  Instant now_{1h};
  unsigned secrets_ = 0;
  std::vector<std::uint64_t> ended_;
  SessionStore book_{[this](std::uint64_t id) { ended_.push_back(id); }};
};

TEST_F(Book, ALoginIsFoundByItsCookieOnly) {
  const std::string cookie = begin("anna", Role::kOperator);
  EXPECT_EQ(cookie.size(), 64u);
  EXPECT_EQ(cookie, "01" + std::string(62, '0'));
  const Login* login = book_.find(cookie, now_);
  ASSERT_NE(login, nullptr);
  EXPECT_EQ(login->user, "anna");
  EXPECT_EQ(login->role, Role::kOperator);
  std::string other = cookie;
  other.back() = '1';
  for (const std::string& wrong : {other, std::string(), std::string("x"), cookie + "0"})
    EXPECT_EQ(user_of(wrong), "-") << wrong;
}

TEST_F(Book, ALoginEndsWithoutUseAndInAllEvents) {
  const std::string idle = begin("idle"), busy = begin("busy");
  now_ += SessionStore::kIdle - 1s;
  EXPECT_EQ(user_of(busy), "busy");
  now_ += 1s;
  EXPECT_EQ(user_of(idle), "-");
  EXPECT_THAT(ended_, ElementsAre(1));
  for (int i = 0; i < 23; ++i) {
    EXPECT_EQ(user_of(busy), "busy") << i;
    now_ += SessionStore::kIdle - 1s;
  }
  now_ = Instant{1h} + SessionStore::kWhole;
  EXPECT_EQ(user_of(busy), "-");
}

TEST_F(Book, AnOpenConnectionIsAUse) {
  const std::string cookie = begin("anna");
  now_ += 29min;
  book_.touch(1, now_);
  now_ += 29min;
  EXPECT_EQ(user_of(cookie), "anna");
}

TEST_F(Book, ATokenHasItsOwnEndAndNoOther) {
  const std::string wall = begin_token("wall", 30 * 24h);
  now_ += 29 * 24h;
  EXPECT_EQ(user_of(wall), "wall");
  now_ += 24h;
  EXPECT_EQ(user_of(wall), "-");
}

TEST_F(Book, ALogoutEndsOne) {
  const std::string first = begin("anna"), second = begin("anna");
  book_.end(first);
  book_.end("nobody's");
  EXPECT_EQ(user_of(first), "-");
  EXPECT_EQ(user_of(second), "anna");
  EXPECT_THAT(ended_, ElementsAre(1));
}

TEST_F(Book, OneTooManyEndsTheOneUnusedForLongest) {
  std::vector<std::string> cookies;
  for (std::size_t i = 0; i < SessionStore::kMaxLogins; ++i) {
    cookies.push_back(begin(std::to_string(i)));
    now_ += 1ms;
  }
  EXPECT_EQ(user_of(cookies[0]), "0");
  const std::string last = begin("last");
  EXPECT_EQ(book_.size(), SessionStore::kMaxLogins);
  EXPECT_EQ(user_of(cookies[0]), "0");
  EXPECT_EQ(user_of(cookies[1]), "-");
  EXPECT_EQ(user_of(last), "last");
}

TEST_F(Book, LoginsEndWithTheirUserRoleOrPassword) {
  const std::string same = begin("same"), gone = begin("gone"), raised = begin("raised"),
                    renewed = begin("renewed"), token = begin_token("gone", 1h);
  book_.users_are(std::vector<User>{{"same", Role::kViewer, {1'000}},
                                    {"raised", Role::kOperator, {1'000}},
                                    {"renewed", Role::kViewer, {1'001}}});
  EXPECT_EQ(user_of(same), "same");
  EXPECT_EQ(user_of(token), "gone");
  EXPECT_THAT(ended_, UnorderedElementsAre(2, 3, 4));
  book_.tokens_are(std::vector<Token>{{"same", {1'000}, {2'000}}});
  EXPECT_EQ(user_of(token), "-");
  EXPECT_EQ(user_of(same), "same");
}

// Regression: a session outlived its password if the clock was set back before the new one.
TEST_F(Book, ANewPasswordEndsLoginsAlsoIfTheClockWasSetBack) {
  const std::string old = begin("renewed");
  book_.users_are(std::vector<User>{{"renewed", Role::kViewer, {999}}});
  EXPECT_EQ(user_of(old), "-");
}

// Regression: sessions of a leaked token went on if the new token had its name.
TEST_F(Book, LoginsEndWithTheirTokenAlsoIfANewOneHasItsName) {
  const std::string same = begin_token("same", 1h), rotated = begin_token("rotated", 1h);
  book_.tokens_are(std::vector<Token>{{"same", {1'000}, {2'000}}, {"rotated", {1'001}, {2'000}}});
  EXPECT_EQ(user_of(same), "same");
  EXPECT_EQ(user_of(rotated), "-");
}

}  // namespace
}  // namespace fieldcast::web
