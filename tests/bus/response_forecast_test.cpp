#include "core/bus/wire/response_forecast.hpp"

#include <gtest/gtest.h>

#include "core/protocol/families/registry.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

const LineFormat kForecastLine{19200, 8, Parity::kEven, 1};
const Bytes kExactResponse{0x01, 0x03, 0x02, 0x00, 0x2A, 0x39, 0x9B};
constexpr Duration kEarliest = 2ms;

struct Forecast {
  // Exchanges of one register each; the response arrives whole, `more` bytes follow it.
  void exchange(const Bytes& more = {}) {
    send();
    Bytes received = kExactResponse;
    append(received, more);
    receive(received);
    if (!driver.active()) return;
    forecast.ended(driver, true);
    driver.finish();
  }
  void send(bool owed = false) {
    forecast.begin(owed);
    driver.begin(protocol->begin(ReadRequest{{{2, 100, 1}}}, {1}), 200ms, EqualBytes::kEcho, now,
                 out);
    end = driver.sent_until() + kForecastLine.characters(7);
  }
  void receive(const Bytes& bytes) { (void)driver.on_bytes(bytes, now += 20ms, out); }
  void trust() {
    for (unsigned i = 0; i <= ResponseForecast::kTrusted; ++i) exchange();
  }
  [[nodiscard]] Instant quiet_until() const { return forecast.quiet_until(driver, kEarliest); }

  std::unique_ptr<Protocol> protocol = std::move(*find_protocol("modbus-rtu")->make({1, {}}));
  ExchangeDriver driver{kForecastLine, 20ms, Echo::kAbsent};
  ResponseForecast forecast;
  Instant now{}, end{};
  Bytes out;
};

TEST(ResponseForecast, AtFirstTheLineIsReadBeforeAnEarlyResponseCanBeWhole) {
  Forecast bus;
  bus.send();
  EXPECT_LE(bus.quiet_until(), bus.end - kForecastLine.characters(3));
  EXPECT_GT(bus.quiet_until(), bus.driver.sent_until());
}

TEST(ResponseForecast, AfterExactResponsesTheLineIsReadWhenTheResponseIsWhole) {
  Forecast bus;
  bus.trust();
  bus.send();
  EXPECT_GE(bus.quiet_until(), bus.end + kEarliest);
  EXPECT_LE(bus.quiet_until(), bus.end + kEarliest + ResponseForecast::kLatest);
}

TEST(ResponseForecast, SomeResponsesAreReadEarlyToMeasureTheirTime) {
  Forecast bus;
  bus.trust();
  unsigned early = 0;
  for (unsigned i = 0; i < 10 * ResponseForecast::kMeasured; ++i) {
    bus.send();
    early += bus.quiet_until() < bus.end ? 1 : 0;
    bus.receive(kExactResponse);
    bus.forecast.ended(bus.driver, true);
    bus.driver.finish();
  }
  EXPECT_EQ(early, 10u);
}

TEST(ResponseForecast, UnexpectedBytesAndFailuresEndTheTrust) {
  const auto is_early_after = [](auto doubt) {
    Forecast bus;
    bus.trust();
    doubt(bus);
    bus.send();
    return bus.quiet_until() < bus.end;
  };
  EXPECT_FALSE(is_early_after([](Forecast&) {}));
  EXPECT_TRUE(is_early_after([](Forecast& bus) { bus.forecast.doubt(); }));
  EXPECT_TRUE(is_early_after([](Forecast& bus) { bus.exchange({0x01}); }));
  EXPECT_TRUE(is_early_after([](Forecast& bus) {
    bus.send();
    bus.forecast.ended(bus.driver, false);
    bus.driver.abort();
  }));
}

TEST(ResponseForecast, WhileAResponseIsOwedTheLineIsReadEarly) {
  Forecast bus;
  bus.trust();
  bus.send(true);
  EXPECT_LT(bus.quiet_until(), bus.end);
}

TEST(ResponseForecast, BytesBehindAResponseThatWasReadLateShowThatItBeganTooEarly) {
  Forecast bus;
  bus.send();
  Bytes two = kExactResponse;
  append(two, kExactResponse);
  bus.receive(two);
  EXPECT_FALSE(bus.forecast.too_early(bus.driver)) << "it was read as it arrived";
  bus.driver.finish();
  bus.trust();
  bus.send();
  bus.receive(kExactResponse);
  EXPECT_FALSE(bus.forecast.too_early(bus.driver));
  bus.driver.finish();
  bus.send();
  bus.receive(two);
  EXPECT_TRUE(bus.forecast.too_early(bus.driver));
}

TEST(ResponseForecast, OfALineThatDoesNotKeepItsRateNothingIsForecast) {
  Forecast bus;
  bus.trust();
  bus.send();
  EXPECT_EQ(bus.forecast.quiet_until(bus.driver, std::nullopt), kLongAgo);
}

TEST(ResponseForecast, ARefusalIsNotDelayedByTheLengthOfTheResponse) {
  Forecast bus;
  bus.trust();
  bus.forecast.begin(false);
  bus.driver.begin(bus.protocol->begin(ReadRequest{{{2, 100, 120}}}, {1}), 200ms, EqualBytes::kEcho,
                   bus.now, bus.out);
  EXPECT_EQ(bus.quiet_until(), bus.now + ResponseForecast::kLongest);
}

TEST(ResponseForecast, AtFirstTheLineIsReadBeforeTheRestOfAResponseIsWhole) {
  Forecast bus;
  bus.forecast.begin(false);
  bus.driver.begin(bus.protocol->begin(ReadRequest{{{2, 100, 40}}}, {1}), 200ms, EqualBytes::kEcho,
                   bus.now, bus.out);
  bus.receive({0x01, 0x03, 80, 0x00});
  EXPECT_EQ(bus.quiet_until(), bus.now + kForecastLine.characters(81) -
                                   kForecastLine.characters(1) - ResponseForecast::kEarlyWake);
}

TEST(ResponseForecast, TheRestOfAResponseIsForecastFromItsFirstBytes) {
  Forecast bus;
  bus.trust();
  bus.forecast.begin(false);
  bus.driver.begin(bus.protocol->begin(ReadRequest{{{2, 100, 40}}}, {1}), 200ms, EqualBytes::kEcho,
                   bus.now, bus.out);
  bus.receive({0x01, 0x03, 80, 0x00});
  EXPECT_GT(bus.quiet_until(), bus.now + kForecastLine.characters(70));
  EXPECT_LE(bus.quiet_until(), bus.now + kForecastLine.characters(81) + ResponseForecast::kLatest);
}

}  // namespace
}  // namespace fieldcast
