#include "tools/forward/outlet/postgresql/postgresql.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <map>
#include <memory>

#include "tests/bridge/store/postgres_server.hpp"
#include "tests/tools/forward/batch_support.hpp"
#include "tools/forward/outlet/postgresql/arrays.hpp"
#include "tools/forward/outlet/postgresql/connection_text.hpp"
#include "tools/forward/outlet/postgresql/tables.hpp"
#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::vector<std::string> texts(const SqlRow& row) {
  std::vector<std::string> found;
  for (const SqlValue& value : row) {
    const auto* text = std::get_if<std::string>(&value);
    found.push_back(text == nullptr ? "?" : *text);
  }
  return found;
}

TEST(PostgresqlArrays, TextsAreQuotedAndNullsAreNot) {
  ArrayText array;
  array.add(std::string_view("a \"b\" \\ ,{}"));
  array.add(std::string_view(""));
  array.add(std::string_view("NULL"));
  array.add_null();
  EXPECT_EQ(array.text(), R"({"a \"b\" \\ ,{}","","NULL",NULL})");
  EXPECT_EQ(ArrayText().text(), "{}");
}

TEST(PostgresqlArrays, NumbersHaveTheFormOfPostgresql) {
  ArrayText array;
  array.add(std::int64_t{-3});
  for (const double number :
       {0.1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity()})
    array.add(std::optional<double>(number));
  array.add(std::optional<double>());
  EXPECT_EQ(array.text(), "{-3,0.1,NaN,Infinity,-Infinity,NULL}");
}

TEST(PostgresqlArrays, AValueIsANumberAndATextIfADoubleIsNotExact) {
  SampleBatch batch;
  batch.epoch = 7;
  const auto add = [&batch](Value value) {
    BatchSample sample;
    sample.sequence = batch.samples.size() + 1;
    sample.acquired_at = UtcTime{1'000};
    sample.value = std::move(value);
    batch.samples.push_back(sample);
  };
  add(true);
  add(2.5);
  add(std::int64_t{-4});
  add(std::numeric_limits<std::uint64_t>::max());
  add(std::string("idle"));
  batch.samples.back().quality = Quality::kUncertain;
  batch.samples.back().device_code = 3;
  SampleRows rows;
  rows.add(batch, std::vector<std::int64_t>{42});
  EXPECT_EQ(rows.size(), 5u);
  EXPECT_THAT(
      texts(rows.parameters()),
      ElementsAre("{42,42,42,42,42}", "{7,7,7,7,7}", "{1,2,3,4,5}", "{1000,1000,1000,1000,1000}",
                  R"({"GOOD","GOOD","GOOD","GOOD","UNCERTAIN"})", "{0,0,0,0,3}",
                  "{1,2.5,-4,18446744073709551616,NULL}",
                  R"({NULL,NULL,NULL,"18446744073709551615","idle"})"));
}

TEST(PostgresqlArrays, ASampleOfAnUnknownChannelIsLeftOut) {
  SampleRows rows;
  rows.add(seconds(1, 3), {});
  EXPECT_EQ(rows.size(), 0u);
}

TEST(PostgresqlArrays, AnAlarmHasFourteenParameters) {
  EXPECT_EQ(alarm_parameters("north", alarm(), 7).size(), 14u);
  EXPECT_EQ(channel_parameters("north", catalogue({"a", "b"})).size(), 12u);
}

TEST(PostgresqlTables, TheTypeHasEveryQuality) {
  const std::string text = create_tables("plant");
  for (int i = 0; i <= static_cast<int>(Quality::kNotYetRead); ++i)
    EXPECT_THAT(text, HasSubstr("'" + std::string(to_text(static_cast<Quality>(i))) + "'"));
  EXPECT_THAT(text, HasSubstr("create table if not exists \"plant\".channels"));
  EXPECT_THAT(text, Not(HasSubstr("{s}")));
}

// An outlet, and a second connection that reads what it has written.
class Written {
 public:
  explicit Written(const test::PostgresServer& server)
      : reader_(open_postgres(server.address())),
        outlet_(spec_of(server),
                {.site = "north",
                 .payload = {},
                 .catalogue = [this](std::uint64_t identity) -> std::optional<std::string> {
                   const auto found = catalogues_.find(identity);
                   if (found == catalogues_.end()) return std::nullopt;
                   return found->second;
                 },
                 .wake = [] {},
                 .count_connection = [] { return std::uint64_t{0}; },
                 .on_command = nullptr}) {
    EXPECT_TRUE(outlet_.is_ready(Instant{std::chrono::seconds{1}}));
  }
  // The identity of a catalogue with this unit.
  std::uint64_t catalogue_in(const std::string& unit) {
    DeviceCatalogue made = catalogue({"a"});
    made.channels[0].unit = unit;
    catalogues_[identity_of(made)] = encode("north", made);
    return identity_of(made);
  }
  void write_catalogue(std::uint64_t identity) {
    write({.kind = RecordKind::kCatalogue,
           .bus = "line",
           .device = "press",
           .identity = identity,
           .body = catalogues_.at(identity)});
  }
  void write_late(std::uint64_t identity) {
    SampleBatch batch = seconds(0, 1);
    batch.catalogue = identity;
    Record record = record_of(batch);
    record.is_late = true;
    write(record);
  }
  void write(const Record& record) {
    EXPECT_TRUE(outlet_.send(record));
    outlet_.flush();
    const auto results = outlet_.take_results();
    ASSERT_EQ(results.size(), 1u);
    EXPECT_EQ(results[0].outcome, Outcome::kAcknowledged);
  }
  std::string one(const std::string& sql) {
    std::string found;
    reader_->query(sql, {}, [&found](const SqlRow& row) {
      found = text_at(row, 0);
      return false;
    });
    return found;
  }

 private:
  static PostgresqlSpec spec_of(const test::PostgresServer& server) {
    const std::string address = server.address().text();
    PostgresqlSpec spec;
    spec.server = address.substr(address.find("host=") + 5);
    spec.database = "postgres";
    spec.user = "fieldcast";
    spec.create = true;
    return spec;
  }

  std::map<std::uint64_t, std::string> catalogues_;
  std::unique_ptr<SqlConnection> reader_;
  PostgresqlOutlet outlet_;
};

TEST(PostgresqlOutlet, AChannelIsThatOfThePresentCatalogue) {
  test::with_postgres([](test::PostgresServer& server) {
    Written written(server);
    const auto unit = [&] { return written.one("select unit from fieldcast.channels"); };
    const std::uint64_t bar = written.catalogue_in("bar"), mbar = written.catalogue_in("mbar");
    written.write_late(bar);
    EXPECT_EQ(unit(), "bar") << "the channel was not there";
    written.write_catalogue(mbar);
    EXPECT_EQ(unit(), "mbar");
    written.write_late(written.catalogue_in("hPa"));
    EXPECT_EQ(unit(), "mbar") << "late samples have an earlier catalogue";
    written.write_catalogue(bar);
    EXPECT_EQ(unit(), "bar") << "the configuration was restored";
    written.write_catalogue(mbar);
    EXPECT_EQ(unit(), "mbar");
  });
}

TEST(PostgresqlOutlet, HasEachStateOfAnAlarmAlsoARepeatedOne) {
  test::with_postgres([](test::PostgresServer& server) {
    Written written(server);
    for (const std::uint64_t number : {1u, 3u, 3u})
      written.write({.kind = RecordKind::kAlarm,
                     .bus = "line",
                     .device = "press",
                     .epoch = number,
                     .identity = identity_of(alarm()),
                     .body = encode("north", alarm())});
    EXPECT_EQ(written.one("select count(*)::text from fieldcast.alarms"), "2");
  });
}

TEST(PostgresqlConnection, TheServerIsCheckedByItsAuthority) {
  PostgresqlSpec spec;
  spec.user = "north/1";
  EXPECT_EQ(*connection_text(spec),
            "postgresql://north%2F1@127.0.0.1:5432/fieldcast?sslmode=prefer");
  spec.server = "/run/postgresql";
  spec.authority = "/etc/ca.pem";
  EXPECT_EQ(*connection_text(spec),
            "postgresql://north%2F1@%2Frun%2Fpostgresql/fieldcast?sslmode=verify-full&sslrootcert="
            "%2Fetc%2Fca.pem");
  spec.password_file = "/nowhere";
  EXPECT_THAT(connection_text(spec).error(), HasSubstr("/nowhere"));
}

}  // namespace
}  // namespace fieldcast::forward
