#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bridge/store/sql/schema.hpp"
#include "bridge/store/sql/sql.hpp"

namespace fieldcast {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(PostgresStore, SaysWhatIsWrongWithoutThePassword) {
  for (const std::string text :
       {"postgresql://ann:secret@127.0.0.1:1/db", "postgresql://ann:sec:ret@secret@127.0.0.1:1/db",
        "postgresql://ann@127.0.0.1:1/db?password=secret&connect_timeout=1",
        "postgresql://ann:secret@[broken"}) {
    try {
      (void)open_store(StoreAddress(text), IfMissing::kFail);
      ADD_FAILURE() << "opened " << text;
    } catch (const StoreError& error) {
      EXPECT_THAT(error.what(), HasSubstr("***"));
      EXPECT_THAT(error.what(), Not(HasSubstr("secret")));
    }
  }
}

TEST(StoreAddress, ShowsNoPassword) {
  EXPECT_EQ(StoreAddress("/var/lib/plant.db").masked(), "/var/lib/plant.db");
  EXPECT_EQ(StoreAddress("postgresql://ann@host/db").masked(), "postgresql://ann@host/db");
  EXPECT_EQ(StoreAddress("postgresql://ann:se/cr@et@host:5432/db").masked(),
            "postgresql://ann:***@host:5432/db");
  EXPECT_EQ(StoreAddress("postgres:///db?password=x&user=ann").masked(),
            "postgres:///db?password=***&user=ann");
  EXPECT_TRUE(StoreAddress("postgresql://ann:se/cret@host/db").is_ambiguous());
  EXPECT_FALSE(StoreAddress("postgresql://ann:se%2Fcret@host/db?user=a@b").is_ambiguous());
  EXPECT_TRUE(StoreAddress("postgres:///db").is_server());
  EXPECT_FALSE(StoreAddress("postgresql.db").is_server());
}

}  // namespace
}  // namespace fieldcast
