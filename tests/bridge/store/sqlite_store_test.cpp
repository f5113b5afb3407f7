#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "bridge/store/retention.hpp"
#include "tests/bridge/store/older_store.hpp"
#include "tests/bridge/store/scratch.hpp"
#include "tests/bridge/store/store_support.hpp"

namespace fieldcast::test {
namespace {

using std::chrono::seconds;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(SqliteStore, ThatANewerProgramMadeIsRefused) {
  const Scratch scratch;
  const StoreAddress address(scratch.path("store.db"));
  open_store(address, IfMissing::kCreate)
      ->script("update fieldcast_version set version = version + 1");
  try {
    (void)open_store(address, IfMissing::kFail);
    FAIL() << "it was opened";
  } catch (const StoreError& error) {
    EXPECT_THAT(
        error.what(),
        HasSubstr("a newer Fieldcast made it (version " + std::to_string(present_version() + 1) +
                  ", this one knows " + std::to_string(present_version()) + ")"));
  }
}

TEST(SqliteStore, IsBroughtToThePresentVersionOnce) {
  const Scratch scratch;
  const StoreAddress address(scratch.path("store.db"));
  for (int i = 0; i < 2; ++i) {
    const auto connection = open_store(address, IfMissing::kCreate);
    std::vector<std::int64_t> versions;
    connection->query("select version from fieldcast_version", {}, [&](const SqlRow& row) {
      versions.push_back(integer_at(row, 0));
      return true;
    });
    EXPECT_THAT(versions, ElementsAre(present_version()));
  }
}

TEST(SqliteStore, OfAnOlderProgramKeepsItsSamplesWithoutATypeUntilTheChannelComesAgain) {
  const Scratch scratch;
  const StoreAddress address(scratch.path("store.db"));
  const auto put_one = [&](std::int64_t second) {
    Store store(forever(address));
    const Sample one[] = {sample(0, 0.5, second)};
    store.intake(bus_of("b", {"c"}))->put(one, kClock, utc(second));
    ASSERT_TRUE(store.flush(seconds{30}));
  };
  put_one(1);
  back_to_version(*open_store(address, IfMissing::kFail), 1);
  ASSERT_EQ(history(address, "b").size(), 1u);
  EXPECT_EQ(history(address, "b")[0].type, "");
  put_one(2);
  ASSERT_EQ(history(address, "b").size(), 2u);
  EXPECT_EQ(history(address, "b")[0].type, "float32");
}

TEST(SqliteStore, WhatIsNotADatabaseIsRefusedAndLeftAlone) {
  const Scratch scratch;
  const std::string path = scratch.path("notes.txt");
  const std::string text(5000, 'x');
  std::ofstream(path) << text;
  EXPECT_THROW((void)open_store(StoreAddress(path), IfMissing::kCreate), StoreError);
  std::ifstream file(path);
  EXPECT_EQ(std::string((std::istreambuf_iterator<char>(file)), {}), text);
}

TEST(SqliteStore, ThatIsTooLargeLosesItsOldestSamples) {
  const Scratch scratch;
  const StoreAddress address(scratch.path("store.db"));
  {
    Store store(forever(address));
    const auto intake = store.intake(bus_of("full", {"a"}));
    for (int second = 0; second < 20'000; ++second) {
      const Sample one[] = {sample(0, std::string(100, 'x'), second, 1)};
      intake->put(one, kClock, utc(second));
    }
    ASSERT_TRUE(store.flush(seconds{60}));
  }
  StoreSpec spec;
  spec.keep = {};
  spec.max_bytes = 1'000'000;
  Retention retention(spec);
  const auto connection = open_store(address, IfMissing::kFail);
  write_tiers(*connection);
  int steps = 0;
  while (retention.step(*connection, instant(0), utc(20'000))) ASSERT_LT(++steps, 10'000);
  const auto left = history(address, "full");
  EXPECT_GT(left.size(), 2'000u);
  EXPECT_LT(left.size(), 9'000u) << "of 100 bytes and more in a megabyte";
  EXPECT_EQ(left.back().published_at, utc(19'999)) << "the newest stay";
}

TEST(SqliteStore, GivesTheSpaceOfRemovedSamplesBackToTheDisk) {
  const Scratch scratch;
  const StoreAddress address(scratch.path("store.db"));
  (void)open_store(address, IfMissing::kCreate);
  const auto empty = std::filesystem::file_size(address.text());
  {
    Store store(forever(address));
    const auto intake = store.intake(bus_of("shrinks", {"a"}));
    for (int second = 0; second < 20'000; ++second) {
      const Sample one[] = {sample(0, std::string(200, 'x'), second, 1)};
      intake->put(one, kClock, utc(second));
    }
    ASSERT_TRUE(store.flush(seconds{60}));
  }
  const auto connection = open_store(address, IfMissing::kFail);
  const auto bytes = [&] {
    connection->script("pragma wal_checkpoint(truncate)");
    return std::filesystem::file_size(address.text()) - empty;
  };
  write_tiers(*connection);
  const auto before = bytes();
  StoreSpec spec;
  spec.keep = seconds{2000};
  Retention retention(spec);
  int steps = 0;
  while (retention.step(*connection, instant(0), utc(20'000))) ASSERT_LT(++steps, 10'000);
  EXPECT_EQ(history(address, "shrinks").size(), 2'000u);
  EXPECT_LT(bytes(), before / 4);
}

}  // namespace
}  // namespace fieldcast::test
