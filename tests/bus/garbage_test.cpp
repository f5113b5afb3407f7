#include "core/bus/health/garbage.hpp"

#include <gmock/gmock.h>

#include <bit>
#include <random>

namespace fieldcast {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr LineFormat k8N1{19200, 8, Parity::kNone, 1};
constexpr LineFormat k8E1{19200, 8, Parity::kEven, 1};
const Bytes kRequest{1, 3, 0, 0, 0, 2, 0xC4, 0x0B};

// Returns what a UART with another baud rate receives: it samples the line in the middle of each
// bit and starts a character at each falling edge. Both sides use 8N1.
Bytes received_at(double sender_baud, double receiver_baud, const Bytes& characters) {
  std::vector<bool> level;
  for (const std::uint8_t byte : characters) {
    level.push_back(false);
    for (int bit = 0; bit < 8; ++bit) level.push_back((byte >> bit & 1) != 0);
    level.push_back(true);
  }
  const auto at = [&](double time) {
    const auto bit = static_cast<std::size_t>(time * sender_baud);
    return bit >= level.size() || level[bit];
  };
  Bytes out;
  const double end = static_cast<double>(level.size()) / sender_baud, bit = 1 / receiver_baud;
  for (double time = 0; time < end;) {
    if (at(time)) {
      time += bit / 16;
      continue;
    }
    unsigned byte = 0;
    for (int i = 0; i < 8; ++i) byte |= at(time + bit * (1.5 + i)) ? 1u << i : 0u;
    out.push_back(static_cast<std::uint8_t>(byte));
    time += bit * 9.5;
    while (time < end && !at(time)) time += bit / 16;  // wait for the level of a stop bit
  }
  return out;
}

Bytes random_bytes(std::size_t count) {
  std::mt19937 random{7};
  Bytes bytes;
  for (std::size_t i = 0; i < count; ++i) bytes.push_back(static_cast<std::uint8_t>(random()));
  return bytes;
}

TEST(Garbage, TheUartOfTheTestUnderstandsItsOwnBaudRate) {
  const Bytes bytes = random_bytes(100);
  EXPECT_EQ(received_at(19200, 19200, bytes), bytes);
}

TEST(Garbage, ASlowerSenderIsSeen) {
  for (const double sender : {9600.0, 4800.0, 2400.0}) {
    const Bytes received = received_at(sender, 19200, random_bytes(60));
    EXPECT_THAT(looks_like(received, k8N1, false), HasSubstr("lower"))
        << sender << ' ' << to_hex(received);
  }
}

TEST(Garbage, AFasterSenderIsNotTakenForASlowerOne) {
  for (const double sender : {19200.0, 38400.0, 115200.0}) {
    const Bytes received = received_at(sender, 19200, random_bytes(200));
    EXPECT_THAT(looks_like(received, k8N1, false), Not(HasSubstr("lower baud")))
        << sender << ' ' << to_hex(received);
  }
}

TEST(Garbage, TextWithAParityBitNamesTheFormat) {
  Bytes even, odd;
  for (const char c : std::string("@00RD000064000000000057*\r")) {
    const auto seven = unsigned{static_cast<unsigned char>(c)};
    const unsigned ones = static_cast<unsigned>(std::popcount(seven)) % 2;
    even.push_back(static_cast<std::uint8_t>(seven | ones << 7));
    odd.push_back(static_cast<std::uint8_t>(seven | (ones ^ 1u) << 7));
  }
  EXPECT_THAT(looks_like(even, k8N1, false), HasSubstr("try format 7E1"));
  EXPECT_THAT(looks_like(odd, k8N1, false), HasSubstr("try format 7O1"));
  EXPECT_THAT(looks_like(odd, k8N1, true), HasSubstr("serial server"));
  EXPECT_THAT(looks_like(odd, {19200, 7, Parity::kNone, 1}, false), Not(HasSubstr("text of 7")));
}

// With INPCK, the driver delivers a character with wrong parity as 00.
TEST(Garbage, AnotherParityNamesTheFormatsToTry) {
  Bytes received = random_bytes(40);
  for (std::uint8_t& byte : received) {
    if (std::popcount(byte) % 2 != 0) byte = 0;
  }
  EXPECT_THAT(looks_like(received, k8E1, false), AllOf(HasSubstr("8N1"), HasSubstr("8O1")));
  constexpr LineFormat k8O1{19200, 8, Parity::kOdd, 1};
  EXPECT_THAT(looks_like(received, k8O1, false), AllOf(HasSubstr("8N1"), HasSubstr("8E1")));
}

TEST(Garbage, OneLevelAloneIsTheWiring) {
  EXPECT_THAT(looks_like(Bytes(20, 0x00), k8N1, false), StartsWith("nothing but zeros"));
  EXPECT_THAT(looks_like(Bytes(20, 0xFF), k8N1, false), StartsWith("nothing but FF"));
}

TEST(Garbage, RandomBytesAndTextOfAnotherProtocol) {
  EXPECT_THAT(looks_like(random_bytes(60), k8N1, false), StartsWith("no frame of this protocol"));
  const std::string login = "Welcome to SuperTerm\r\nlogin: ";
  EXPECT_THAT(looks_like(Bytes(login.begin(), login.end()), k8N1, false), StartsWith("text"));
}

TEST(Garbage, TextHasNoControlCharactersExceptThoseOfFramesAndLines) {
  const auto is_text = [](std::uint8_t byte) {
    const Bytes bytes{'R', 'e', 'a', 'd', 'y', ' ', byte};
    return looks_like(bytes, k8N1, false).starts_with("text:");
  };
  for (const std::uint8_t byte : Bytes{0x02, 0x06, '\n', '\r', ' ', '~'})
    EXPECT_TRUE(is_text(byte)) << int{byte};
  for (const std::uint8_t byte : Bytes{0x01, 0x07, 0x09, 0x0B, 0x1F, 0x7F})
    EXPECT_FALSE(is_text(byte)) << int{byte};
}

TEST(Garbage, FewBytesShowNothing) {
  EXPECT_THAT(looks_like(Bytes(5, 0x00), k8N1, false), StartsWith("no frame"));
  EXPECT_THAT(looks_like(Bytes(6, 0x00), k8N1, false), StartsWith("nothing but zeros"));
  EXPECT_THAT(looks_like(Bytes(5, 'a'), k8N1, false), StartsWith("no frame"));
  EXPECT_THAT(looks_like(Bytes(6, 'a'), k8N1, false), StartsWith("text"));
}

TEST(Garbage, AQuarterOfZerosOnALineWithParityIsAnotherFormat) {
  Bytes received = {0x00, 0x35, 0x9A, 0xC7};
  EXPECT_THAT(looks_like(received, k8E1, false), StartsWith("no frame")) << "too few";
  append(received, Bytes(received));
  EXPECT_THAT(looks_like(received, k8E1, false), StartsWith("00 stands for"));
  EXPECT_THAT(looks_like(received, k8N1, false), StartsWith("no frame"));
  received.push_back(0x35);
  EXPECT_THAT(looks_like(received, k8E1, false), StartsWith("no frame"));
}

TEST(Garbage, IsWorthSayingWhenItIsNotASingleNoise) {
  Garbage garbage;
  EXPECT_FALSE(garbage.received(Bytes{0x12, 0x34}, kRequest, 9));
  EXPECT_FALSE(garbage.received({}, kRequest, 9)) << "silence is no garbage";
  EXPECT_FALSE(garbage.received(Bytes{0x56}, kRequest, 9));
  EXPECT_TRUE(garbage.received(Bytes{0x78}, kRequest, 9));
  EXPECT_THAT(
      garbage.text(&k8N1, false),
      StartsWith("bytes arrive that are not a response: 4 in 3 exchanges, the last ones 12 34 56 "
                 "78: no frame of this protocol: try another baud"));
  EXPECT_TRUE(garbage.responded());
  EXPECT_FALSE(garbage.responded());
  EXPECT_FALSE(garbage.received(Bytes{1}, kRequest, 9));
}

TEST(Garbage, AnEchoAloneIsNamed) {
  Garbage garbage;
  for (unsigned i = 0; i < Garbage::kWorthSaying; ++i)
    (void)garbage.received(kRequest, kRequest, 9);
  EXPECT_THAT(garbage.text(&k8N1, false), HasSubstr("what was sent comes back"));
}

// Regression: registers of value 0 were reported as wrong parity on a line with parity.
TEST(Garbage, BrokenResponsesOfTheRightLineAreNotAWrongParity) {
  constexpr std::size_t kExpected = 25;
  const auto said = [&](std::size_t bytes) {
    Bytes answer(bytes, 0);
    std::copy_n(kRequest.begin(), 2, answer.begin());
    answer[2] = 20;
    Garbage garbage;
    for (unsigned i = 0; i < Garbage::kWorthSaying; ++i)
      (void)garbage.received(answer, kRequest, kExpected);
    return garbage.text(&k8E1, false);
  };
  EXPECT_THAT(said(25), AllOf(HasSubstr("right length, but a wrong checksum"),
                              HasSubstr("two devices have this address"), Not(HasSubstr("8N1"))));
  EXPECT_THAT(said(40), AllOf(HasSubstr("continue beyond its length"), HasSubstr("two devices"),
                              Not(HasSubstr("8N1"))));
  EXPECT_THAT(said(12), AllOf(HasSubstr("the end is missing"), HasSubstr("gap-allowance"),
                              Not(HasSubstr("8N1"))));
}

// A frame of Modbus TCP has no checksum, and its connection has no baud rate.
TEST(Garbage, AConnectionWithoutLineHasNoAdviceForLines) {
  Garbage garbage;
  for (unsigned i = 0; i < Garbage::kWorthSaying; ++i)
    (void)garbage.received(Bytes{1, 3, 4, 0, 0, 0, 0, 0, 0}, kRequest, 9);
  EXPECT_THAT(
      garbage.text(nullptr, true),
      AllOf(HasSubstr("another structure"), Not(HasSubstr("baud")), Not(HasSubstr("checksum"))));
}

TEST(Garbage, BytesThatBeginOtherwiseAreJudgedByTheirBits) {
  Garbage garbage;
  for (unsigned i = 0; i < Garbage::kWorthSaying; ++i)
    (void)garbage.received(Bytes{1, 0, 0, 0x20, 0, 0, 0, 0}, kRequest, 9);
  EXPECT_THAT(garbage.text(&k8E1, false), HasSubstr("try 8N1"));
  EXPECT_EQ(response_shape(kRequest, kRequest, 9), ResponseShape::kOther) << "an echo";
  EXPECT_EQ(response_shape(Bytes{1, 3, 4}, kRequest, 0), ResponseShape::kOther)
      << "of unknown length";
  EXPECT_EQ(response_shape(Bytes{5, 3, 4}, Bytes{5}, 3), ResponseShape::kOther)
      << "a request too short to begin like it";
  EXPECT_EQ(broken_response_text(ResponseShape::kOther), "");
}

TEST(Garbage, ShowsTheLastBytesOfAFlood) {
  Garbage garbage;
  for (int i = 0; i < 1000; ++i) (void)garbage.received(Bytes(300, 0x5A), kRequest, 9);
  const std::string text = garbage.text(&k8N1, false);
  EXPECT_THAT(text, HasSubstr("300000 in 1000 exchanges"));
  EXPECT_LT(text.size(), 300u);
}

}  // namespace
}  // namespace fieldcast
