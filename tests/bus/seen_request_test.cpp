// Tests that every protocol recognises the requests of another master, but no responses.
#include <gtest/gtest.h>

#include "config/loader/loader.hpp"
#include "core/protocol/families/registry.hpp"
#include "tools/sim/check/requests.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {
namespace {

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
    talk.answered.push_back(reaction.answer);
    sent.clear();
    step = exchange->on_bytes(reaction.answer, sent);
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
    for (std::size_t size = 0; size < request.size(); ++size)
      EXPECT_FALSE(seen(ByteView(request).first(size))) << name_of(subject, each.name) << size;
    if (!subject.checked) continue;
    for (std::size_t bit = 0; bit < 8 * request.size(); ++bit) {
      Bytes broken = request;
      broken[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
      EXPECT_NE(seen(broken).size, request.size()) << name_of(subject, each.name) << to_hex(broken);
    }
  }
}

TEST(SeenRequest, EachProtocolOfALineKnowsItsRequests) {
  for (const ProtocolEntry& entry : protocols()) {
    if (entry.network_only) {
      EXPECT_EQ(entry.seen_request, nullptr) << entry.name;
      continue;
    }
    int certain = 0;
    for (const Subject& subject : subjects_of(entry.name)) expect_seen(subject, certain);
    EXPECT_GT(certain, 0) << entry.name;
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
