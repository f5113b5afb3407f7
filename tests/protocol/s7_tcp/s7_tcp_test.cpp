#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "core/protocol/families/registry.hpp"
#include "tests/support/device.hpp"
#include "tests/support/drive.hpp"

namespace fieldcast::test {
namespace {

Bytes bytes(std::string_view digits) { return *from_hex(digits); }

// The structure is that of RFC 1006 and of G. Miru, "The Siemens S7 Communication" (2016); the
// server of Snap7 1.3 gave these responses, with its own number of jobs.
const Bytes kConnect = bytes("0300001611E00000000100C0010AC1020100C2020301");
const Bytes kConfirm = bytes("0300001611D00001000600C0010AC1020100C2020301");
const Bytes kSetUp = bytes("0300001902F08032010000000100080000F0000010001000F0");
const Bytes kGranted = bytes("0300001B02F080320300000001000800000000F0000001000100F0");
const Bytes kReadDb1 = bytes("0300001F02F080320100000001000E00000401120A10020002000184000020");
const Bytes kValue = bytes("0300001B02F0803203000000010002000600000401FF0400101234");

class S7Tcp : public testing::Test {
 protected:
  Outcome read(const std::vector<Bytes>& answers, std::string_view at = "DB1.DBW4",
               std::uint16_t count = 2) {
    const auto exchange = cpu_.protocol().begin(cpu_.read(at, count), {1, &session_});
    return drive(*exchange, answers);
  }
  std::string_view text(std::uint16_t code) const {
    return device_code_text(cpu_.protocol().traits().codes, code);
  }
  const Device cpu_{"s7-tcp", 1};
  Bytes session_;
};

TEST_F(S7Tcp, TheFirstExchangeOfAConnectionConnectsAndSetsUp) {
  const Outcome first = read({kConfirm, kGranted, kValue});
  ASSERT_TRUE(first.done()) << to_text(first);
  EXPECT_EQ(first.sent, (std::vector<Bytes>{kConnect, kSetUp, kReadDb1}));
  EXPECT_EQ(first.reply[0].items, (Bytes{0x12, 0x34}));
  const Outcome second = read({kValue});
  ASSERT_TRUE(second.done()) << to_text(second);
  EXPECT_EQ(second.sent, std::vector<Bytes>{kReadDb1});
}

TEST_F(S7Tcp, AConnectionWhoseSetUpWasLostSetsUpAgain) {
  EXPECT_EQ(read({kConfirm}).cause, Cause::kNoResponse);
  const Outcome second = read({kGranted, kValue});
  ASSERT_TRUE(second.done()) << to_text(second);
  EXPECT_EQ(second.sent, (std::vector<Bytes>{kSetUp, kReadDb1}));
}

TEST_F(S7Tcp, ARefusedConnectSaysWhyAndEndsTheConnection) {
  const Outcome outcome = read({bytes("0300000B06800001000003")});
  EXPECT_EQ(outcome.cause, Cause::kMalformed);
  EXPECT_EQ(text(outcome.code), "ISO-on-TCP: no such rack, slot or TSAP, or no connection is left");
  EXPECT_TRUE(session_.empty());
}

TEST_F(S7Tcp, ASmallerPduThanTheOptionIsRefused) {
  const Device wide("s7-tcp", 1, {{"pdu", "480"}});
  const auto exchange = wide.protocol().begin(wide.read("DB1.DBW4", 2), {1, &session_});
  const Outcome outcome = drive(*exchange, std::vector<Bytes>{kConfirm, kGranted});
  EXPECT_EQ(outcome.cause, Cause::kDeviceError);
  EXPECT_EQ(text(outcome.code), "S7: the CPU grants a smaller PDU than the option pdu");
}

TEST_F(S7Tcp, AProtectedCpuSaysWhy) {
  session_ = {1, 1};
  const Outcome outcome = read({bytes("0300001302F080320300000001000000008104")});
  EXPECT_EQ(outcome.cause, Cause::kDeviceError);
  EXPECT_EQ(text(outcome.code), "function not available: the CPU does not permit PUT/GET access");
}

TEST_F(S7Tcp, AResponseToAnotherRequestIsForeign) {
  session_ = {1, 1};
  Bytes other = kValue;
  other[12] = 9;  // reference
  EXPECT_EQ(read({other}).cause, Cause::kForeign);
}

TEST_F(S7Tcp, ABrokenStreamFailsImmediately) {
  session_ = {1, 1};
  for (const std::string_view stream :
       {"04", "03000003", "0300FFFF", "0300000702F000", "0300000701F080", "03000007FFF080"}) {
    const Outcome outcome = read({bytes(stream)});
    EXPECT_EQ(outcome.cause, Cause::kMalformed) << stream;
    EXPECT_FALSE(outcome.waited) << stream;
  }
}

TEST_F(S7Tcp, ReadsStayWithinADataBlockAndThePdu) {
  EXPECT_TRUE(cpu_.protocol().size(cpu_.read("DB1.DBB0", 222)).has_value());
  EXPECT_FALSE(cpu_.protocol().size(cpu_.read("DB1.DBB0", 223)).has_value());
  EXPECT_TRUE(cpu_.protocol().size(cpu_.read("DB1.DBB65535", 1)).has_value());
  EXPECT_FALSE(cpu_.protocol().size(cpu_.read("DB1.DBB65535", 2)).has_value());
}

TEST_F(S7Tcp, ADateAndTimeIsATextOfItsBytes) {
  session_ = {1, 1};
  const Outcome outcome = read({bytes("0300002502F0803203000000010002001000000401FF040060"
                                      "07EA0B1C070A0F0000000000")},
                               "DB1.DTL4", 12);
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(outcome.sent[0],
            bytes("0300001F02F080320100000001000E00000401120A1002000C000184000020"));
  const auto old = cpu_.protocol().parse_address("DB1.DT4");
  EXPECT_EQ(old->text_layout, TextLayout::kDateAndTime);
  EXPECT_EQ(old->text_characters, 23);
}

TEST_F(S7Tcp, TheTsapIsThatOfTheOption) {
  const Device logo("s7-tcp", 0, {{"cpu", "s7-200"}, {"tsap", "20.00"}, {"local-tsap", "10.00"}});
  const auto exchange = logo.protocol().begin(logo.read("VW4", 2), {1, &session_});
  const Outcome outcome = drive(*exchange, std::vector<Bytes>{kConfirm, kGranted, kValue});
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(outcome.sent[0], bytes("0300001611E00000000100C0010AC1021000C2022000"));
  EXPECT_EQ(outcome.sent[2], kReadDb1);  // V is data block 1
}

TEST_F(S7Tcp, AFrameIsExplained) {
  const auto explain = find_protocol("s7-tcp")->explain;
  for (const Bytes& frame : {kConnect, kConfirm, kSetUp, kGranted, kReadDb1, kValue}) {
    for (const FrameField& field : explain(frame)) EXPECT_EQ(field.fault, "") << field.name;
  }
  EXPECT_TRUE(std::ranges::any_of(explain(ByteView(kReadDb1).first(20)),
                                  [](const auto& field) { return !field.fault.empty(); }));
}

}  // namespace
}  // namespace fieldcast::test
