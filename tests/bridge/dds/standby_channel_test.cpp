// Tests that a standby member receives a second one that was killed and restarted, over real DDS on
// loopback. The old participant of the killed one has not expired yet.
#include "bridge/dds/endpoints/standby_channel.hpp"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <utility>

#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast::testing {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

struct Member {
  Member(const std::string& name, std::int64_t since) {
    told.group = "g";
    told.member.bridge = name;
    told.member.since = since;
    StandbyChannelHandlers handlers;
    handlers.member = [this](const StandbyMessage& message) {
      const std::lock_guard lock(mutex);
      heard[message.member.bridge] = message.member.since;
    };
    handlers.lost = [this](const std::string& bridge) { lost.add(bridge); };
    handlers.note = [](const auto&) {};
    handlers.request = [](const auto&) {};
    channel =
        std::make_unique<StandbyChannel>(*domain, name, "g", UtcTime{since}, std::move(handlers));
  }
  void tell() {
    ++told.member.beat;
    channel->tell(told);
  }
  std::int64_t life_of(const std::string& bridge) {
    const std::lock_guard lock(mutex);
    return heard[bridge];
  }

  std::mutex mutex;
  std::map<std::string, std::int64_t> heard;
  Collected<std::string> lost;
  StandbyMessage told;
  std::unique_ptr<Domain> domain = std::make_unique<Domain>(loopback(), "member", nullptr);
  std::unique_ptr<StandbyChannel> channel;
};

// Both ways, because DDS prefers the lower identity of two writers of equal strength.
TEST(StandbyChannel, AMemberThatRestartedIsHeardBeforeItsLifeBeforeIsGivenUp) {
  Member listener("listener", 1 * kSecond);
  Member one("a", 100 * kSecond), other("a", 200 * kSecond);
  Member third("b", 200 * kSecond), fourth("b", 100 * kSecond);
  struct Lives {
    Member *before, *now;
  };
  for (const Lives& lives : {Lives{&one, &other}, Lives{&fourth, &third}}) {
    Member *const before = lives.before, *const now = lives.now;
    const std::string name = now->told.member.bridge;
    EXPECT_TRUE(eventually([&] {
      before->tell();
      return listener.life_of(name) == 100 * kSecond;
    }));
    EXPECT_TRUE(eventually([&] {
      now->tell();
      return listener.life_of(name) == 200 * kSecond;
    })) << name;
    // Now the old one expires, and the new one is present.
    before->channel.reset();
    before->domain.reset();
    now->told.member.since = 201 * kSecond;
    EXPECT_TRUE(eventually([&] {
      now->tell();
      return listener.life_of(name) == 201 * kSecond;
    }));
  }
  EXPECT_EQ(listener.lost.size(), 0u);
  other.channel.reset();
  EXPECT_TRUE(eventually([&] { return listener.lost.size() == 1; }));
  EXPECT_EQ(listener.lost.all().front(), "a");
}

}  // namespace
}  // namespace fieldcast::testing
