#include "core/gateway/client_session.hpp"

#include <gtest/gtest.h>

namespace fieldcast::gateway {
namespace {

using namespace std::chrono_literals;

class ClientSessionTest : public testing::Test {
 protected:
  static BusSpec bus() {
    BusSpec bus;
    bus.gateway.emplace();
    for (const int address : {1, 17}) {
      DeviceSpec& device = bus.devices.emplace_back();
      device.name = "unit-" + std::to_string(address);
      device.link.address = static_cast<std::uint16_t>(address);
    }
    return bus;
  }
  // Returns the response, or an empty text.
  std::string send(std::string_view hex) {
    Bytes out;
    valid_ = session_.on_bytes(*from_hex(hex), Instant{5s}, out, commands_).has_value();
    return to_hex(out);
  }
  std::string complete(const Command command, std::vector<Value> values, Cause cause = {}) {
    CommandResult result;
    result.requester = command.requester;
    result.request_id = command.request_id;
    result.state = cause == Cause::kNone ? CommandState::kDone : CommandState::kFailed;
    result.cause = cause;
    result.values = std::move(values);
    result.completed = Instant{7s};
    Bytes out;
    session_.on_result(result, out, commands_);
    return to_hex(out);
  }

  const BusSpec bus_ = bus();
  GatewaySpec spec_ = *bus_.gateway;
  const Units units_ = units_of(bus_);
  Counters counters_;
  ClientSession session_{spec_, units_, "gateway 127.0.0.1:40000", 100, counters_};
  std::vector<Command> commands_;
  bool valid_ = false;
};

TEST_F(ClientSessionTest, ARequestBecomesACommandAndItsResultTheResponse) {
  EXPECT_EQ(send("00 07 00 00 00 06 11 03 00 05 00 01"), "");
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].device, "unit-17");
  EXPECT_EQ(commands_[0].requester, "gateway 127.0.0.1:40000");
  EXPECT_EQ(commands_[0].request_id, 100u);
  EXPECT_EQ(commands_[0].expires, Instant{5s} + spec_.timeout);
  EXPECT_EQ(commands_[0].max_age, spec_.max_age);
  EXPECT_EQ(complete(commands_[0], {Value{std::uint64_t{0x0A0B}}}),
            "00 07 00 00 00 05 11 03 02 0A 0B");
  EXPECT_EQ(complete(commands_[0], {Value{std::uint64_t{1}}}), "") << "one response for each";
  EXPECT_EQ(session_.pending(), 0u);
  EXPECT_EQ(counters_.requests, 1u);
  EXPECT_EQ(counters_.refused_requests, 0u);
}

TEST_F(ClientSessionTest, ADeviceOfAnotherProtocolHasTheAddressesOfItsRows) {
  spec_.rows["unit-17"] = {{.first = 0, .count = 4, .at = "DM100"}};
  EXPECT_EQ(send("00 07 00 00 00 06 11 03 00 02 00 02"), "");
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(std::get<AddressTarget>(commands_[0].target).skip, 2u);
  EXPECT_EQ(send("00 08 00 00 00 06 11 03 00 02 00 03"), "00 08 00 00 00 03 11 83 02");
  EXPECT_EQ(send("00 09 00 00 00 06 01 03 00 02 00 03"), "") << "a Modbus device";
}

TEST_F(ClientSessionTest, RequestsArriveInPiecesAndTogether) {
  const Bytes two =
      *from_hex("00 01 00 00 00 06 01 03 00 05 00 01 00 02 00 00 00 06 11 01 00 05 00 01");
  for (const std::uint8_t byte : two) (void)send(to_hex({&byte, 1}));
  EXPECT_EQ(commands_.size(), 2u);
  (void)send(to_hex(two));
  EXPECT_EQ(commands_.size(), 4u);
  EXPECT_EQ(complete(commands_[3], {Value{true}}), "00 02 00 00 00 04 11 01 01 01");
  EXPECT_EQ(complete(commands_[0], {Value{std::uint64_t{3}}}), "00 01 00 00 00 05 01 03 02 00 03");
}

TEST_F(ClientSessionTest, AnUnknownUnitHasNoPath) {
  EXPECT_EQ(send("00 01 00 00 00 06 02 03 00 05 00 01"), "00 01 00 00 00 03 02 83 0A");
  EXPECT_EQ(counters_.refused_requests, 1u);
  EXPECT_TRUE(commands_.empty());
}

TEST_F(ClientSessionTest, WritesNeedThePermission) {
  EXPECT_EQ(send("00 01 00 00 00 06 01 06 00 05 00 01"), "00 01 00 00 00 03 01 86 01");
  spec_.writes = spec_.verify = true;
  EXPECT_EQ(send("00 01 00 00 00 06 01 06 00 05 00 01"), "");
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, Operation::kWrite);
  EXPECT_TRUE(commands_[0].verify);
}

// Modbus Application Protocol V1.1b3, 6.17.
constexpr std::string_view kReadWrite = "00 07 00 00 00 0D 01 17 00 03 00 02 00 0E 00 01 02 00 FF";

TEST_F(ClientSessionTest, Function23WritesAndThenReads) {
  spec_.writes = true;
  spec_.max_age = 1s;
  EXPECT_EQ(send(kReadWrite), "");
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(commands_[0].operation, Operation::kWrite);
  EXPECT_EQ(std::get<AddressTarget>(commands_[0].target).at, "holding:14");
  EXPECT_EQ(commands_[0].values, std::vector<Value>{Value{std::uint64_t{0xFF}}});
  EXPECT_EQ(complete(commands_[0], {}), "") << "the read is still to come";
  ASSERT_EQ(commands_.size(), 2u);
  EXPECT_TRUE(commands_[1].is_gateway_read());
  EXPECT_NE(commands_[1].request_id, commands_[0].request_id);
  EXPECT_EQ(std::get<AddressTarget>(commands_[1].target).at, "holding:3");
  EXPECT_EQ(commands_[1].count, 2u);
  EXPECT_EQ(commands_[1].max_age, 0s) << "no response from before the write";
  EXPECT_EQ(commands_[1].expires, Instant{7s} + spec_.timeout);
  EXPECT_EQ(complete(commands_[0], {}), "") << "it ended";
  EXPECT_EQ(complete(commands_[1], {Value{std::uint64_t{0xFE}}, Value{std::uint64_t{0x0ACD}}}),
            "00 07 00 00 00 07 01 17 04 00 FE 0A CD");
  EXPECT_EQ(session_.pending(), 0u);
  EXPECT_EQ(commands_.size(), 2u);
}

TEST_F(ClientSessionTest, Function23DoesNotReadAfterAFailedWrite) {
  spec_.writes = true;
  (void)send(kReadWrite);
  EXPECT_EQ(complete(commands_[0], {}, Cause::kNoResponse), "00 07 00 00 00 03 01 97 0B");
  EXPECT_EQ(commands_.size(), 1u);
  (void)send(kReadWrite);
  EXPECT_EQ(complete(commands_[1], {}), "");
  EXPECT_EQ(complete(commands_[2], {}, Cause::kExpired), "00 07 00 00 00 03 01 97 06");
  spec_.writes = false;
  EXPECT_EQ(send(kReadWrite), "00 07 00 00 00 03 01 97 01");
}

TEST_F(ClientSessionTest, ADeviceOfAnotherProtocolIsWrittenAndReadButNotMasked) {
  spec_.writes = true;
  spec_.rows["unit-1"] = {{.first = 0, .count = 16, .at = "DM100"}};
  EXPECT_EQ(send("00 08 00 00 00 08 01 16 00 04 00 F2 00 25"), "00 08 00 00 00 03 01 96 01");
  EXPECT_EQ(send("00 07 00 00 00 0D 01 17 00 30 00 02 00 0E 00 01 02 00 FF"),
            "00 07 00 00 00 03 01 97 02")
      << "no row is read";
  EXPECT_TRUE(commands_.empty()) << "nothing is written then";
  EXPECT_EQ(send(kReadWrite), "");
  EXPECT_EQ(complete(commands_[0], {}), "");
  EXPECT_EQ(std::get<AddressTarget>(commands_[1].target).skip, 3u);
}

TEST_F(ClientSessionTest, TooManyRequestsInFlightAreRefusedAsBusy) {
  for (std::size_t i = 0; i < ClientSession::kMaxPending; ++i)
    EXPECT_EQ(send("00 01 00 00 00 06 01 03 00 05 00 01"), "");
  EXPECT_EQ(send("00 01 00 00 00 06 01 03 00 05 00 01"), "00 01 00 00 00 03 01 83 06");
  (void)complete(commands_[0], {Value{std::uint64_t{3}}});
  EXPECT_EQ(send("00 01 00 00 00 06 01 03 00 05 00 01"), "");
}

TEST_F(ClientSessionTest, BytesThatAreNotModbusTcpEndTheSession) {
  (void)send("47 45 54 20 2F 20 48 54 54 50");  // GET / HTTP
  EXPECT_FALSE(valid_);
}

TEST_F(ClientSessionTest, AnInvalidRequestIsRefusedWithItsException) {
  EXPECT_EQ(session_.requester(), "gateway 127.0.0.1:40000");
  EXPECT_EQ(send("00 01 00 00 00 06 01 03 00 05 00 00"), "00 01 00 00 00 03 01 83 03");
  EXPECT_EQ(counters_.refused_requests, 1u);
  spec_.writes = true;
  spec_.rows["unit-1"] = {{.first = 0, .count = 2, .type = ValueType::kFloat32, .at = "DM100"}};
  EXPECT_EQ(send("00 02 00 00 00 0B 01 10 00 00 00 02 04 7F C0 00 00"),
            "00 02 00 00 00 03 01 90 03")
      << "no number";
  EXPECT_TRUE(commands_.empty());
}

TEST_F(ClientSessionTest, Function23ReadsAfterAVerifiedWrite) {
  spec_.writes = spec_.verify = true;
  (void)send(kReadWrite);
  ASSERT_EQ(commands_.size(), 1u);
  CommandResult verified;
  verified.request_id = commands_[0].request_id;
  verified.state = CommandState::kVerified;
  verified.completed = Instant{7s};
  Bytes out;
  session_.on_result(verified, out, commands_);
  EXPECT_TRUE(out.empty());
  ASSERT_EQ(commands_.size(), 2u);
  EXPECT_TRUE(commands_[1].is_gateway_read());
}

TEST(Units, AreTheAddressesOrAsConfigured) {
  BusSpec bus;
  bus.gateway.emplace();
  bus.devices.resize(2);
  bus.devices[0].name = "a";
  bus.devices[0].link.address = 3;
  bus.devices[1].name = "b";
  bus.devices[1].link.address = 300;
  EXPECT_EQ(units_of(bus), (Units{{3, "a"}})) << "no unit has the number 300";
  bus.gateway->units = {{9, "b"}};
  EXPECT_EQ(units_of(bus), (Units{{9, "b"}}));
}

}  // namespace
}  // namespace fieldcast::gateway
