#include "tools/station/dashboard/dashboard_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/bridge/store/postgres_server.hpp"
#include "tests/bridge/store/scratch.hpp"

namespace fieldcast::web {
namespace {

StoredDocument document(std::string name, std::int64_t version) {
  return {.name = std::move(name),
          .title = "A title",
          .version = version,
          .content = "text " + std::to_string(version),
          .saved_by = "anna",
          .saved_at = UtcTime{version * 1'000'000}};
}

void saves_the_next_version_only(SqlConnection& connection) {
  DashboardTable table(connection);
  EXPECT_FALSE(table.save(document("pumps", 2)));
  EXPECT_TRUE(table.save(document("pumps", 1)));
  EXPECT_FALSE(table.save(document("pumps", 1)));
  EXPECT_TRUE(table.save(document("pumps", 2)));
  EXPECT_FALSE(table.save(document("pumps", 4)));
  const auto newest = table.find("pumps", std::nullopt);
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->version, 2);
  EXPECT_EQ(newest->content, "text 2");
  EXPECT_EQ(newest->saved_by, "anna");
  EXPECT_EQ(newest->saved_at, UtcTime{2'000'000});
  EXPECT_EQ(table.find("pumps", 1)->content, "text 1");
  EXPECT_FALSE(table.find("pumps", 3));
  EXPECT_FALSE(table.find("' or 1=1 --", std::nullopt));
}

void keeps_the_last_versions(SqlConnection& connection) {
  DashboardTable table(connection);
  for (std::int64_t version = 1; version <= DashboardTable::kKeptVersions + 1; ++version)
    ASSERT_TRUE(table.save(document("old", version)));
  EXPECT_FALSE(table.find("old", 1));
  EXPECT_TRUE(table.find("old", 2));
}

void removes_the_version_that_the_caller_has_seen(SqlConnection& connection) {
  DashboardTable table(connection);
  ASSERT_TRUE(table.save(document("seen", 1)));
  ASSERT_TRUE(table.save(document("seen", 2)));
  EXPECT_FALSE(table.remove("seen", 1));
  EXPECT_TRUE(table.remove("seen", 2));
  EXPECT_FALSE(table.find("seen", 1));
  EXPECT_FALSE(table.remove("seen", 2));
  EXPECT_TRUE(table.save(document("seen", 1)));
}

void has_a_limit_of_dashboards(SqlConnection& connection) {
  DashboardTable table(connection);
  std::size_t saved = table.list().size();
  for (std::size_t i = 0; saved < DashboardTable::kMaxDashboards; ++i, ++saved)
    ASSERT_TRUE(table.save(document("d" + std::to_string(i), 1)));
  EXPECT_FALSE(table.save(document("one-more", 1)));
  EXPECT_TRUE(table.save(document("d0", 2)));
  EXPECT_EQ(table.list().size(), DashboardTable::kMaxDashboards);
  EXPECT_EQ(table.list()[0].name, "d0");
  EXPECT_EQ(table.list()[0].version, 2);
  EXPECT_EQ(table.list()[0].content, "");
}

StoredPicture picture(std::string name) {
  return {.document = {.name = std::move(name), .content = "<svg/>", .saved_by = "anna"},
          .type = "svg",
          .width = 300,
          .height = 200,
          .bytes = 6};
}

void replaces_pictures(SqlConnection& connection) {
  PictureTable table(connection);
  EXPECT_EQ(table.save(picture("boiler")), 1);
  StoredPicture next = picture("boiler");
  next.document.content = "iVBO";
  next.type = "png";
  EXPECT_EQ(table.save(next), 2);
  const auto found = table.find("boiler");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->document.version, 2);
  EXPECT_EQ(found->document.content, "iVBO");
  EXPECT_EQ(found->type, "png");
  EXPECT_EQ(found->width, 300);
  EXPECT_EQ(table.list().size(), 1u);
  EXPECT_EQ(table.list()[0].document.content, "");
  EXPECT_TRUE(table.remove("boiler"));
  EXPECT_FALSE(table.remove("boiler"));
  EXPECT_FALSE(table.find("boiler"));
}

void has_a_limit_of_pictures(SqlConnection& connection) {
  PictureTable table(connection);
  for (std::size_t i = 0; i < PictureTable::kMaxPictures; ++i)
    ASSERT_EQ(table.save(picture("p" + std::to_string(i))), 1);
  EXPECT_EQ(table.save(picture("one-more")), 0);
  EXPECT_EQ(table.save(picture("p0")), 2);
}

void everything(SqlConnection& connection) {
  saves_the_next_version_only(connection);
  keeps_the_last_versions(connection);
  removes_the_version_that_the_caller_has_seen(connection);
  has_a_limit_of_dashboards(connection);
  replaces_pictures(connection);
  has_a_limit_of_pictures(connection);
}

TEST(DashboardTable, VersionsAndLimitsInSqlite) {
  const fieldcast::test::Scratch scratch;
  everything(*open_store(StoreAddress(scratch.path("dashboards.db")), IfMissing::kCreate));
}

TEST(DashboardTable, VersionsAndLimitsInPostgres) {
  fieldcast::test::with_postgres([](fieldcast::test::PostgresServer& server) {
    everything(*open_store(server.address(), IfMissing::kCreate));
  });
}

}  // namespace
}  // namespace fieldcast::web
