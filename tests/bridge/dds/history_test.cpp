#include "bridge/dds/topics/history.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bridge/dds/transport/domain.hpp"
#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast::testing {
namespace {

using namespace std::chrono_literals;

HistoryRequest request(const std::string& bus) {
  return {.bus = bus, .until = {1'000}, .rows = 1024, .channels = {{"d", "c0", {}, {}, {}}}};
}

TEST(History, AStationReceivesStoredSamplesAndRequestsTheNext) {
  const std::string bus = bus_name("history");
  Received received;
  auto handlers = received.handlers();
  Collected<HistoryRequest> requests;
  handlers.on_history = [&](HistoryRequest asked, const std::string& fault) {
    EXPECT_EQ(fault, "");
    requests.add(std::move(asked));
  };
  DdsLink link(loopback(), "test", std::move(handlers));
  link.add_bus(bus_of(bus, 1));
  EXPECT_NE(link.epoch_of(bus), 0u);
  EXPECT_EQ(link.epoch_of("unknown"), 0u);
  Station station(loopback(), "watcher");
  for (std::uint64_t i = 1; i <= 3; ++i) {
    HistoryResponse response{.complete = 1};
    for (std::uint64_t sequence = 1; sequence <= 1024; ++sequence)
      response.rows.push_back({.number = {i, sequence}, .value = 0.5, .quality = Quality::kGood});
    std::thread bridge([&] {
      EXPECT_TRUE(eventually([&] { return requests.size() >= i; }));
      if (requests.size() >= i) link.respond(requests.all()[i - 1], response);
    });
    const auto back = station.history(request(bus), 10s);
    bridge.join();
    ASSERT_TRUE(back) << to_text(back.error());
    EXPECT_EQ(back->rows, response.rows);
    if (i == 2) station.end_history();
  }
}

TEST(History, ARequestWithoutABridgeOrAResponseFailsAfterItsTime) {
  Station station(loopback(), "watcher");
  EXPECT_EQ(station.history(request("unknown"), 100ms).error(), StationFault::kNoBridge);
  Received received;
  auto handlers = received.handlers();
  handlers.on_history = [](const HistoryRequest&, const std::string&) {};
  DdsLink link(loopback(), "test", std::move(handlers));
  EXPECT_TRUE(eventually([&] {
    return station.history(request("unknown"), 500ms).error() == StationFault::kNoResult;
  }));
}

TEST(History, ABridgeThatJoinsWhileAStationWaitsIsFoundWithinTheWait) {
  Station station(loopback(), "watcher");
  Collected<HistoryRequest> requests;
  std::optional<HistoryResponse> back;
  std::thread waiting([&] {
    if (auto response = station.history(request("late"), 10s)) back = *std::move(response);
  });
  Received received;
  auto handlers = received.handlers();
  handlers.on_history = [&](HistoryRequest asked, const std::string&) {
    requests.add(std::move(asked));
  };
  DdsLink link(loopback(), "test", std::move(handlers));
  EXPECT_TRUE(eventually([&] { return requests.size() > 0; }));
  if (requests.size() > 0) link.respond(requests.all()[0], {.complete = 1});
  waiting.join();
  ASSERT_TRUE(back);
  EXPECT_EQ(back->complete, 1u);
}

TEST(History, AClosedLinkWritesNoFurtherBlocks) {
  Received received;
  auto handlers = received.handlers();
  Collected<HistoryRequest> requests;
  handlers.on_history = [&](HistoryRequest asked, const std::string&) {
    requests.add(std::move(asked));
  };
  DdsLink link(loopback(), "test", std::move(handlers));
  Station station(loopback(), "watcher");
  std::optional<StationFault> fault;
  std::thread waiting([&] {
    const auto back = station.history(request("any"), 3s);
    if (!back) fault = back.error();
  });
  EXPECT_TRUE(eventually([&] { return requests.size() > 0; }));
  link.close();
  if (requests.size() > 0) link.respond(requests.all()[0], {.complete = 1});
  waiting.join();
  EXPECT_EQ(fault, StationFault::kNoResult);
}

TEST(History, AHostileRequestArrivesWithItsFault) {
  Received received;
  auto handlers = received.handlers();
  Collected<std::string> faults;
  handlers.on_history = [&](const HistoryRequest&, std::string fault) {
    faults.add(std::move(fault));
  };
  DdsLink link(loopback(), "test", std::move(handlers));
  Domain other(loopback(), "other", nullptr);
  dds::DataWriter* const writer = other.writer(kHistoryRequestTopic, "other");
  idl::HistoryRequest hostile;
  hostile.requester() = "other";
  hostile.rows(4'000'000'000u);
  EXPECT_TRUE(eventually([&] {
    writer->write(&hostile);
    return faults.size() > 0;
  }));
  EXPECT_EQ(faults.all()[0], "rows must be from 1 to 1024");
}

}  // namespace
}  // namespace fieldcast::testing
