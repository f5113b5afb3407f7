// Compares what each protocol declares about ambiguous responses with its codec and simulated
// device: every exchange that accepts the response to another request must be declared.
#include <gtest/gtest.h>

#include <algorithm>

#include "config/loader/loader.hpp"
#include "core/protocol/families/registry.hpp"
#include "tools/sim/check/requests.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {
namespace {

Bytes answer_to(SimDevice& device, const Protocol& protocol, const Request& request,
                std::uint16_t sequence) {
  const auto receiver = device.open_receiver();
  Bytes sent;
  (void)protocol.begin(request, {sequence})->start(sent);
  Reaction reaction;
  Instant now{std::chrono::seconds{1}};
  for (const std::uint8_t character : sent) receiver->on_character(character, now, reaction);
  return reaction.answer;
}

bool takes(const Protocol& protocol, const Request& request, std::uint16_t sequence,
           ByteView answer) {
  const auto exchange = protocol.begin(request, {sequence});
  Bytes out;
  (void)exchange->start(out);
  out.clear();
  return exchange->on_bytes(answer, out).kind == Step::Kind::kDone;
}

void expect_known(const Subject& subject, std::uint16_t later_sequence, int& taken, int& distinct) {
  const Requests requests(subject);
  const Protocol& protocol = requests.protocol();
  auto device = kind_of(subject.device)->make({.spec = subject.device, .line = subject.line()});
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
    const Bytes answer = answer_to(**device, protocol, earlier.request, 7);
    if (answer.empty()) continue;
    for (const NamedRequest& later : all) {
      const bool mistakable =
          protocol.mistakable(earlier.request, {7}, later.request, {later_sequence});
      const bool took = takes(protocol, later.request, later_sequence, answer);
      taken += took ? 1 : 0;
      distinct += mistakable ? 0 : 1;
      if (took) {
        EXPECT_TRUE(mistakable) << subject.device.protocol << " " << subject.variant << ": '"
                                << later.name << "' takes the answer to '" << earlier.name << "'";
      }
    }
  }
}

TEST(Mistakable, EveryAnswerThatAnotherRequestTakesIsKnown) {
  for (const ProtocolEntry& entry : protocols()) {
    for (const Subject& subject : subjects_of(entry.name)) {
      const auto protocol = subject.protocol();
      const bool numbered = protocol->traits().identity == ResponseIdentity::kSequence;
      int taken = 0, distinct = 0, same = 0;
      expect_known(subject, 8, taken, distinct);
      EXPECT_EQ(taken > 0, !numbered) << entry.name << ": the check would see nothing";
      // Only responses of a single round can be confused here.
      if (numbered && entry.name != "s7-ppi") {
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

}  // namespace
}  // namespace fieldcast::sim
