#include "tools/station/report/report_table.hpp"

#include <gmock/gmock.h>

#include "bridge/store/notification_table.hpp"
#include "tests/bridge/store/postgres_server.hpp"
#include "tests/bridge/store/scratch.hpp"

namespace fieldcast::web {
namespace {

constexpr UtcTime kSaved{1'790'000'000'000'000'000};

void keeps_reports_and_runs(const StoreAddress& address) {
  auto connection = open_store(address, IfMissing::kCreate);
  SavedReportTable saved(*connection);
  EXPECT_TRUE(saved.save({"能耗", "channel=line&by=day", "anna", kSaved}));
  EXPECT_TRUE(saved.save({"能耗", "channel=line&by=month", "erna", kSaved}));
  ASSERT_EQ(saved.list().size(), 1u);
  EXPECT_EQ(saved.list()[0].query, "channel=line&by=month");
  EXPECT_TRUE(saved.remove("能耗"));
  EXPECT_FALSE(saved.remove("能耗"));

  ReportRunTable runs(*connection);
  EXPECT_EQ(runs.last("energy", "folder", "2026-11-28"), "");
  for (const char* period : {"2026-11-27", "2026-11-28", "2026-11"})
    runs.put({"energy", "folder", period, kSaved, "file"});
  runs.put({"energy", "folder", "2026-11-28", kSaved, "again"});
  EXPECT_EQ(runs.last("energy", "folder", "2026-01-01"), "2026-11-28");
  EXPECT_EQ(runs.last("energy", "folder", "2026-01"), "2026-11");
  EXPECT_EQ(runs.last("energy", "mail", "2026-01-01"), "");
  EXPECT_EQ(runs.newest(10).size(), 3u);
  EXPECT_EQ(runs.newest(1).size(), 1u);
  const UtcTime later{kSaved.nanoseconds + ReportRunTable::kKept.count() + 1};
  runs.put({"energy", "folder", "2027-11-28", later, "file"});
  EXPECT_EQ(runs.newest(10).size(), 1u);
}

void an_attachment_is_kept_until_it_is_sent(const StoreAddress& address) {
  auto connection = open_store(address, IfMissing::kCreate);
  NotificationTable queue(*connection);
  Notification message{"one", "crew", "ann@plant.example", kSaved, "subject", "text", ""};
  message.attachment_name = "energy.csv";
  message.attachment = "UEsDBA==";
  queue.put(message);
  const auto next = queue.next("crew", kSaved);
  ASSERT_TRUE(next);
  EXPECT_EQ(static_cast<const Notification&>(*next), message);
  queue.sent("one", kSaved);
  std::string left = "?";
  connection->query("select attachment from notifications", {}, [&](const SqlRow& row) {
    left = text_at(row, 0);
    return true;
  });
  EXPECT_EQ(left, "");
}

TEST(ReportTables, AreKept) {
  const test::Scratch scratch;
  keeps_reports_and_runs(StoreAddress(scratch.path("store.db")));
  an_attachment_is_kept_until_it_is_sent(StoreAddress(scratch.path("store.db")));
}

TEST(ReportTables, AreKeptInPostgres) {
  test::with_postgres([](test::PostgresServer& server) {
    keeps_reports_and_runs(server.address());
    an_attachment_is_kept_until_it_is_sent(server.address());
  });
}

}  // namespace
}  // namespace fieldcast::web
