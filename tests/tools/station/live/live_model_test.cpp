#include "tools/station/model/live_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/station/live/live_support.hpp"
#include "tools/station/live/frames.hpp"

namespace fieldcast::web {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> names(const std::vector<const LiveChannel*>& channels) {
  std::vector<std::string> found;
  for (const LiveChannel* channel : channels) found.push_back(channel->channel.channel);
  return found;
}

constexpr std::size_t kAll = 1000;

TEST(LiveModel, AChannelIsThereOnceItIsAnnounced) {
  LiveModel model;
  model.on_sample(sample_of("a", 1.0));
  EXPECT_EQ(model.find(path_of("a")), nullptr);
  EXPECT_EQ(model.counters().unknown, 1u);
  model.on_channel(channel_of("a"));
  ASSERT_NE(model.find(path_of("a")), nullptr);
  EXPECT_EQ(model.find(path_of("a"))->last.quality, Quality::kNotYetRead);
  model.on_sample(sample_of("a", 1.0));
  EXPECT_EQ(model.find(path_of("a"))->last.value, Value(1.0));
}

TEST(LiveModel, EachChangedChannelIsInTheListOnce) {
  LiveModel model;
  for (const char* name : {"a", "b", "c"}) model.on_channel(channel_of(name));
  for (const char* name : {"a", "b", "c", "a"}) model.on_sample(sample_of(name, 1.0));
  EXPECT_THAT(names(model.changed_since(0, kAll)), ElementsAre("b", "c", "a"));
  const std::uint64_t seen = model.version();
  EXPECT_THAT(model.changed_since(seen, kAll), IsEmpty());
  model.on_sample(sample_of("c", 2.0));
  EXPECT_THAT(names(model.changed_since(seen, kAll)), ElementsAre("c"));
}

TEST(LiveModel, ALimitGivesTheOldestChangesFirstAndTheRestLater) {
  LiveModel model;
  for (const char* name : {"a", "b", "c"}) {
    model.on_channel(channel_of(name));
    model.on_sample(sample_of(name, 1.0));
  }
  const auto first = model.changed_since(0, 2);
  EXPECT_THAT(names(first), ElementsAre("a", "b"));
  EXPECT_THAT(names(model.changed_since(first.back()->version, 2)), ElementsAre("c"));
}

TEST(LiveModel, AChannelThatIsRemovedIsUncertainImmediatelyAndLeavesTheCatalogue) {
  LiveModel model;
  model.on_channel(channel_of("a"));
  model.on_sample(sample_of("a", 7.0));
  const std::uint64_t version = model.version(), catalogue = model.catalogue_version();
  const std::uint32_t id = model.find(path_of("a"))->id;
  model.on_gone(path_of("a"));
  EXPECT_EQ(model.find(path_of("a"))->last.quality, Quality::kUncertain);
  EXPECT_EQ(model.find(path_of("a"))->last.value, Value(7.0));
  EXPECT_THAT(names(model.changed_since(version, kAll)), ElementsAre("a"));
  EXPECT_THAT(model.catalogue_since(catalogue).gone, ElementsAre(id));
  EXPECT_THAT(model.channels(), IsEmpty());
  model.on_sample(sample_of("a", 8.0));
  EXPECT_EQ(model.find(path_of("a"))->last.value, Value(7.0)) << "nobody announces it";
}

TEST(LiveModel, AGoodValueIsUncertainWhenTheNextOneIsOverdue) {
  using std::chrono::milliseconds;
  LiveModel model;
  model.on_channel(channel_of("a"));  // every 500 ms
  StationChannel rare = channel_of("b");
  rare.refresh = {};
  model.on_channel(rare);
  const Instant start{std::chrono::seconds{100}};
  model.on_sample(sample_of("a", 7.0), start);
  model.on_sample(sample_of("b", 7.0), start);
  const std::uint64_t seen = model.version();
  EXPECT_EQ(model.expire(start + milliseconds{3000}), 0u);
  EXPECT_EQ(model.expire(start + milliseconds{3001}), 1u);
  EXPECT_THAT(names(model.changed_since(seen, kAll)), ElementsAre("a"));
  EXPECT_EQ(model.find(path_of("a"))->last.quality, Quality::kUncertain);
  EXPECT_EQ(model.expire(start + milliseconds{9000}), 0u);
  EXPECT_EQ(model.find(path_of("b"))->last.quality, Quality::kGood) << "nothing is promised";
  model.on_sample(sample_of("a", 8.0), start + milliseconds{9000});
  EXPECT_EQ(model.find(path_of("a"))->last.quality, Quality::kGood);
}

TEST(LiveModel, AChannelThatComesBackHasItsId) {
  LiveModel model;
  model.on_channel(channel_of("a"));
  const std::uint32_t id = model.find(path_of("a"))->id;
  model.on_gone(path_of("a"));
  model.on_channel(channel_of("b"));
  const std::uint64_t catalogue = model.catalogue_version();
  model.on_channel(channel_of("a"));
  EXPECT_EQ(model.find(path_of("a"))->id, id);
  EXPECT_NE(model.find(path_of("b"))->id, id);
  EXPECT_THAT(names(model.catalogue_since(catalogue).changed), ElementsAre("a"));
  EXPECT_EQ(model.count(), 2u);
}

TEST(LiveModel, AnEntryThatDidNotChangeMakesNoVersion) {
  LiveModel model;
  model.on_channel(channel_of("a"));
  const std::uint64_t catalogue = model.catalogue_version();
  model.on_channel(channel_of("a"));
  EXPECT_EQ(model.catalogue_version(), catalogue);
  StationChannel changed = channel_of("a");
  changed.unit = "K";
  model.on_channel(changed);
  EXPECT_GT(model.catalogue_version(), catalogue);
}

TEST(LiveModel, AVersionOfAnotherProcessGetsEverything) {
  LiveModel model(1'000);
  model.on_channel(channel_of("a"));
  EXPECT_TRUE(model.catalogue_since(0).full);
  EXPECT_TRUE(model.catalogue_since(17).full);
  EXPECT_TRUE(model.catalogue_since(99'999).full);
  EXPECT_FALSE(model.catalogue_since(1'000).full);
  EXPECT_THAT(names(model.catalogue_since(1'000).changed), ElementsAre("a"));
}

TEST(LiveModel, AChannelThatIsRemovedForAMinuteIsForgotten) {
  using std::chrono::seconds;
  constexpr int kMany = 5'000;
  LiveModel model;
  FrameCache frames(model);
  LiveSubscription everything;
  ASSERT_TRUE(everything.add(*Pattern::parse("*")));
  model.on_channel(channel_of("stays"));
  for (int i = 0; i < kMany; ++i) {
    model.on_channel(channel_of("c" + std::to_string(i)));
    model.on_sample(sample_of("c" + std::to_string(i), 1.0), Instant{seconds{100}});
  }
  EXPECT_EQ(frames.frame(0, everything, Instant{seconds{100}}).channels, 5'000u);
  for (int i = 0; i < kMany; ++i) model.on_gone(path_of("c" + std::to_string(i)));
  const std::uint64_t catalogue = model.catalogue_version();
  model.expire(Instant{seconds{101}});
  frames.expire(Instant{seconds{101}});
  EXPECT_EQ(frames.kept(), 0u);
  const std::uint32_t id = model.find(path_of("c7"))->id;
  model.on_channel(channel_of("c7"));  // returns in time
  model.expire(Instant{seconds{160}});
  EXPECT_EQ(model.remembered(), 5'001u);
  model.expire(Instant{seconds{161}});
  EXPECT_EQ(model.remembered(), 2u);
  EXPECT_EQ(model.count(), 2u);
  EXPECT_EQ(model.counters().forgotten, 4'999u);
  EXPECT_EQ(model.find(path_of("c7"))->id, id);
  EXPECT_EQ(model.find(path_of("c8")), nullptr);
  EXPECT_FALSE(model.catalogue_since(catalogue).full) << "it has been seen that they are gone";
  EXPECT_TRUE(model.catalogue_since(1).full);
  model.on_channel(channel_of("c8"));
  EXPECT_GT(model.find(path_of("c8"))->id, 5'001u) << "an id is never given twice";
  model.on_gone(path_of("c7"));
  model.expire(Instant{seconds{162}});
  model.expire(Instant{seconds{221}});
  EXPECT_EQ(model.remembered(), 3u) << "its minute begins when it is gone again";
}

TEST(LiveModel, NotAllIsForgottenInOneTurn) {
  LiveModel model;
  constexpr std::size_t kMore = LiveModel::kMostForgotten + 1;
  for (std::size_t i = 0; i < kMore; ++i) model.on_channel(channel_of(std::to_string(i)));
  for (std::size_t i = 0; i < kMore; ++i) model.on_gone(path_of(std::to_string(i)));
  const Instant start{std::chrono::seconds{100}};
  model.expire(start);
  model.expire(start + LiveModel::kRemembered);
  EXPECT_EQ(model.remembered(), 1u);
  model.expire(start + LiveModel::kRemembered);
  EXPECT_EQ(model.remembered(), 0u);
}

TEST(LiveModel, AFullModelForgetsWhatIsRemovedAndNeverGivesAnIdTwice) {
  LiveModel model(0, 2);
  model.on_channel(channel_of("a"));
  model.on_channel(channel_of("b"));
  model.on_channel(channel_of("c"));
  EXPECT_EQ(model.find(path_of("c")), nullptr);
  EXPECT_EQ(model.counters().refused, 1u);
  const std::uint32_t id = model.find(path_of("a"))->id;
  const std::uint64_t before = model.catalogue_version();
  model.on_gone(path_of("a"));
  model.on_channel(channel_of("c"));
  ASSERT_NE(model.find(path_of("c")), nullptr);
  EXPECT_EQ(model.find(path_of("a")), nullptr);
  EXPECT_NE(model.find(path_of("c"))->id, id);
  EXPECT_TRUE(model.catalogue_since(before).full) << "that 'a' is gone is not known any more";
}

}  // namespace
}  // namespace fieldcast::web
