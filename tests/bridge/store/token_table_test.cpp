#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "bridge/store/sql/schema.hpp"
#include "bridge/store/users/user_table.hpp"
#include "tests/bridge/store/older_store.hpp"
#include "tests/bridge/store/postgres_server.hpp"
#include "tests/bridge/store/scratch.hpp"

namespace fieldcast {
namespace {

using testing::ElementsAre;

constexpr UtcTime kBegin{1'700'000'000'000'000'000};
constexpr UtcTime kEnding{1'700'086'400'000'000'000};

std::string everything_in(SqlConnection& connection) {
  std::string text;
  connection.query("select name, hash from tokens", {}, [&](const SqlRow& row) {
    text += text_at(row, 0) + ' ' + text_at(row, 1) + '\n';
    return true;
  });
  return text;
}

void lets_in_until_its_end(SqlConnection& connection) {
  TokenTable table(connection);
  const std::string secret = make_token();
  const Token wall{"wall-1", kBegin, kEnding};
  EXPECT_TRUE(table.add(wall, secret));
  EXPECT_FALSE(table.add(wall, make_token())) << "the name is taken";
  EXPECT_EQ(table.find(secret, kBegin), wall);
  EXPECT_EQ(table.find(secret, {kEnding.nanoseconds - 1}), wall);
  EXPECT_EQ(table.find(secret, kEnding), std::nullopt);
  EXPECT_EQ(table.find(make_token(), kBegin), std::nullopt);
  EXPECT_EQ(table.find("", kBegin), std::nullopt);
  EXPECT_EQ(table.find("' or 1=1 --", kBegin), std::nullopt);
  EXPECT_THAT(table.list(), ElementsAre(wall));
  EXPECT_EQ(everything_in(connection).find(secret), std::string::npos) << "only its hash is kept";
  EXPECT_TRUE(table.remove("wall-1"));
  EXPECT_FALSE(table.remove("wall-1"));
  EXPECT_EQ(table.find(secret, kBegin), std::nullopt);
}

void has_a_limit(SqlConnection& connection) {
  TokenTable table(connection);
  for (std::size_t i = 0; i < TokenTable::kMaxTokens; ++i)
    ASSERT_TRUE(table.add({"t" + std::to_string(i), kBegin, kEnding}, make_token()));
  EXPECT_FALSE(table.add({"one-more", kBegin, kEnding}, make_token()));
}

void comes_with_an_upgrade(const StoreAddress& address) {
  {
    const auto connection = open_store(address, IfMissing::kFail);
    (void)UserTable(*connection).add("ann", Role::kViewer, "a long password", kBegin);
    test::back_to_version(*connection, 6);
  }
  const auto connection = open_store(address, IfMissing::kFail);
  EXPECT_TRUE(TokenTable(*connection).add({"wall", kBegin, kEnding}, make_token()));
  EXPECT_EQ(UserTable(*connection).list().size(), 1u) << "what was there is there";
}

void keeps_tokens(const StoreAddress& address) {
  {
    const auto connection = open_store(address, IfMissing::kCreate);
    lets_in_until_its_end(*connection);
    connection->script("begin");
    has_a_limit(*connection);
    connection->script("rollback");
  }
  comes_with_an_upgrade(address);
}

TEST(TokenTable, AtSqlite) {
  const test::Scratch scratch;
  keeps_tokens(StoreAddress(scratch.path("tokens.db")));
}

TEST(TokenTable, AtPostgres) {
  test::with_postgres([](test::PostgresServer& server) { keeps_tokens(server.address()); });
}

TEST(MakeToken, MakesADifferentOneEachTime) {
  std::set<std::string> made;
  for (int i = 0; i < 100; ++i) made.insert(make_token());
  EXPECT_EQ(made.size(), 100u);
  for (const std::string& token : made) EXPECT_TRUE(looks_like_token(token)) << token;
}

TEST(LooksLikeToken, OnlyWhatMakeTokenMakes) {
  const std::string token = make_token();
  EXPECT_FALSE(looks_like_token(""));
  EXPECT_FALSE(looks_like_token(token + 'x'));
  EXPECT_FALSE(looks_like_token(token.substr(1)));
  EXPECT_FALSE(looks_like_token("xyz_" + token.substr(4)));
  EXPECT_FALSE(looks_like_token(token.substr(0, 46) + ' '));
}

}  // namespace
}  // namespace fieldcast
