#include "tools/station/live/live_domain.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstring>
#include <nlohmann/json.hpp>

#include "bridge/base/clock.hpp"
#include "tests/bridge/dds/dds_support.hpp"
#include "tests/tools/station/live/io_test.hpp"

namespace fieldcast::testing {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using web::LivePeer;

class Page : public LivePeer {
 public:
  explicit Page(boost::asio::io_context& io) : io_(io), timer_(io) {}
  void open(const web::MakeLiveProtocol& make, const std::string& user) {
    protocol = make({user, Role::kOperator, "10.0.0.7"}, *this);
    protocol->on_open(steady_now());
  }
  void send_text(std::string text) override { texts.push_back(json::parse(text)); }
  void send_binary(std::shared_ptr<const std::string> frame) override {
    std::uint32_t n = 0;
    std::memcpy(&n, frame->data() + 4, sizeof n);
    if (n != 0) frames.push_back(*frame);
    boost::asio::post(io_, [this] { protocol->on_taken(steady_now()); });
  }
  void wake_at(Instant when) override {
    timer_.expires_at(std::chrono::steady_clock::time_point(when.time_since_epoch()));
    timer_.async_wait([this](boost::system::error_code cancelled) {
      if (!cancelled) protocol->on_wake(steady_now());
    });
  }
  void close(std::string_view) override {}

  [[nodiscard]] json first(const std::string& kind) const {
    for (const json& text : texts) {
      if (text["kind"] == kind) return text;
    }
    return {};
  }

  std::vector<json> texts;
  std::vector<std::string> frames;
  std::unique_ptr<web::LiveProtocol> protocol;

 private:
  boost::asio::io_context& io_;
  boost::asio::steady_timer timer_;
};

struct LiveDomainTest : web::IoTest {
  [[nodiscard]] const web::LiveChannel* channel() const {
    return domain.model().find({bus, "d", "c0"});
  }

  const std::string bus = bus_name("live");
  web::LiveDomain domain{io, {DdsSite{{}, loopback()}}, "wall", "1.2.3"};
};

TEST_F(LiveDomainTest, WhatABridgePublishesIsAtThePage) {
  Obedient bridge(bus);
  Page page(io);
  page.open(domain.make_protocol(), "anna");
  page.protocol->on_text(R"({"subscribe":"*"})", steady_now());
  ASSERT_TRUE(run_until([&] { return channel() != nullptr; }));
  bridge.link.publish(bus, std::vector{good(0, 21.5)}, both_clocks());
  ASSERT_TRUE(run_until([&] {
    double value = 0;
    if (!page.frames.empty()) std::memcpy(&value, page.frames.back().data() + 16, sizeof value);
    return value == 21.5;
  }));
  EXPECT_EQ(channel()->last.quality, Quality::kGood);
}

TEST_F(LiveDomainTest, ACommandNamesItsPersonAndItsResultComesToItsPage) {
  Obedient bridge(bus);
  ASSERT_TRUE(run_until([&] { return channel() != nullptr; }));
  Page page(io);
  page.open(domain.make_protocol(), "anna");
  page.protocol->on_text(
      R"({"write":{"channel":")" + bus + R"(/d/c0","value":true,"verify":true},"id":7})",
      steady_now());
  ASSERT_TRUE(run_until([&] { return !page.first("result").is_null(); }));
  EXPECT_EQ(page.first("result")["id"], 7);
  EXPECT_EQ(page.first("result")["state"], "done");
  EXPECT_EQ(page.first("result")["value"], true);
  const Command taken = bridge.received.commands.all().back().second;
  EXPECT_THAT(taken.requester, ::testing::EndsWith("/anna"));
  EXPECT_EQ(taken.request_id, page.first("result")["request_id"]);
}

TEST_F(LiveDomainTest, AnInterestIsDeclaredWhileAPageIsOpen) {
  Obedient bridge(bus);
  ASSERT_TRUE(run_until([&] { return channel() != nullptr; }));
  Page page(io);
  page.open(domain.make_protocol(), "anna");
  page.protocol->on_text(R"({"subscribe":")" + bus + R"(/d/c0","refresh_ms":500})", steady_now());
  ASSERT_TRUE(run_until([&] { return bridge.received.interests.size() == 1; }));
  EXPECT_EQ(bridge.received.interests.all()[0].refresh, Duration{500ms});
  page.protocol->on_closed();
  ASSERT_TRUE(run_until([&] { return bridge.received.interests.size() == 2; }));
  EXPECT_FALSE(bridge.received.interests.all()[1].refresh);
}

TEST_F(LiveDomainTest, WhenABridgeEndsNothingOfItLooksFresh) {
  auto bridge = std::make_unique<Obedient>(bus);
  ASSERT_TRUE(run_until([&] { return channel() != nullptr; }));
  bridge->link.publish(bus, std::vector{good(0, 21.5)}, both_clocks());
  ASSERT_TRUE(run_until([&] { return channel()->last.quality == Quality::kGood; }));
  bridge.reset();
  ASSERT_TRUE(run_until([&] { return channel()->gone; }));
  EXPECT_EQ(channel()->last.quality, Quality::kUncertain);
  EXPECT_EQ(domain.model().count(), 0u);
}

}  // namespace
}  // namespace fieldcast::testing
