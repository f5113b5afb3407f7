#include "tools/station/stream/catalogue_cache.hpp"

#include <gtest/gtest.h>

#include "tests/tools/station/stream/stream_support.hpp"

namespace fieldcast::web {
namespace {

class CatalogueCacheTest : public testing::Test {
 protected:
  SharedCatalogue find(Instant now, std::uint64_t identity = 0x9f) {
    return cache_.find("north", "line", "press.1", identity, now, [this](const std::string& key) {
      ++reads_;
      key_ = key;
      return entry_;
    });
  }
  CatalogueCache cache_;
  tl::expected<std::string, EntryFault> entry_ =
      forward::encode("north", test::catalogue_of("line", {"a"}));
  std::string key_;
  int reads_ = 0;
};

TEST_F(CatalogueCacheTest, ACatalogueIsReadOnce) {
  const SharedCatalogue found = find({});
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->channels.at(0).path(), "north:line/press/a");
  EXPECT_EQ(key_, "north.line.press=2E1.9f");
  EXPECT_EQ(find({}), found);
  EXPECT_EQ(reads_, 1);
}

TEST_F(CatalogueCacheTest, AMissingOneIsRequestedAgainAfterAPause) {
  const auto present = entry_;
  entry_ = tl::make_unexpected(EntryFault::kMissing);
  EXPECT_EQ(find({}), nullptr);
  entry_ = present;
  EXPECT_EQ(find({}), nullptr);
  EXPECT_EQ(reads_, 1);
  EXPECT_NE(find(Instant{} + CatalogueCache::kMissing), nullptr);
}

TEST_F(CatalogueCacheTest, OneThatCouldNotBeReadIsRequestedAgainImmediately) {
  const auto present = entry_;
  entry_ = tl::make_unexpected(EntryFault::kUnavailable);
  EXPECT_EQ(find({}), nullptr);
  entry_ = present;
  EXPECT_NE(find({}), nullptr);
}

TEST_F(CatalogueCacheTest, OneThatWasReadWithOthersIsNotReadAgain) {
  EXPECT_TRUE(cache_.add("north.line.press=2E1.9f", *entry_));
  EXPECT_TRUE(cache_.add("north.line.mill.9f", "poison"));
  const SharedCatalogue found = find({});
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->channels.at(0).path(), "north:line/press/a");
  EXPECT_EQ(reads_, 0);
  EXPECT_TRUE(cache_.add("north.line.press=2E1.9f", *entry_));
  EXPECT_EQ(find({}), found) << "the known one stays";
}

TEST_F(CatalogueCacheTest, ThereIsALimitForThoseThatAreReadWithOthers) {
  const std::string large =
      forward::encode("north", test::catalogue_of("line", std::vector<std::string>(10'000, "a")));
  for (std::size_t i = 0; i < CatalogueCache::kMaxChannels / 10'000; ++i)
    EXPECT_TRUE(cache_.add("north.line.press.a" + std::to_string(i), large));
  EXPECT_FALSE(cache_.add("north.line.press=2E1.9f", *entry_));
  EXPECT_NE(find({}), nullptr);
  EXPECT_EQ(reads_, 1);
}

TEST_F(CatalogueCacheTest, AnEntryThatCannotBeDecodedIsMissing) {
  entry_ = "poison";
  EXPECT_EQ(find({}), nullptr);
}

}  // namespace
}  // namespace fieldcast::web
