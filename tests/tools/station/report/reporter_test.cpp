#include "tools/station/report/reporter.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "bridge/store/notification_table.hpp"
#include "bridge/store/store.hpp"
#include "tests/bridge/store/scratch.hpp"
#include "tests/bridge/store/store_support.hpp"
#include "tools/station/report/report_table.hpp"

namespace fieldcast::web {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::UnorderedElementsAre;

constexpr std::int64_t kDays = 24 * 3600;

class ReporterTest : public testing::Test {
 protected:
  ReporterTest() {
    ::setenv("TZ", "UTC", 1);
    ::tzset();
    (void)open_store(address_, IfMissing::kCreate);
    Store store(test::forever(address_));
    const auto number = store.number_of(
        {.bus = "line", .device = "meter", .channel = "p", .unit = "kW", .type = "float64"});
    for (std::int64_t day = 0; day < 5; ++day) {
      const SampleRow row{.channel = *number,
                          .published_at = day_at(day, 12),
                          .acquired_at = day_at(day, 12),
                          .sequence = static_cast<std::uint64_t>(day) + 1,
                          .quality = Quality::kGood,
                          .value = 10.0 + static_cast<double>(day)};
      store.put(std::span(&row, 1));
    }
    EXPECT_TRUE(store.flush(std::chrono::seconds{30}));
  }
  ~ReporterTest() override {
    ::unsetenv("TZ");
    ::tzset();
  }

  // 2026-11-20 plus `day` days, at this hour.
  static UtcTime day_at(std::int64_t day, std::int64_t hour) {
    return {(1'795'132'800 + day * kDays + hour * 3600) * 1'000'000'000};
  }
  [[nodiscard]] ReportSpec spec() const {
    ReportSpec made{.name = "energy", .channels = {*Pattern::parse("line/*/p")}, .csv = true};
    made.folder = folder_;
    return made;
  }
  // As after a restart: a new maker.
  void run(const ReportSpec& report, UtcTime now) const {
    ReportMaker({report}, targets_, "plant", address_).make_due(now, [] { return false; });
  }
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    std::error_code none;
    for (const auto& each : fs::directory_iterator(folder_, none))
      names.push_back(each.path().filename());
    return names;
  }
  [[nodiscard]] std::string text_of(const std::string& name) const {
    std::ifstream file(folder_ + '/' + name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::vector<QueuedNotification> mails() const {
    return NotificationTable(*open_store(address_, IfMissing::kFail)).newest(100);
  }

  test::Scratch scratch_;
  const StoreAddress address_{scratch_.path("reports.db")};
  const std::string folder_ = scratch_.path("reports");
  const std::vector<NotifyTarget> targets_{
      {.name = "crew", .mail = {"ann@plant.example", "bob@plant.example"}},
      {.name = "boss", .mail = {"eve@plant.example"}}};
};

TEST_F(ReporterTest, TheFileOfADayHasItsTotals) {
  run(spec(), day_at(3, 7));
  EXPECT_THAT(files(), UnorderedElementsAre("energy_2026-11-22.csv"));
  const std::string text = text_of("energy_2026-11-22.csv");
  EXPECT_THAT(text, HasSubstr("\nline/meter/p,kW,2026-11-22T00:00:00+0000,2026-11-23T00:00:00+0000,"
                              "12,12,12,0.2,"));
  struct stat found {};
  ASSERT_EQ(::stat((folder_ + "/energy_2026-11-22.csv").c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 0777, 0640u);
}

TEST_F(ReporterTest, NothingIsMadeTwiceOverRestartsAndMissedDaysAreMadeUp) {
  run(spec(), day_at(1, 7));
  EXPECT_THAT(files(), UnorderedElementsAre("energy_2026-11-20.csv"));
  fs::remove(folder_ + "/energy_2026-11-20.csv");
  run(spec(), day_at(1, 8));
  EXPECT_THAT(files(), IsEmpty());
  run(spec(), day_at(4, 7));
  EXPECT_THAT(files(), UnorderedElementsAre("energy_2026-11-21.csv", "energy_2026-11-22.csv",
                                            "energy_2026-11-23.csv"));
}

TEST_F(ReporterTest, EachRecipientGetsOneMailWithTheFile) {
  ReportSpec report = spec();
  report.folder.clear();
  report.mail = {"crew"};
  report.csv = false;
  run(report, day_at(3, 7));
  run(report, day_at(3, 9));
  const auto all = mails();
  ASSERT_THAT(all, SizeIs(2));
  EXPECT_EQ(all[0].subject, "Report energy 2026-11-22 of the station plant");
  auto connection = open_store(address_, IfMissing::kFail);
  const auto next = NotificationTable(*connection).next("crew", day_at(3, 10));
  ASSERT_TRUE(next);
  EXPECT_EQ(next->attachment_name, "energy_2026-11-22.xlsx");
  EXPECT_THAT(next->attachment, testing::StartsWith("UEsDB"));  // "PK\x03\x04" in base64
}

TEST_F(ReporterTest, AFolderThatCannotBeWrittenDoesNotHoldUpTheMails) {
  std::ofstream(folder_) << "a file";
  ReportSpec report = spec();
  report.mail = {"crew", "boss"};
  run(report, day_at(3, 7));
  EXPECT_THAT(mails(), SizeIs(3));
  fs::remove(folder_);
  run(report, day_at(3, 8));
  EXPECT_THAT(files(), UnorderedElementsAre("energy_2026-11-22.csv"));
  EXPECT_THAT(mails(), SizeIs(3));
}

TEST_F(ReporterTest, AFailureIsTriedAgainAfterAPause) {
  std::ofstream(folder_) << "a file";
  ReportMaker maker({spec()}, targets_, "plant", address_);
  const auto never = [] { return false; };
  maker.make_due(day_at(3, 7), never);
  fs::remove(folder_);
  maker.make_due({day_at(3, 7).nanoseconds + 1}, never);
  EXPECT_THAT(files(), IsEmpty());
  maker.make_due(day_at(3, 8), never);
  EXPECT_THAT(files(), SizeIs(1));
}

TEST_F(ReporterTest, ALinkInTheFolderIsReplacedAndNotFollowed) {
  fs::create_directory(folder_);
  std::ofstream(scratch_.path("precious")) << "precious";
  fs::create_symlink(scratch_.path("precious"), folder_ + "/energy_2026-11-22.csv");
  fs::create_symlink(scratch_.path("precious"), folder_ + "/energy_2026-11-22.csv.new");
  run(spec(), day_at(3, 7));
  std::ifstream file(scratch_.path("precious"));
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "precious");
  EXPECT_THAT(text_of("energy_2026-11-22.csv"), HasSubstr("line/meter/p"));
}

TEST_F(ReporterTest, AStopEndsTheWorkWithoutARow) {
  ReportMaker maker({spec()}, targets_, "plant", address_);
  maker.make_due(day_at(3, 7), [] { return true; });
  EXPECT_THAT(files(), IsEmpty());
  maker.make_due(day_at(3, 7), [] { return false; });
  EXPECT_THAT(files(), SizeIs(1));
}

}  // namespace
}  // namespace fieldcast::web
