#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "core/protocol/families/registry.hpp"
#include "tests/support/device.hpp"
#include "tests/support/drive.hpp"

namespace fieldcast::test {
namespace {

Bytes bytes(std::string_view digits) {
  Bytes out;
  for (std::size_t at = 0; at < digits.size(); ++at) {
    if (digits[at] != ' ')
      out.push_back(
          static_cast<std::uint8_t>(std::stoul(std::string(digits.substr(at, 2)), nullptr, 16))),
          ++at;
  }
  return out;
}

// The frames of the greeting are those of Omron W421, 7-4-2; the messages follow W342, 5-3-2.
const Bytes kGreeting = bytes("46494E53 0000000C 00000000 00000000 00000000");
const Bytes kNodes = bytes("46494E53 00000010 00000001 00000000 000000EF 0000000A");
const Bytes kReadDm100 =
    bytes("46494E53 0000001A 00000002 00000000 80 00 02 00 0A 00 00 EF 00 01 0101 82 0064 00 0001");
const Bytes kValue =
    bytes("46494E53 00000018 00000002 00000000 C0 00 02 00 EF 00 00 0A 00 01 0101 0000 1234");

class FinsTcp : public testing::Test {
 protected:
  Outcome read(std::vector<Bytes> answers, std::string_view at = "DM100", std::uint16_t count = 1) {
    const auto exchange = plc_.protocol().begin(plc_.read(at, count), {1, &session_});
    return drive(*exchange, answers);
  }
  const Device plc_{"omron-fins", 10};
  Bytes session_;
};

TEST_F(FinsTcp, TheFirstExchangeOfAConnectionSendsTheGreeting) {
  const Outcome first = read({kNodes, kValue});
  ASSERT_TRUE(first.done()) << to_text(first);
  EXPECT_EQ(first.sent, (std::vector<Bytes>{kGreeting, kReadDm100}));
  EXPECT_EQ(first.reply[0].items, (Bytes{0x12, 0x34}));
  const Outcome second = read({kValue});
  ASSERT_TRUE(second.done()) << to_text(second);
  EXPECT_EQ(second.sent, std::vector<Bytes>{kReadDm100});
}

TEST_F(FinsTcp, SilenceAfterTheGreetingIsNoResponse) {
  EXPECT_EQ(read({kNodes}).cause, Cause::kNoResponse);
}

TEST_F(FinsTcp, AddressZeroIsThePlcOfTheConnection) {
  const Device any("omron-fins", 0);
  const auto exchange = any.protocol().begin(any.read("DM100", 1), {1, &session_});
  EXPECT_EQ(drive(*exchange, std::vector<Bytes>{kNodes, kValue}).sent[1], kReadDm100);
}

TEST_F(FinsTcp, ARefusedGreetingSaysWhy) {
  const Outcome outcome = read({bytes("46494E53 00000008 00000001 00000020")});
  EXPECT_EQ(outcome.cause, Cause::kDeviceBusy);
  EXPECT_EQ(device_code_text(plc_.protocol().traits().codes, outcome.code),
            "FINS/TCP: all connections are in use");
  EXPECT_TRUE(session_.empty());
}

// The PLC assigns nodes once for each connection: only the bus, when it opens the port, ends them.
TEST_F(FinsTcp, AnErrorOfTheFrameKeepsTheNodes) {
  ASSERT_TRUE(read({kNodes, kValue}).done());
  const Outcome outcome = read({bytes("46494E53 00000008 00000003 00000003")});
  EXPECT_EQ(outcome.cause, Cause::kDeviceError);
  EXPECT_EQ(outcome.code, 0x7003);
  EXPECT_EQ(session_, (Bytes{0xEF, 0x0A}));
}

TEST_F(FinsTcp, AResponseOfAnotherNodeIsForeign) {
  session_ = {0xEF, 0x0A};
  Bytes other = kValue;
  other[16 + 7] = 0x0B;  // SA1
  EXPECT_EQ(read({other}).cause, Cause::kForeign);
}

TEST_F(FinsTcp, ABrokenStreamFailsImmediately) {
  session_ = {0xEF, 0x0A};
  for (const std::string_view stream : {"46494E54", "46494E53 00000007", "46494E53 7FFFFFFF"}) {
    const Outcome outcome = read({bytes(stream)});
    EXPECT_EQ(outcome.cause, Cause::kMalformed) << stream;
    EXPECT_FALSE(outcome.waited) << stream;
  }
}

TEST_F(FinsTcp, AnEndCodeIsThatOfTheCommand) {
  session_ = {0xEF, 0x0A};
  const Outcome outcome =
      read({bytes("46494E53 00000016 00000002 00000000 C0 00 02 00 EF 00 00 0A 00 01 0101 1103")});
  EXPECT_EQ(outcome.cause, Cause::kDeviceError);
  EXPECT_EQ(outcome.code, 0x1103);
}

TEST_F(FinsTcp, LongReadsUseLongMessages) {
  EXPECT_TRUE(plc_.protocol().size(plc_.read("DM0", 999)).has_value());
  EXPECT_FALSE(plc_.protocol().size(plc_.read("DM0", 1000)).has_value());
}

TEST_F(FinsTcp, AFrameIsExplained) {
  const auto fields = find_protocol("omron-fins")->explain(kReadDm100);
  EXPECT_TRUE(std::ranges::none_of(fields, [](const auto& field) { return !field.fault.empty(); }));
  const auto broken = find_protocol("omron-fins")->explain(ByteView(kReadDm100).first(30));
  EXPECT_TRUE(std::ranges::any_of(broken, [](const auto& field) { return !field.fault.empty(); }));
}

class FinsUdp : public testing::Test {
 protected:
  Outcome read(std::vector<Bytes> responses) {
    const auto exchange = plc_.protocol().begin(plc_.read("DM100", 1), {1, nullptr});
    return drive(*exchange, responses);
  }
  const Device plc_{"omron-fins", 10, {{"client-node", "239"}}};
  const Bytes value_ = bytes("C0 00 02 00 EF 00 00 0A 00 01 0101 0000 1234");
};

TEST_F(FinsUdp, AMessageIsADatagramWithoutGreeting) {
  const Outcome outcome = read({value_});
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(outcome.sent,
            std::vector<Bytes>{bytes("80 00 02 00 0A 00 00 EF 00 01 0101 82 0064 00 0001")});
  EXPECT_EQ(outcome.reply[0].items, (Bytes{0x12, 0x34}));
}

TEST_F(FinsUdp, AResponseToAnotherRequestOrOfAnotherNodeIsForeign) {
  for (const std::size_t at : {4U, 7U, 9U}) {  // DA1, SA1, SID
    Bytes other = value_;
    other[at] ^= 0x10;
    EXPECT_EQ(read({other}).cause, Cause::kForeign) << at;
  }
}

TEST_F(FinsUdp, APartOfAResponseIsNoValue) {
  for (std::size_t size = 1; size < value_.size(); ++size)
    EXPECT_FALSE(
        read({Bytes(value_.begin(), value_.begin() + static_cast<std::ptrdiff_t>(size))}).done())
        << size;
}

TEST_F(FinsUdp, TheNodesMustBeKnownAndDiffer) {
  for (const auto& [address, client, option] :
       {std::tuple{0, "239", ""}, std::tuple{10, "10", "client-node"},
        std::tuple{10, "0", "client-node"}, std::tuple{10, "255", "client-node"}}) {
    const DeviceLink link{.address = static_cast<std::uint16_t>(address),
                          .options = {{"client-node", client}}};
    const auto made = find_protocol("omron-fins")->make(link);
    ASSERT_FALSE(made.has_value()) << client;
    EXPECT_EQ(made.error().option, option) << client;
  }
}

TEST_F(FinsUdp, ADatagramIsExplained) {
  const auto fields = find_protocol("omron-fins")->explain(value_);
  EXPECT_TRUE(std::ranges::none_of(fields, [](const auto& field) { return !field.fault.empty(); }));
  EXPECT_TRUE(std::ranges::any_of(fields, [](const auto& field) { return field.name == "SID"; }));
}

}  // namespace
}  // namespace fieldcast::test
