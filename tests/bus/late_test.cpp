#include <gtest/gtest.h>

#include <algorithm>

#include "config/loader/loader.hpp"
#include "core/bus/wire/pending_responses.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/bus/late_storm.hpp"
#include "tools/sim/check/requests.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

const StormKind& kind_named(std::string_view name) {
  const auto kinds = storm_kinds();
  return *std::find_if(kinds.begin(), kinds.end(),
                       [&](const StormKind& kind) { return kind.name == name; });
}

// The response arrives after the timeout and is matched to the retry. The response to the retry
// arrives during the next request.
TEST(LateResponse, BeyondTheTimeoutIsNotAResponseToTheNextRequest) {
  const StormKind& kind = kind_named("modbus-rtu");
  const BusSpec spec = bus_of(kind, "200ms");
  LateStorm storm(kind, spec, faults_of(spec, {.late = 0.05, .by = 250ms}), 1);
  storm.run(20'000);
  const auto counts = storm.counts();
  EXPECT_GT(counts.late, 100u);
  EXPECT_GT(counts.good, 10'000u);
  EXPECT_EQ(counts.wrong, 0u) << counts.first_wrong;
}

// The delay is within the configured timeout, but so rare that the learned timeout is now shorter.
// The retry accepts the response, and its own response arrives during the next request.
TEST(LateResponse, BeyondWhatWasLearnedIsNotAResponseToTheNextRequest) {
  StormKind kind = kind_named("modbus-rtu");
  kind.devices = 1;  // the next request is to the same unit
  const BusSpec spec = bus_of(kind, "200ms");
  LateStorm storm(kind, spec, faults_of(spec, {.late = 0.003, .by = 150ms}), 1);
  Duration lowest = Duration::max();
  for (int i = 0; i < 400; ++i) {
    storm.run(100);
    const auto report = storm.bus().engine().device_report(0, storm.bus().now());
    lowest = std::min(lowest, report.timeout);
  }
  const auto counts = storm.counts();
  EXPECT_LT(lowest, 100ms) << "it never fell: nothing was tried";
  EXPECT_GT(counts.late, 100u);
  EXPECT_GT(storm.bus().engine().device_report(0, storm.bus().now()).retries, 20u)
      << "no response came after the learned timeout";
  EXPECT_EQ(counts.wrong, 0u) << counts.first_wrong;
}

// Regression: each of these runs published wrong values. A late response was counted twice, so the
// response that was still pending was matched to another request.
struct Seeded {
  std::string kind;
  Duration by;
  std::uint64_t seed;
  friend void PrintTo(const Seeded& of, std::ostream* out) { *out << of.kind << ' ' << of.seed; }
};
class LateResponseTwice : public testing::TestWithParam<Seeded> {};

TEST_P(LateResponseTwice, PaysOnce) {
  const StormKind& kind = kind_named(GetParam().kind);
  const BusSpec spec = bus_of(kind, "200ms");
  const StormFaults faults{.late = 0.05, .by = GetParam().by, .doubled = 0.02, .foreign = 0.2};
  LateStorm storm(kind, spec, faults_of(spec, faults), GetParam().seed);
  storm.run(20'000);
  EXPECT_EQ(storm.counts().wrong, 0u) << storm.counts().first_wrong;
}

INSTANTIATE_TEST_SUITE_P(Storms, LateResponseTwice,
                         testing::Values(Seeded{"modbus-rtu", 560ms, 14}, Seeded{"dtc", 450ms, 13},
                                         Seeded{"modbus-rtu-declared", 450ms, 20}),
                         [](const auto& chosen) {
                           std::string name = chosen.param.kind;
                           std::erase_if(name, [](char c) { return !std::isalnum(c); });
                           return name;
                         });

// The operating system or an adapter delivers bytes late, so that the repetition of a response
// arrives behind the next request, at a time when its response is possible.
class RepeatedResponses : public testing::TestWithParam<std::tuple<std::string, int, int>> {};

TEST_P(RepeatedResponses, AreNeverTheResponseOfTheNextRequest) {
  const auto& [name, longest, seed] = GetParam();
  const StormKind& kind = kind_named(name);
  const BusSpec spec = bus_of(kind, "200ms");
  LateStorm storm(kind, spec, faults_of(spec, {.late = 0, .doubled = 0.05}),
                  static_cast<std::uint64_t>(seed));
  storm.bus().delay_received(std::chrono::milliseconds{longest}, static_cast<std::uint64_t>(seed));
  storm.run(5'000);
  const auto counts = storm.counts();
  EXPECT_EQ(counts.wrong, 0u) << counts.first_wrong;
  EXPECT_GT(counts.doubled, 150u);
  for (std::size_t c = 0; c < storm.good_of_channels().size(); ++c)
    EXPECT_GT(storm.good_of_channels()[c], 20u) << "channel " << c << " starves";
}

INSTANTIATE_TEST_SUITE_P(Delays, RepeatedResponses,
                         testing::Combine(testing::Values("modbus-rtu", "modbus-ascii",
                                                          "omron-hostlink C-mode", "dtc"),
                                          testing::Values(5, 10, 20), testing::Range(1, 6)),
                         [](const auto& chosen) {
                           std::string name = std::get<0>(chosen.param);
                           std::erase_if(name, [](char c) { return !std::isalnum(c); });
                           return name + std::to_string(std::get<1>(chosen.param)) + "ms" +
                                  std::to_string(std::get<2>(chosen.param));
                         });

class LateStorms : public testing::TestWithParam<std::tuple<std::string, int>> {};

TEST_P(LateStorms, PublishNoWrongValueAndStarveNobody) {
  const auto& [name, by] = GetParam();
  const StormKind& kind = kind_named(name);
  const BusSpec spec = bus_of(kind, "200ms");
  StormFaults faults{.late = 0.05, .by = std::chrono::milliseconds{by}, .doubled = 0.02};
  if (kind.foreign) faults.foreign = 0.2;
  LateStorm storm(kind, spec, faults_of(spec, faults), static_cast<std::uint64_t>(by));
  storm.run(5'000);
  const auto counts = storm.counts();
  EXPECT_EQ(counts.wrong, 0u) << counts.first_wrong;
  EXPECT_GT(counts.late, 100u);
  EXPECT_GE(counts.commands, counts.answered);
  EXPECT_LE(counts.commands - counts.answered, 20u) << "commands without a result";
  for (std::size_t c = 0; c < storm.good_of_channels().size(); ++c)
    EXPECT_GT(storm.good_of_channels()[c], 20u) << "channel " << c << " starves";
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const StormKind& kind : storm_kinds()) all.push_back(kind.name);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Protocols, LateStorms,
                         testing::Combine(testing::ValuesIn(names()),
                                          testing::Values(100, 210, 300, 550)),
                         [](const auto& chosen) {
                           std::string name = std::get<0>(chosen.param);
                           std::erase_if(name, [](char c) { return !std::isalnum(c); });
                           return name + std::to_string(std::get<1>(chosen.param));
                         });

}  // namespace
}  // namespace fieldcast::test

namespace fieldcast::sim {
namespace {

// Compares what each protocol declares about ambiguous responses with its codec and simulated
// device: every exchange that accepts the response to another request must be declared.

// The response to the request, also after greetings, whose results are in `session`.
Bytes answer_to(SimDevice& device, const Protocol& protocol, const Request& request,
                std::uint16_t sequence, Bytes& session) {
  const auto receiver = device.open_receiver();
  session.clear();
  const auto exchange = protocol.begin(request, {sequence, &session});
  const auto respond = [&](const Bytes& sent) {
    Reaction reaction;
    for (const std::uint8_t character : sent)
      receiver->on_character(character, Instant{std::chrono::seconds{1}}, reaction);
    const Instant silent = receiver->silence_due();  // the end of a datagram
    if (reaction.response.empty() && silent != kNever) receiver->on_silence(silent, reaction);
    return reaction.response;
  };
  Bytes sent;
  (void)exchange->start(sent);
  Bytes response = respond(sent);
  for (std::size_t known = session.size();; known = session.size()) {
    Bytes next;
    (void)exchange->on_bytes(response, next);
    if (session.size() == known) return response;
    response = respond(next);
  }
}

bool takes(const Protocol& protocol, const Request& request, ExchangeContext context,
           ByteView answer) {
  const auto exchange = protocol.begin(request, context);
  Bytes out;
  (void)exchange->start(out);
  out.clear();
  return exchange->on_bytes(answer, out).kind == Step::Kind::kDone;
}

void expect_known(const Subject& subject, std::uint16_t later_sequence, int& taken, int& distinct) {
  const Requests requests(subject);
  const Protocol& protocol = requests.protocol();
  auto device = kind_of(subject.device)
                    ->make({.spec = subject.device, .line = subject.line(), .first_on_bus = true});
  ASSERT_TRUE(device);
  auto all = requests.examples();
  for (std::size_t i = 0, count = all.size(); i < count; ++i) {
    auto* read = std::get_if<ReadRequest>(&all[i].request);
    if (read == nullptr) continue;
    ReadRequest other = *read;
    ++other.ranges.front().first;
    if (requests.allows(other)) all.push_back({all[i].name + ", next", other});
  }
  for (const NamedRequest& earlier : all) {
    Bytes session;
    const Bytes answer = answer_to(**device, protocol, earlier.request, 7, session);
    if (answer.empty()) continue;
    for (const NamedRequest& later : all) {
      const bool mistakable =
          protocol.mistakable(earlier.request, {7}, later.request, {later_sequence});
      const bool took = takes(protocol, later.request, {later_sequence, &session}, answer);
      taken += took ? 1 : 0;
      distinct += mistakable ? 0 : 1;
      if (took) {
        EXPECT_TRUE(mistakable) << subject.device.protocol << " " << subject.variant << ": '"
                                << later.name << "' takes the answer to '" << earlier.name << "'";
      }
    }
  }
}

TEST(Mistakable, EveryResponseThatAnotherRequestAcceptsIsKnown) {
  for (const ProtocolEntry& entry : protocols()) {
    for (const Subject& subject : subjects_of(entry.name)) {
      const auto protocol = subject.protocol();
      const bool numbered = protocol->traits().identity == ResponseIdentity::kSequence;
      int taken = 0, distinct = 0, same = 0;
      expect_known(subject, 8, taken, distinct);
      EXPECT_EQ(taken > 0, !numbered) << entry.name << ": the check would see nothing";
      // Only responses of a single round can be confused here.
      const bool polled =
          entry.name == "s7-ppi" || subject.variant.find("duplex: half") != std::string::npos;
      if (numbered && !polled) {
        expect_known(subject, 7, same, distinct);
        EXPECT_GT(same, 0) << entry.name;
      }
      if (entry.name != "s7-freeport") {
        EXPECT_GT(distinct, 0) << entry.name << ": nothing may go on";
      }
    }
  }
}

TEST(Mistakable, DeclaredOnesToo) {
  const auto declaration = config::load_declaration("modbus-rtu-declared");
  ASSERT_TRUE(declaration);
  for (const Subject& subject : subjects_of(*declaration)) {
    int taken = 0, distinct = 0;
    expect_known(subject, 8, taken, distinct);
    EXPECT_GT(taken, 0);
  }
}

// Tests that every protocol recognises the requests of another master, but no responses.

using Seen = std::function<SeenRequest(ByteView)>;

Seen seen_of(const Subject& subject) {
  const auto declaration = subject.device.declaration;
  if (declaration)
    return [declaration](ByteView bytes) { return seen_request(*declaration.value, bytes); };
  return find_protocol(subject.device.protocol)->seen_request;
}

std::string name_of(const Subject& subject, const std::string& request) {
  return subject.device.protocol + " " + subject.variant + ": " + request;
}

struct Conversation {
  std::vector<Bytes> sent, answered;
};

Conversation talk(SimDevice& device, const Protocol& protocol, const Request& request) {
  constexpr int kMostRounds = 40;
  Conversation talk;
  const auto receiver = device.open_receiver();
  const auto exchange = protocol.begin(request, {7});
  Instant now{std::chrono::seconds{1}};
  Bytes sent;
  Step step = exchange->start(sent);
  for (int round = 0; round < kMostRounds && step.kind == Step::Kind::kSend; ++round) {
    talk.sent.push_back(sent);
    Reaction reaction;
    for (const std::uint8_t character : sent) receiver->on_character(character, now, reaction);
    talk.answered.push_back(reaction.response);
    sent.clear();
    step = exchange->on_bytes(reaction.response, sent);
    if (step.kind == Step::Kind::kNeedMore && step.wait == Wait::kPause)
      step = exchange->on_silence(sent);
  }
  return talk;
}

void expect_seen(const Subject& subject, int& certain) {
  const Seen seen = seen_of(subject);
  ASSERT_TRUE(seen) << subject.device.protocol;
  const Requests requests(subject);
  auto device = kind_of(subject.device)->make({.spec = subject.device, .line = subject.line()});
  ASSERT_TRUE(device);
  for (const NamedRequest& each : requests.examples()) {
    const Conversation conversation = talk(**device, requests.protocol(), each.request);
    const Bytes& request = conversation.sent.front();
    const SeenRequest found = seen(request);
    EXPECT_EQ(found.size, request.size()) << name_of(subject, each.name) << to_hex(request);
    certain += found.certain ? 1 : 0;
    for (const Bytes& answer : conversation.answered) {
      const SeenRequest mistaken = answer.empty() ? SeenRequest{} : seen(answer);
      EXPECT_FALSE(mistaken && mistaken.certain) << name_of(subject, each.name) << to_hex(answer);
    }
    // Without its CR LF, a request of MC format 4 is one of format 1.
    const bool has_shorter_form =
        subject.device.protocol == "mitsubishi-mc-serial" && request.back() == '\n';
    const std::size_t whole = request.size() - (has_shorter_form ? 2 : 0);
    for (std::size_t size = 0; size < whole; ++size)
      EXPECT_FALSE(seen(ByteView(request).first(size))) << name_of(subject, each.name) << size;
    if (!subject.checked) continue;
    for (std::size_t bit = 0; bit < 8 * request.size(); ++bit) {
      Bytes broken = request;
      broken[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
      EXPECT_NE(seen(broken).size, request.size()) << name_of(subject, each.name) << to_hex(broken);
    }
  }
}

// Full duplex of DF1: no second master is on the line.
bool is_point_to_point(const Subject& subject) {
  return subject.device.protocol == "allen-bradley-df1" &&
         subject.variant.find("duplex: half") == std::string::npos;
}

TEST(SeenRequest, EachProtocolOfALineKnowsItsRequests) {
  for (const ProtocolEntry& entry : protocols()) {
    if (entry.network_only) {
      EXPECT_EQ(entry.seen_request, nullptr) << entry.name;
      continue;
    }
    int certain = 0;
    for (const Subject& subject : subjects_of(entry.name)) {
      if (!is_point_to_point(subject)) expect_seen(subject, certain);
    }
    EXPECT_GT(certain, 0) << entry.name;
  }
}

// The PLC at the other end may send such a command by itself.
TEST(SeenRequest, NoneOnALineBetweenTwoStations) {
  for (const Subject& subject : subjects_of("allen-bradley-df1")) {
    if (!is_point_to_point(subject)) continue;
    const Requests requests(subject);
    for (const NamedRequest& each : requests.examples()) {
      Bytes sent;
      (void)requests.protocol().begin(each.request, {7})->start(sent);
      EXPECT_FALSE(seen_of(subject)(sent)) << each.name;
    }
  }
}

TEST(SeenRequest, DeclaredOnesToo) {
  for (const char* name : {"modbus-rtu-declared", "instrument"}) {
    const auto declaration = config::load_declaration(name);
    ASSERT_TRUE(declaration) << name;
    int certain = 0;
    for (const Subject& subject : subjects_of(*declaration)) expect_seen(subject, certain);
    EXPECT_GT(certain, 0) << name;
  }
}

}  // namespace
}  // namespace fieldcast::sim

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

// Reads of one area: responses of the same device and length look equal, as in Modbus RTU.
PendingResponses alike_by_length() {
  return PendingResponses([](const Asked& a, const Asked& b) {
    const auto count = [](const Asked& asked) {
      return std::get<ReadRequest>(asked.request).ranges[0].count;
    };
    return a.device == b.device && count(a) == count(b);
  });
}

Asked read(DeviceIndex device, std::uint32_t first, std::uint32_t count, Instant sent = {}) {
  return {device, ReadRequest{{{0, first, count}}}, {}, sent};
}

void owe(PendingResponses& owed, Asked asked) {
  PendingResponses::Debt debt;
  debt.asked = std::move(asked);
  debt.bound = 600ms;
  owed.owe(std::move(debt));
}

TEST(PendingResponses, WhatCouldBeMistakenWaitsForTheBound) {
  PendingResponses owed = alike_by_length();
  owe(owed, read(1, 100, 2));
  EXPECT_EQ(owed.askable_from(read(1, 200, 2), true), Instant{600ms});
  EXPECT_EQ(owed.askable_from(read(1, 200, 3), true), kLongAgo) << "another length";
  EXPECT_EQ(owed.askable_from(read(2, 200, 2), true), kLongAgo) << "another device";
  EXPECT_EQ(owed.askable_from(read(1, 100, 2), true), kLongAgo) << "the same again";
  EXPECT_EQ(owed.askable_from(read(1, 100, 2), false), Instant{600ms}) << "a command's";
}

TEST(PendingResponses, TwoRequestsAndOneResponseLeaveOnePending) {
  PendingResponses owed = alike_by_length();
  owe(owed, read(1, 100, 2));
  owed.responded(read(1, 100, 2, Instant{200ms}), false, 600ms, Instant{250ms});
  ASSERT_EQ(owed.debts().size(), 1u);
  EXPECT_EQ(owed.askable_from(read(1, 200, 2), true), Instant{800ms});
  (void)owed.take(0, Instant{300ms});
  EXPECT_EQ(owed.askable_from(read(1, 200, 2), true), kLongAgo);
}

TEST(PendingResponses, OneAfterTheOtherIsWorkedOff) {
  PendingResponses owed = alike_by_length();
  owe(owed, read(1, 100, 2));
  owe(owed, read(1, 100, 2, Instant{200ms}));
  EXPECT_EQ(owed.askable_from(read(1, 200, 2), true), Instant{1200ms});
  (void)owed.take(0, Instant{250ms});
  EXPECT_EQ(owed.askable_from(read(1, 200, 2), true), Instant{850ms});
  EXPECT_FALSE(owed.expire(Instant{849ms}));
  EXPECT_TRUE(owed.expire(Instant{850ms}));
}

TEST(PendingResponses, AResponseThatIsCertainEndsWhatWasAskedBefore) {
  PendingResponses owed = alike_by_length();
  owe(owed, read(1, 100, 2));
  owe(owed, read(2, 100, 2));
  owed.responded(read(1, 100, 3, Instant{200ms}), true, 600ms, Instant{210ms});
  EXPECT_EQ(owed.debts().size(), 2u) << "a refusal shows nothing of its length";
  owed.responded(read(1, 100, 3, Instant{200ms}), false, 600ms, Instant{210ms});
  ASSERT_EQ(owed.debts().size(), 1u);
  EXPECT_EQ(owed.debts()[0].asked.device, 2u);
}

}  // namespace
}  // namespace fieldcast
