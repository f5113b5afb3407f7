// Tests every transition of the state diagram of ISA-18.2 and every pair of states without one.
#include "core/alarm/alarm_life.hpp"

#include <gtest/gtest.h>

#include <map>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using enum IsaState;
using enum IsaInput;

constexpr IsaState kStates[] = {kNormal,   kUnacknowledged, kAcknowledged,
                                kReturned, kShelved,        kOutOfService};
constexpr IsaInput kInputs[] = {kOccurs,
                                kReturns,
                                kAcknowledge,
                                kShelve,
                                kUnshelveInAlarm,
                                kUnshelveNormal,
                                kRemoveFromService,
                                kReturnToServiceInAlarm,
                                kReturnToServiceNormal,
                                kReturnToServiceShelved};

// A second copy of the diagram, written independently of the table: for each state, its exits.
TEST(AlarmLife, HasTheTransitionsOfTheStandardAndNoOther) {
  const std::map<std::pair<IsaState, IsaInput>, IsaState> expected = {
      {{kNormal, kOccurs}, kUnacknowledged},
      {{kNormal, kShelve}, kShelved},
      {{kNormal, kRemoveFromService}, kOutOfService},
      {{kUnacknowledged, kReturns}, kReturned},
      {{kUnacknowledged, kAcknowledge}, kAcknowledged},
      {{kUnacknowledged, kShelve}, kShelved},
      {{kUnacknowledged, kRemoveFromService}, kOutOfService},
      {{kAcknowledged, kReturns}, kNormal},
      {{kAcknowledged, kShelve}, kShelved},
      {{kAcknowledged, kRemoveFromService}, kOutOfService},
      {{kReturned, kOccurs}, kUnacknowledged},
      {{kReturned, kAcknowledge}, kNormal},
      {{kReturned, kShelve}, kShelved},
      {{kReturned, kRemoveFromService}, kOutOfService},
      {{kShelved, kUnshelveInAlarm}, kUnacknowledged},
      {{kShelved, kUnshelveNormal}, kNormal},
      {{kShelved, kRemoveFromService}, kOutOfService},
      {{kOutOfService, kReturnToServiceInAlarm}, kUnacknowledged},
      {{kOutOfService, kReturnToServiceNormal}, kNormal},
      {{kOutOfService, kReturnToServiceShelved}, kShelved},
  };
  for (const IsaState state : kStates) {
    for (const IsaInput input : kInputs) {
      const auto row = expected.find({state, input});
      EXPECT_EQ(next_state(state, input),
                row == expected.end() ? std::nullopt : std::optional(row->second))
          << static_cast<int>(state) << ' ' << static_cast<int>(input);
    }
  }
  EXPECT_EQ(isa_transitions().size(), expected.size());
  for (const IsaTransition& each : isa_transitions()) EXPECT_FALSE(each.name.empty());
}

constexpr UtcTime utc(Duration since_begin) { return {1'000'000'000'000 + since_begin.count()}; }
AlarmPause pause(Duration begin, Duration end) { return {"bert", "wait", utc(begin), utc(end)}; }

// An alarm in each state, reached by normal transitions; active or not where possible.
struct Case {
  const char* name;
  IsaState state;
  bool active;
};
constexpr Case kLives[] = {{"normal", kNormal, false},
                           {"unacknowledged", kUnacknowledged, true},
                           {"acknowledged", kAcknowledged, true},
                           {"returned", kReturned, false},
                           {"shelved", kShelved, false},
                           {"shelved in alarm", kShelved, true},
                           {"out of service", kOutOfService, false},
                           {"out of service in alarm", kOutOfService, true}};

AlarmLife life_in(const Case& sample) {
  AlarmLife life(AlarmPriority::kHigh);
  if (sample.active || sample.state == kReturned) life.raise(95, utc(0s), utc(0s));
  if (sample.state == kReturned) life.clear(80, utc(1s));
  if (sample.state == kAcknowledged) {
    EXPECT_TRUE(life.acknowledge({"anna", "seen", utc(1s)}, {}));
  }
  if (sample.state == kShelved) life.shelve(pause(1s, 1h));
  if (sample.state == kOutOfService) life.suppress(pause(1s, 1h));
  EXPECT_EQ(life.state(), sample.state) << sample.name;
  EXPECT_EQ(life.status().active, sample.active) << sample.name;
  return life;
}

TEST(AlarmLife, OccursOnceAndReturnsOnce) {
  for (const Case& sample : kLives) {
    SCOPED_TRACE(sample.name);
    AlarmLife life = life_in(sample);
    const AlarmStatus before = life.status();
    if (sample.active) {
      life.raise(99, utc(5s), utc(5s));
      EXPECT_EQ(life.status(), before) << "it was active before";
      life.clear(70, utc(6s));
      EXPECT_FALSE(life.status().active);
      EXPECT_EQ(life.status().cleared_at, utc(6s));
      EXPECT_EQ(life.status().raised_at, utc(0s));
    } else {
      life.clear(70, utc(6s));
      EXPECT_EQ(life.status(), before) << "it was clear before";
      life.raise(99, utc(5s), utc(5s));
      EXPECT_TRUE(life.status().active);
      EXPECT_EQ(life.status().raised_at, utc(5s));
      EXPECT_EQ(life.status().cleared_at, UtcTime{});
      EXPECT_EQ(life.status().acknowledged, AlarmNote{}) << "of the occurrence before";
    }
    const bool away = sample.state == kShelved || sample.state == kOutOfService;
    EXPECT_TRUE(!away || life.state() == sample.state) << "what is away stays away";
  }
}

TEST(AlarmLife, IsAcknowledgedWhileItIsActiveAndAfterwardsAndNeverTwice) {
  for (const Case& sample : kLives) {
    SCOPED_TRACE(sample.name);
    AlarmLife life = life_in(sample);
    const AlarmStatus before = life.status();
    const auto done = life.acknowledge({"chen", "on my way", utc(5s)}, {});
    EXPECT_EQ(done.has_value(), sample.state == kUnacknowledged || sample.state == kReturned);
    if (done) {
      EXPECT_EQ(life.state(), sample.active ? kAcknowledged : kNormal);
      EXPECT_EQ(life.status().acknowledged, (AlarmNote{"chen", "on my way", utc(5s)}));
    } else {
      EXPECT_EQ(life.status(), before);
      EXPECT_EQ(done.error().cause, Cause::kWrongState);
      EXPECT_FALSE(done.error().reason.empty());
    }
  }
}

TEST(AlarmLife, AnAcknowledgementIsOfTheOccurrenceThatThePersonSaw) {
  AlarmLife life(AlarmPriority::kHigh);
  life.raise(95, utc(0s), utc(0s));
  life.clear(80, utc(1s));
  life.raise(96, utc(2s), utc(2s));
  EXPECT_FALSE(life.acknowledge({"anna", "", utc(3s)}, utc(0s)));
  EXPECT_EQ(life.state(), kUnacknowledged);
  EXPECT_TRUE(life.acknowledge({"anna", "", utc(3s)}, utc(2s)));
}

TEST(AlarmLife, WhatComesBackIsUnacknowledgedIfItsLimitIsPassed) {
  for (const Case& sample : kLives) {
    if (sample.state == kOutOfService || sample.state == kShelved) continue;
    SCOPED_TRACE(sample.name);
    for (const bool service : {false, true}) {
      AlarmLife life = life_in(sample);
      service ? life.suppress(pause(2s, 1h)) : life.shelve(pause(2s, 1h));
      EXPECT_EQ(life.state(), service ? kOutOfService : kShelved);
      if (service) {
        life.end_suppression();
      } else {
        EXPECT_TRUE(life.unshelve());
        EXPECT_FALSE(life.unshelve()) << "it is not shelved any more";
      }
      EXPECT_EQ(life.state(), sample.active ? kUnacknowledged : kNormal);
      EXPECT_FALSE(life.status().shelved.is_set() || life.status().suppressed.is_set());
    }
  }
}

TEST(AlarmLife, MaintenanceEndsIntoAShelvingThatGoesOn) {
  AlarmLife life = life_in({"unacknowledged", kUnacknowledged, true});
  life.shelve(pause(1s, 1h));
  life.suppress(pause(2s, 2h));
  EXPECT_EQ(life.state(), kOutOfService);
  life.suppress(pause(2s, 3h));  // longer than the first time
  life.end_suppression();
  EXPECT_EQ(life.state(), kShelved);
  life.suppress(pause(2s, 2h));
  EXPECT_TRUE(life.unshelve());  // for example by time
  EXPECT_EQ(life.state(), kOutOfService);
  life.end_suppression();
  EXPECT_EQ(life.state(), kUnacknowledged);
}

TEST(AlarmLife, ChattersFromFiveOccurrencesOnUntilTwoAreLeft) {
  AlarmLife life(AlarmPriority::kLow);
  const auto occurs = [&](Duration when) {
    life.raise(95, utc(when), utc(when));
    life.clear(80, utc(when + 1s));
  };
  for (int minute = 0; minute < 4; ++minute) occurs(minute * 1min);
  EXPECT_EQ(life.status().occurrences, 4u);
  EXPECT_FALSE(life.status().chattering);
  occurs(4min);
  EXPECT_TRUE(life.status().chattering);
  EXPECT_TRUE(life.count(utc(11min)));  // occurrences of minutes 0 and 1 are too old
  EXPECT_EQ(life.status().occurrences, 3u);
  EXPECT_TRUE(life.status().chattering);
  EXPECT_FALSE(life.count(utc(11min + 1s)));
  EXPECT_TRUE(life.count(utc(12min)));
  EXPECT_EQ(life.status().occurrences, 2u);
  EXPECT_FALSE(life.status().chattering);
  EXPECT_TRUE(life.count(utc(1h)));
  EXPECT_EQ(life.status().occurrences, 0u);
}

TEST(AlarmLife, OccurrencesAreCountedUpToABound) {
  AlarmLife life(AlarmPriority::kLow);
  for (int i = 0; i < 5000; ++i) {
    life.raise(95, utc(i * 1ms), utc(i * 1ms));
    life.clear(80, utc(i * 1ms));
  }
  EXPECT_EQ(life.status().occurrences, AlarmLife::kMaxCounted);
}

TEST(AlarmLife, OfTheKeptOccurrencesTheNewestAreCounted) {
  std::vector<UtcTime> occurrences;
  for (std::size_t i = 0; i < AlarmLife::kMaxCounted + 500; ++i)
    occurrences.push_back(utc(static_cast<int>(i) * 100ms));
  AlarmLife life(AlarmPriority::kLow);
  life.restore({}, occurrences, utc(150s));
  EXPECT_EQ(life.status().occurrences, AlarmLife::kMaxCounted);
  EXPECT_TRUE(life.status().chattering);
  EXPECT_FALSE(life.count(utc(10min + 49'900ms))) << "the first 500 are not counted";
  EXPECT_TRUE(life.count(utc(10min + 50s)));
  EXPECT_EQ(life.status().occurrences, AlarmLife::kMaxCounted - 1);
}

TEST(AlarmLife, GoesOnAsItWasKept) {
  for (const Case& sample : kLives) {
    SCOPED_TRACE(sample.name);
    const AlarmLife before = life_in(sample);
    AlarmLife after(AlarmPriority::kHigh);
    std::vector<UtcTime> occurrences;
    if (before.status().occurrences > 0) occurrences = {utc(0s)};
    after.restore(before.status(), occurrences, utc(10s));
    EXPECT_EQ(after.state(), before.state());
    EXPECT_EQ(after.status(), before.status());
  }
}

}  // namespace
}  // namespace fieldcast
