// `fieldcast inspect --learn` of random, damaged and few frames: its limits bound the time, and the
// loader accepts what is proposed.
#include "tests/tools/cli/learn_plant.hpp"

namespace fieldcast::learn {
namespace {

void expect_loads(const Proposal& proposal) {
  if (proposal.is_declarable()) (void)declared_by(proposal);
}

void expect_valid(ExchangePairing& pairing) {
  const Proposal proposal = learn(pairing.finish());
  for (const LearnedOperation& operation : proposal.operations)
    EXPECT_FALSE(operation.response.empty() && operation.refusal.empty());
  expect_loads(proposal);
}

TEST(LearnHostile, NothingIsLearnedFromNothing) {
  ExchangePairing pairing;
  const Proposal proposal = learn(pairing.finish());
  EXPECT_TRUE(proposal.operations.empty());
  EXPECT_FALSE(proposal.is_declarable());
  EXPECT_EQ(declaration_text(proposal), "");
}

TEST(LearnHostile, OneFrame) {
  for (const Direction direction : {Direction::kSent, Direction::kReceived}) {
    for (const char* hex : {"00", "FF", "41", "01 03 00 00 00 01 84 0A", "0D 0A"}) {
      ExchangePairing pairing;
      pairing.take(direction, *from_hex(hex));
      expect_valid(pairing);
    }
  }
}

TEST(LearnHostile, RandomFramesOfAnyLength) {
  for (const std::size_t longest : {1u, 4u, 40u, 300u, 5000u}) {
    std::mt19937 random(static_cast<unsigned>(longest));
    ExchangePairing pairing;
    for (int i = 0; i < 100'000 / static_cast<int>(1 + longest / 40); ++i) {
      Bytes frame(random() % (longest + 1));
      for (std::uint8_t& byte : frame) byte = static_cast<std::uint8_t>(random());
      pairing.take(random() % 2 == 0 ? Direction::kSent : Direction::kReceived, frame);
    }
    EXPECT_LE(pairing.frames(), 100'000u);
    const auto exchanges = pairing.finish();
    EXPECT_LE(exchanges.size(), ExchangePairing::kMaxExchanges);
    const Proposal proposal = learn(exchanges);
    EXPECT_LE(proposal.operations.size(), kMaxGroups);
    expect_loads(proposal);
  }
}

// Few letters make many repeated columns, separators and lengths.
void expect_valid_texts(unsigned seed) {
  static constexpr std::string_view kLetters = "0019AF #.,-+\r\n\x02\x03";
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  ExchangePairing pairing;
  const std::size_t longest = 1 + random() % 30, letters = 1 + random() % kLetters.size();
  for (int i = 0; i < 60; ++i) {
    Bytes frame(1 + random() % longest);
    for (std::uint8_t& c : frame) c = static_cast<std::uint8_t>(kLetters[random() % letters]);
    pairing.take(i % 2 == 0 ? Direction::kSent : Direction::kReceived, frame);
  }
  expect_valid(pairing);
}

TEST(LearnHostile, RandomTexts) {
  for (unsigned seed = 0; seed < 300; ++seed) expect_valid_texts(seed);
}

// A digit was the number of pairs of digits in two responses, and the fields there were texts.
TEST(LearnHostile, ALengthOfPairsOfDigitsCoversDigits) { expect_valid_texts(825); }

// Frames of a protocol with bytes that differ, are missing or are too many.
TEST(LearnHostile, DamagedFrames) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    ExchangePairing pairing;
    const auto damaged = [&](Bytes frame) {
      const unsigned kind = random() % 8;
      if (kind == 0) frame[random() % frame.size()] ^= static_cast<std::uint8_t>(random());
      if (kind == 1) frame.resize(1 + random() % frame.size());
      if (kind == 2) frame.insert(frame.begin() + random() % frame.size(), 0x30);
      return frame;
    };
    for (std::uint8_t i = 0; i < 60; ++i) {
      const auto count = static_cast<std::uint8_t>(1 + random() % 4);
      Bytes request{static_cast<std::uint8_t>(1 + random() % 3),
                    static_cast<std::uint8_t>(3 + random() % 2),
                    0,
                    i,
                    0,
                    count};
      Bytes response{request[0], request[1], static_cast<std::uint8_t>(2 * count)};
      for (int item = 0; item < 2 * count; ++item)
        response.push_back(static_cast<std::uint8_t>(random()));
      pairing.take(Direction::kSent, damaged(request));
      pairing.take(Direction::kReceived, damaged(response));
    }
    expect_valid(pairing);
  }
}

}  // namespace
}  // namespace fieldcast::learn
