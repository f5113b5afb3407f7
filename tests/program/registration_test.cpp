#include "core/program/registration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/codec/checksum.hpp"
#include "core/program/frame.hpp"

namespace fieldcast::program {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

constexpr Instant kStart{seconds{100}};
const RegistrationRule kText;

ByteView raw(std::string_view text) { return as_bytes(text); }

RegistrationRule words_rule() {
  RegistrationRule rule;
  rule.ask = RegistrationRule::Ask::kWords;
  rule.first = 100;
  rule.words = 4;
  return rule;
}

TEST(Registration, ATextEndsAtTheEndOfItsLine) {
  for (const char* text : {"17\r\n", "\r\n17\n", " 17 \r", "\t17\t\n"}) {
    Registration registration(kText);
    EXPECT_TRUE(registration.start(kStart).send.empty());
    const auto outcome = registration.on_bytes(raw(text), kStart);
    EXPECT_EQ(outcome.number, "17") << text;
  }
}

TEST(Registration, ATextWithoutAnEndOfLineEndsInSilence) {
  Registration registration(kText);
  (void)registration.start(kStart);
  auto outcome = registration.on_bytes(raw("Pre"), kStart + seconds{1});
  outcome = registration.on_bytes(raw("ss1"), kStart + seconds{1} + milliseconds{200});
  EXPECT_FALSE(outcome.number);
  EXPECT_EQ(outcome.wake, kStart + seconds{1} + milliseconds{500});
  EXPECT_FALSE(registration.on_timer(outcome.wake - milliseconds{1}).number);
  EXPECT_EQ(registration.on_timer(outcome.wake).number, "Press1");
}

TEST(Registration, APrefixIsTakenAwayAndDemanded) {
  RegistrationRule rule;
  rule.prefix = "ID=";
  Registration with(rule), without(rule);
  (void)with.start(kStart);
  (void)without.start(kStart);
  EXPECT_EQ(with.on_bytes(raw("ID=17\r"), kStart).number, "17");
  EXPECT_THAT(without.on_bytes(raw("17\r"), kStart).fault.value_or(""),
              HasSubstr("does not begin with 'ID='"));
}

TEST(Registration, WhatIsNotANumberIsRefusedInWords) {
  for (const char* text : {"ED\r", "a b\r", "\x01\x02\r", "0002\r", "12345678901234567\r"}) {
    Registration registration(kText);
    (void)registration.start(kStart);
    const auto outcome = registration.on_bytes(raw(text), kStart);
    EXPECT_FALSE(outcome.number) << text;
    EXPECT_THAT(outcome.fault.value_or(""), HasSubstr("no device number")) << text;
  }
}

TEST(Registration, AModuleProvesItsNumberByTheChallenge) {
  const Challenge challenge{"c1", [](std::string_view number, std::string_view response) {
                              return number == "17" && response == "right";
                            }};
  const auto answer = [&](std::string_view text) {
    Registration registration(kText, challenge);
    EXPECT_EQ(as_text(registration.start(kStart).send), "challenge c1\r\n");
    const auto outcome = registration.on_bytes(raw(text), kStart);
    return outcome.number.value_or("") + '/' + outcome.fault.value_or("");
  };
  EXPECT_EQ(answer("17 right\n"), "17/");
  EXPECT_EQ(answer("17  right \n"), "17/");
  EXPECT_EQ(answer("17\n"), "/module 17 does not respond to the challenge");
  EXPECT_EQ(answer("17 wrong\n"), "/module 17 does not know its secret");
  EXPECT_EQ(answer("1_7 right\n"), "/'1_7' is no device number");
}

TEST(Registration, AFaultShowsThePrintableCharactersOfTheText) {
  Registration registration(kText);
  (void)registration.start(kStart);
  EXPECT_EQ(registration.on_bytes(raw("\x1F ~\x7F*\n"), kStart).fault,
            "'. ~.*' is no device number");
}

TEST(Registration, AFloodInsteadOfATextIsRefused) {
  Registration registration(kText);
  (void)registration.start(kStart);
  EXPECT_TRUE(registration.on_bytes(Bytes(1000, 'x'), kStart).fault);
}

TEST(Registration, AModuleThatSaysNothingIsGivenUp) {
  Registration registration(kText);
  const auto first = registration.start(kStart);
  EXPECT_EQ(first.wake, kStart + seconds{5});
  EXPECT_TRUE(registration.on_timer(first.wake).fault);
}

// RD of DM100..103 at unit 00. FCS by the rule of W227: XOR of all characters before it.
Bytes with_fcs(std::string_view text) {
  Bytes out(text.begin(), text.end());
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : out) sum ^= byte;
  static constexpr char kDigits[] = "0123456789ABCDEF";
  out.push_back(static_cast<std::uint8_t>(kDigits[sum >> 4]));
  out.push_back(static_cast<std::uint8_t>(kDigits[sum & 15]));
  out.push_back('*');
  out.push_back('\r');
  return out;
}

TEST(Registration, TheNumberIsReadFromWordsOfThePlc) {
  Registration registration(words_rule());
  EXPECT_EQ(registration.start(kStart).send, with_fcs("@00RD01000004"));
  const Bytes answer = with_fcs(
      "@00RD003137"
      "4142"
      "2020"
      "0000");  // 17 AB blanks NUL
  for (std::size_t i = 0; i + 1 < answer.size(); ++i) {
    const auto outcome = registration.on_bytes(ByteView(answer).subspan(i, 1), kStart);
    ASSERT_FALSE(outcome.number || outcome.fault) << i;
  }
  EXPECT_EQ(registration.on_bytes(ByteView(answer).last(1), kStart).number, "17AB");
}

TEST(Registration, APlcThatIsSilentIsAskedAgainUntilTheTimeIsOver) {
  Registration registration(words_rule());
  auto outcome = registration.start(kStart);
  int asked = 1;
  while (!outcome.fault) {
    ASSERT_LT(asked, 20);
    outcome = registration.on_timer(outcome.wake);
    if (!outcome.send.empty()) ++asked;
  }
  EXPECT_EQ(asked, 5);
  EXPECT_THAT(*outcome.fault, HasSubstr("in time"));
}

TEST(Registration, APartOfAResponseRestartsItsTime) {
  Registration registration(words_rule());
  const Duration response_time = registration.start(kStart).wake - kStart;
  const auto part = registration.on_bytes(raw("@00RD"), kStart + milliseconds{300});
  EXPECT_EQ(part.wake, kStart + milliseconds{300} + response_time);
  const auto early = registration.on_timer(part.wake - milliseconds{1});
  EXPECT_TRUE(early.send.empty());
  EXPECT_EQ(early.wake, part.wake);
  EXPECT_FALSE(registration.on_timer(part.wake).send.empty());
}

TEST(Registration, ABrokenResponseIsAskedAgainInSilence) {
  Registration registration(words_rule());
  (void)registration.start(kStart);
  Bytes broken = with_fcs("@00RD0031370000000000000000");
  broken[8] ^= 1;
  auto outcome = registration.on_bytes(broken, kStart);
  EXPECT_FALSE(outcome.number || outcome.fault);
  EXPECT_TRUE(outcome.send.empty());
  while (outcome.send.empty() && !outcome.fault) outcome = registration.on_timer(outcome.wake);
  EXPECT_EQ(outcome.send, with_fcs("@00RD01000004"));
  EXPECT_EQ(registration
                .on_bytes(with_fcs("@00RD003137"
                                   "0000"
                                   "0000"
                                   "0000"),
                          kStart)
                .number,
            "17");
}

TEST(Registration, AResponseWithoutDigitsIsAskedAgainInSilence) {
  Registration registration(words_rule());
  const Duration response_time = registration.start(kStart).wake - kStart;
  const Instant later = kStart + milliseconds{100};
  auto outcome = registration.on_bytes(with_fcs("@00RD00X137000000000000"), later);
  EXPECT_FALSE(outcome.number || outcome.fault);
  EXPECT_TRUE(outcome.send.empty());
  EXPECT_EQ(outcome.wake, later + response_time);
  while (outcome.send.empty() && !outcome.fault) outcome = registration.on_timer(outcome.wake);
  EXPECT_EQ(outcome.send, with_fcs("@00RD01000004"));
}

TEST(Registration, ARefusalOfThePlcIsAFault) {
  Registration registration(words_rule());
  (void)registration.start(kStart);
  const auto outcome = registration.on_bytes(with_fcs("@00RD15"), kStart);
  EXPECT_THAT(outcome.fault.value_or(""), HasSubstr("refuses"));
}

TEST(Registration, EndsOfLineAloneAreNotAText) {
  Registration registration(kText);
  (void)registration.start(kStart);
  const auto outcome = registration.on_bytes(raw("\r\n\r\n"), kStart);
  EXPECT_FALSE(outcome.number || outcome.fault);
  EXPECT_EQ(registration.on_bytes(raw("17\n"), kStart).number, "17");
}

TEST(Registration, AFloodInsteadOfWordsIsRefused) {
  Registration registration(words_rule());
  (void)registration.start(kStart);
  const auto outcome = registration.on_bytes(Bytes(Registration::kMaxText + 1, 'x'), kStart);
  EXPECT_THAT(outcome.fault.value_or(""), HasSubstr("more bytes arrived than a response"));
}

Bytes modbus(std::string_view hex) {
  Bytes frame = *from_hex(hex);
  append_crc16(frame);
  return frame;
}

TEST(Registration, AModbusPlcHasItsNumberInRegisters) {
  RegistrationRule rule = words_rule();
  rule.protocol = "modbus-rtu";
  rule.area = "holding:";
  rule.unit = 17;
  rule.words = 1;
  const auto after = [&](std::string_view response) {
    Registration registration(rule);
    EXPECT_EQ(registration.start(kStart).send, modbus("11 03 00 64 00 01"));
    return registration.on_bytes(modbus(response), kStart);
  };
  EXPECT_EQ(after("11 03 02 31 37").number, "17");
  EXPECT_THAT(after("11 83 06").fault.value_or(""),
              HasSubstr("the PLC refuses to send its number"));
  EXPECT_THAT(after("11 83 02").fault.value_or(""),
              HasSubstr("the PLC refuses to send its number"));
  const auto malformed = after("11 03 04 31 37 31 37");
  EXPECT_FALSE(malformed.number || malformed.fault);
  EXPECT_TRUE(malformed.send.empty());
  EXPECT_GT(malformed.wake, kStart) << "it retries in silence";
}

TEST(DeviceNumber, IsOneToSixteenLettersOrDigits) {
  for (const char* good :
       {"1", "17", "Press01", "ABCDEFGHIJKLMNOP", "0010", "00012", "000A", "EDX", "FEF", "V1"}) {
    EXPECT_TRUE(is_device_number(good)) << good;
  }
  for (const char* bad : {"", "ABCDEFGHIJKLMNOPQ", "press-1", "press 1", "\xC3\xA4", "a:b", "1\r",
                          "a_b", "a{b", "a@b"}) {
    EXPECT_FALSE(is_device_number(bad)) << bad;
  }
}

TEST(DeviceNumber, IsNothingThatAFrameCouldTakeForSomethingElse) {
  for (const char* bad :
       {"ED", "HB", "0000", "0003", "0009", "FEFF", "1FEFF", "AFEFFB", "V2", "V217"}) {
    EXPECT_FALSE(is_device_number(bad)) << bad;
  }
}

}  // namespace
}  // namespace fieldcast::program
