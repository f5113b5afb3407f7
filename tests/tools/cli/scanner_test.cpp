#include <map>
#include <numeric>
#include <set>

#include "tests/tools/cli/scan_support.hpp"
#include "tools/cli/scan/scan_view.hpp"

namespace fieldcast::cli {
namespace {

TEST(Scanner, ASilentLineIsProbedOnce) {
  Scanner scanner(probed_lines(3, {1, 2}));
  std::size_t left = scanner.left();
  while (const auto ask = scanner.next()) {
    EXPECT_EQ(scanner.left(), left--);
    EXPECT_TRUE(ask->wait);
    EXPECT_EQ(ask->first, ask->address == 2);
    scanner.on_response(silence());
  }
  EXPECT_EQ(scanner.asked(), 6u);
  EXPECT_TRUE(scanner.silent());
  const auto text = silence_lines("/dev/ttyUSB0", scanner, true, std::chrono::milliseconds{200});
  ASSERT_EQ(text.size(), 4u);
  EXPECT_EQ(text[0], "no byte was received on /dev/ttyUSB0");
  EXPECT_EQ(text[1],
            "  2 addresses from 1 to 2 were probed: modbus-rtu 19200 8E1, modbus-rtu 9600 8N1, "
            "modbus-rtu 9600 8E1");
  EXPECT_THAT(text[2], HasSubstr("A and B"));
  EXPECT_THAT(text[3], HasSubstr("--all requests every address twice"));
  EXPECT_THAT(text[3], HasSubstr("it takes about 7s"));
}

TEST(Scanner, ALineOnWhichBytesAreReceivedTwiceIsSearched) {
  Scanner scanner(probed_lines(4, {1, 2, 3}));
  std::vector<std::string> asked;
  while (const auto ask = scanner.next()) {
    asked.push_back(std::to_string(ask->line) + (ask->wait ? '?' : ':') +
                    std::to_string(ask->address));
    const bool there = ask->line == 1 && ask->address == 2;
    // The response to a probe is late: it is received while address 3 is probed.
    const bool late = ask->line == 1 && ask->address == 3 && ask->wait.has_value();
    ScanResponse answer = there && !ask->wait ? value() : silence();
    answer.heard = late;
    scanner.on_response(answer);
  }
  EXPECT_THAT(asked, ElementsAre("0?2", "0?3", "0?1", "1?2", "1?3", "1?2", "1?3", "1:1", "1:2",
                                 "1:3", "1:1", "1:3"));
  ASSERT_EQ(scanner.found().size(), 1u);
  EXPECT_EQ(scanner.found()[0].address, 2);
  EXPECT_FALSE(scanner.silent());
}

TEST(Scanner, AByteThatIsReceivedOnceStartsNoSearch) {
  Scanner scanner(probed_lines(3, {1, 2, 3}));
  std::map<std::size_t, unsigned> asked;
  while (const auto ask = scanner.next()) {
    ASSERT_TRUE(ask->wait);
    ScanResponse answer = silence();
    answer.heard = asked[ask->line]++ == 0;
    scanner.on_response(answer);
  }
  EXPECT_EQ(asked[0], 4u);
  EXPECT_TRUE(scanner.silent());
}

TEST(Scanner, AfterALineWithBytesButNoDeviceTheNextIsProbed) {
  Scanner scanner(probed_lines(2, {1, 2}));
  std::set<std::size_t> searched;
  unsigned probes = 0;
  while (const auto ask = scanner.next()) {
    if (ask->wait)
      ++probes;
    else
      searched.insert(ask->line);
    const bool there = ask->line == 1 && ask->address == 2;
    ScanResponse answer = there ? value() : ask->line == 0 ? noise() : silence();
    answer.heard = ask->line == 0;
    scanner.on_response(answer);
  }
  EXPECT_EQ(probes, 3u) << "two of line 0, one of line 1, which brought a value";
  EXPECT_THAT(searched, ElementsAre(0, 1));
  EXPECT_EQ(scanner.found().size(), 1u);
}

TEST(Scanner, AsksEveryLineTwiceWhenNobodyResponds) {
  Scanner scanner(lines_of(3, {1, 2}));
  std::multiset<std::tuple<std::size_t, int, std::size_t>> asked;
  std::size_t left = scanner.left();
  while (const auto ask = scanner.next()) {
    EXPECT_EQ(scanner.left(), left--);
    asked.insert({ask->line, ask->address, ask->question});
    scanner.on_response(silence());
  }
  EXPECT_EQ(asked.size(), 12u);
  EXPECT_EQ((std::set(asked.begin(), asked.end()).size()), 12u);
  EXPECT_EQ(scanner.left(), 0u);
  EXPECT_THAT(scanner.found(), IsEmpty());
}

TEST(Scanner, AResponseSettlesTheLineAndTheSilentAreAskedAgain) {
  Scanner scanner(lines_of(5, {1, 2, 3, 4}));
  std::vector<std::string> asked;
  while (const auto ask = scanner.next()) {
    asked.push_back(std::to_string(ask->line) + ':' + std::to_string(ask->address) + '/' +
                    std::to_string(ask->question));
    const bool first = ask->line == 1 && ask->address == 2;
    const bool second = ask->line == 1 && ask->address == 3 && ask->question == 1;
    scanner.on_response(first || second ? value() : silence());
  }
  EXPECT_THAT(asked, ElementsAre("0:1/0", "0:2/0", "0:3/0", "0:4/0", "1:1/0", "1:2/0", "1:3/0",
                                 "1:4/0", "1:1/1", "1:3/1", "1:4/1"));
  ASSERT_EQ(scanner.found().size(), 2u);
  EXPECT_EQ(scanner.found()[0].address, 2);
  EXPECT_EQ(scanner.found()[1].address, 3);
}

TEST(Scanner, ALineOnWhichOthersSpeakIsLeft) {
  Scanner scanner(lines_of(2, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
  std::map<std::size_t, unsigned> asked;
  while (const auto ask = scanner.next()) {
    ++asked[ask->line];
    scanner.on_response(ask->line == 0 ? noise() : silence());
  }
  EXPECT_EQ(asked[0], Scanner::kBabble + 1);
  EXPECT_EQ(asked[1], 20u);
  EXPECT_THAT(scanner.noisy_lines(), ElementsAre(0));
}

// Address 2 responds late to its first request on line 1, while 3 is asked.
TEST(Scanner, ALineWithALateResponseIsSearchedOnceMore) {
  Scanner scanner(lines_of(3, {1, 2, 3}));
  std::vector<std::pair<std::size_t, int>> asked;
  bool late = false;
  while (const auto ask = scanner.next()) {
    if (ask->question == 0) asked.emplace_back(ask->line, ask->address);
    const bool its = ask->line == 1 && ask->address == 2;
    const bool others = ask->line == 1 && ask->address == 3 && ask->question == 0;
    scanner.on_response(its && late ? value() : others ? noise() : silence());
    late = late || its;
  }
  EXPECT_THAT(asked, ElementsAre(testing::Pair(0, 1), testing::Pair(0, 2), testing::Pair(0, 3),
                                 testing::Pair(1, 1), testing::Pair(1, 2), testing::Pair(1, 3),
                                 testing::Pair(1, 1), testing::Pair(1, 2), testing::Pair(1, 3)));
  ASSERT_EQ(scanner.found().size(), 1u);
  EXPECT_EQ(scanner.found()[0].address, 2);
}

TEST(Scanner, BrokenResponsesThatBeginRightSettleTheLine) {
  Scanner scanner(lines_of(3, {1, 2, 3}));
  std::set<std::size_t> lines;
  while (const auto ask = scanner.next()) {
    lines.insert(ask->line);
    const bool valid = ask->address == 3 && ask->question == 1;
    const ScanResponse broken{
        .cause = Cause::kChecksum, .bytes = 7, .shape = ResponseShape::kWhole};
    scanner.on_response(ask->address == 1 ? silence() : valid ? value() : broken);
  }
  EXPECT_THAT(lines, ElementsAre(0));
  ASSERT_EQ(scanner.broken().size(), 1u) << "address 3 answered the second question";
  EXPECT_EQ(scanner.broken()[0].address, 2);
  EXPECT_EQ(scanner.broken()[0].shape, ResponseShape::kWhole);
}

TEST(Scanner, AnEchoIsNobodyWhoSpeaks) {
  Scanner scanner(lines_of(1, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
  while (scanner.next())
    scanner.on_response({.cause = Cause::kNoResponse, .bytes = 8, .echo_alone = true});
  EXPECT_EQ(scanner.asked(), 20u);
  EXPECT_TRUE(scanner.echoed());
  EXPECT_THAT(scanner.noisy_lines(), IsEmpty());
}

TEST(Scanner, AllRespondTogether) {
  Scanner scanner(lines_of(2, {1, 2}));
  unsigned asked = 0;
  while (scanner.next()) {
    scanner.on_response(value());
    ++asked;
  }
  EXPECT_EQ(asked, 2u);
}

}  // namespace
}  // namespace fieldcast::cli
