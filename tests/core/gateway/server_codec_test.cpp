#include "core/gateway/server_codec.hpp"

#include <gtest/gtest.h>

namespace fieldcast::gateway {
namespace {

Bytes hex(std::string_view text) { return *from_hex(text); }

// A request in the frame of unit 0x11.
RequestFrame frame_of(const Bytes& pdu) { return {0x1234, 0x11, pdu, 7 + pdu.size()}; }

Exception fault_of(std::string_view pdu) {
  const auto request = decode(hex(pdu));
  EXPECT_FALSE(request) << pdu;
  return request ? Exception::kDeviceFailure : request.error();
}

CommandResult done(std::vector<Value> values = {}) {
  CommandResult result;
  result.state = CommandState::kDone;
  result.values = std::move(values);
  return result;
}

CommandResult failed(Cause cause, std::uint16_t code = 0) {
  CommandResult result;
  result.cause = cause;
  result.device_code = code;
  return result;
}

TEST(ServerCodec, AFrameIsWholeOrNeedsMoreOrIsNone) {
  const Bytes whole = hex("00 01 00 00 00 06 11 03 00 6B 00 03 AA");
  for (std::size_t size = 0; size < 12; ++size) {
    const auto frame = first_frame(ByteView(whole).first(size));
    ASSERT_TRUE(frame && !*frame) << size;
  }
  const auto frame = first_frame(whole);
  ASSERT_TRUE(frame && *frame);
  EXPECT_EQ((*frame)->transaction, 1);
  EXPECT_EQ((*frame)->unit, 0x11);
  EXPECT_EQ(to_hex((*frame)->pdu), "03 00 6B 00 03");
  EXPECT_EQ((*frame)->size, 12u);
  EXPECT_EQ(first_frame(hex("00 01 00 01 00 06")).error(), FrameFault::kProtocol);
  EXPECT_EQ(first_frame(hex("00 01 01 00 00 06")).error(), FrameFault::kProtocol);
  EXPECT_EQ(first_frame(hex("00 01 00 00 00 01")).error(), FrameFault::kLength) << "no function";
  EXPECT_EQ(first_frame(hex("00 01 00 00 00 FF")).error(), FrameFault::kLength) << "254 bytes";
  EXPECT_TRUE(first_frame(hex("00 01 00 00 00 FE"))) << "unit and 253 bytes";
}

TEST(ServerCodec, ReadsNameTheirArea) {
  const std::pair<std::string_view, std::string_view> kReads[] = {
      {"01 00 13 00 25", "coil:19"},
      {"02 00 C4 00 16", "input:196"},
      {"03 00 6B 00 03", "holding:107"},
      {"04 00 08 00 01", "input-register:8"}};
  for (const auto& [pdu, at] : kReads) {
    const auto request = decode(hex(pdu));
    ASSERT_TRUE(request) << pdu;
    const Command command = command_of(*request, "press").value();
    EXPECT_EQ(std::get<AddressTarget>(command.target).at, at);
    EXPECT_EQ(command.count, hex(pdu)[4]);
    EXPECT_TRUE(command.is_gateway_read());
    EXPECT_EQ(command.device, "press");
  }
}

TEST(ServerCodec, WritesCarryTheirValues) {
  const auto values_of = [](std::string_view pdu) {
    return command_of(decode(hex(pdu)).value(), "press").value().values;
  };
  const std::vector<Value> on{Value{true}}, off{Value{false}};
  EXPECT_EQ(values_of("05 00 AC FF 00"), on);
  EXPECT_EQ(values_of("05 00 AC 00 00"), off);
  EXPECT_EQ(values_of("06 00 01 12 34"), (std::vector<Value>{Value{std::uint64_t{0x1234}}}));
  EXPECT_EQ(
      values_of("0F 00 13 00 0A 02 CD 01"),
      (std::vector<Value>{Value{true}, Value{false}, Value{true}, Value{true}, Value{false},
                          Value{false}, Value{true}, Value{true}, Value{true}, Value{false}}));
  EXPECT_EQ(values_of("10 00 01 00 02 04 00 0A 01 02"),
            (std::vector<Value>{Value{std::uint64_t{10}}, Value{std::uint64_t{0x0102}}}));
}

TEST(ServerCodec, AMaskIsWrittenAsSuch) {
  const Command command = command_of(decode(hex("16 00 04 00 F2 00 25")).value(), "press").value();
  EXPECT_EQ(std::get<AddressTarget>(command.target).at, "holding:4");
  EXPECT_EQ(command.operation, Operation::kWrite);
  EXPECT_EQ(command.mask, 0xFF0D);
  EXPECT_EQ(command.values, std::vector<Value>{Value{std::uint64_t{0x25}}});
}

const std::vector<GatewayRow> kRows{
    {.first = 100, .count = 10, .at = "DB1.DBW0"},
    {.first = 200, .count = 3, .type = ValueType::kFloat32, .at = "DB1.DBD20"},
    {.bits = true, .first = 0, .count = 16, .type = ValueType::kBool, .at = "M0.0"}};

// The request, with the row that contains it.
ClientRequest mapped(std::string_view pdu) {
  ClientRequest request = decode(hex(pdu)).value();
  request.row = row_of(kRows, request);
  return request;
}

TEST(ServerCodec, ARowNamesTheAddressesOfAnotherProtocol) {
  const auto target = [](std::string_view pdu) {
    const Command command = command_of(mapped(pdu), "plc").value();
    const auto& at = std::get<AddressTarget>(command.target);
    return std::tuple(at.at, at.skip, command.count, at.encoding.type);
  };
  EXPECT_EQ(target("03 00 66 00 03"), std::tuple("DB1.DBW0", 2u, 3u, ValueType::kUint16));
  EXPECT_EQ(target("04 00 64 00 0A"), std::tuple("DB1.DBW0", 0u, 10u, ValueType::kUint16));
  EXPECT_EQ(target("03 00 CA 00 04"), std::tuple("DB1.DBD20", 1u, 2u, ValueType::kFloat32));
  EXPECT_EQ(target("01 00 08 00 08"), std::tuple("M0.0", 8u, 8u, ValueType::kBool));
  EXPECT_EQ(target("05 00 0F FF 00"), std::tuple("M0.0", 15u, 1u, ValueType::kBool));
}

TEST(ServerCodec, NoRowContainsPartsOfValuesOrOtherAddresses) {
  for (const auto* pdu : {"03 00 63 00 02", "03 00 6E 00 01", "03 00 6D 00 02", "03 00 C9 00 02",
                          "03 00 C8 00 01", "06 00 C8 00 01", "01 00 10 00 01", "01 00 64 00 01"})
    EXPECT_EQ(mapped(pdu).row, nullptr) << pdu;
}

TEST(ServerCodec, AWideValueHasItsHighestBitsFirst) {
  const Bytes request = hex("03 00 C8 00 04");
  EXPECT_EQ(to_hex(response(frame_of(request), mapped("03 00 C8 00 04"), done({1.5, -2.0}))),
            "12 34 00 00 00 0B 11 03 08 3F C0 00 00 C0 00 00 00");
  const auto written = command_of(mapped("10 00 C8 00 02 04 3F C0 00 00"), "plc");
  ASSERT_TRUE(written);
  EXPECT_EQ(written->values, std::vector<Value>{1.5});
  EXPECT_EQ(command_of(mapped("10 00 C8 00 02 04 7F C0 00 00"), "plc").error(),
            Exception::kIllegalValue)
      << "no number";
}

TEST(ServerCodec, CodesOfOtherProtocolsAreNoExceptions) {
  EXPECT_EQ(exception_code(failed(Cause::kDeviceError, 5), true), 5);
  EXPECT_EQ(exception_code(failed(Cause::kDeviceError, 5), false), 4);
  EXPECT_EQ(exception_code(failed(Cause::kDeviceBusy, 5), false), 6);
  EXPECT_EQ(exception_code(failed(Cause::kNoResponse), false), 0x0B);
}

// Modbus Application Protocol V1.1b3, the state diagrams of 6.1-6.12.
TEST(ServerCodec, InvalidRequestsGetTheExceptionOfTheStandard) {
  EXPECT_EQ(fault_of("07"), Exception::kIllegalFunction);
  EXPECT_EQ(fault_of("18 04 DE"), Exception::kIllegalFunction);
  EXPECT_EQ(fault_of("83 02"), Exception::kIllegalFunction);
  EXPECT_EQ(fault_of("03 00 00 00 00"), Exception::kIllegalValue);
  EXPECT_EQ(fault_of("03 00 00 00 7E"), Exception::kIllegalValue) << "126 registers";
  EXPECT_EQ(fault_of("01 00 00 07 D1"), Exception::kIllegalValue) << "2001 coils";
  EXPECT_EQ(fault_of("0F 00 00 07 B1 F7"), Exception::kIllegalValue) << "1969 coils";
  EXPECT_EQ(fault_of("03 00 00 00"), Exception::kIllegalValue) << "short";
  EXPECT_EQ(fault_of("03 00 00 00 01 00"), Exception::kIllegalValue) << "long";
  EXPECT_EQ(fault_of("05 00 00 12 34"), Exception::kIllegalValue) << "neither on nor off";
  EXPECT_EQ(fault_of("10 00 00 00 02 03 00 01 00"), Exception::kIllegalValue) << "byte count";
  EXPECT_EQ(fault_of("0F 00 00 00 09 01 00"), Exception::kIllegalValue) << "byte count";
  EXPECT_EQ(fault_of("16 00 04 00 F2 00"), Exception::kIllegalValue) << "short";
  EXPECT_EQ(fault_of("17 00 03 00 7E 00 0E 00 01 02 00 FF"), Exception::kIllegalValue)
      << "126 registers to read";
  EXPECT_EQ(fault_of("17 00 03 00 06 00 0E 00 02 02 00 FF"), Exception::kIllegalValue)
      << "byte count";
  EXPECT_EQ(fault_of("17 00 03 00 06 00 0E 00 00 00"), Exception::kIllegalValue);
  EXPECT_EQ(fault_of("17 00 03 00 00 00 0E 00 01 02 00 FF"), Exception::kIllegalValue)
      << "nothing to read";
  EXPECT_EQ(fault_of("17 FF FF 00 02 00 0E 00 01 02 00 FF"), Exception::kIllegalAddress);
  EXPECT_EQ(fault_of("17 00 03 00 02 FF FF 00 02 04 00 FF 00 FF"), Exception::kIllegalAddress);
  EXPECT_EQ(fault_of("00 00 00 00 01"), Exception::kIllegalFunction);
  EXPECT_EQ(fault_of("03 FF FF 00 02"), Exception::kIllegalAddress);
  EXPECT_TRUE(decode(hex("03 FF FF 00 01")));
  EXPECT_TRUE(decode(hex("01 00 00 07 D0")));
}

TEST(ServerCodec, AResponseIsThatOfTheDevice) {
  const auto response_of = [](std::string_view pdu, const CommandResult& result) {
    const Bytes request = hex(pdu);
    return to_hex(response(frame_of(request), decode(request).value(), result));
  };
  EXPECT_EQ(response_of("03 00 6B 00 02",
                        done({Value{std::uint64_t{0x022B}}, Value{std::uint64_t{0xFFFF}}})),
            "12 34 00 00 00 07 11 03 04 02 2B FF FF");
  std::vector<Value> bits(10, Value{false});
  bits[0] = bits[2] = bits[3] = bits[6] = bits[7] = bits[8] = Value{true};
  EXPECT_EQ(response_of("01 00 13 00 0A", done(bits)), "12 34 00 00 00 05 11 01 02 CD 01");
  EXPECT_EQ(response_of("05 00 AC FF 00", done()), "12 34 00 00 00 06 11 05 00 AC FF 00");
  EXPECT_EQ(response_of("05 00 AC 00 00", done()), "12 34 00 00 00 06 11 05 00 AC 00 00");
  CommandResult verified = done();
  verified.state = CommandState::kVerified;
  EXPECT_EQ(response_of("05 00 AC FF 00", verified), "12 34 00 00 00 06 11 05 00 AC FF 00");
  EXPECT_EQ(response_of("03 00 6B 00 01", done({Value{std::string("text")}})),
            "12 34 00 00 00 03 11 83 04")
      << "no register";
  EXPECT_EQ(response_of("06 00 01 12 34", done()), "12 34 00 00 00 06 11 06 00 01 12 34");
  EXPECT_EQ(response_of("10 00 01 00 02 04 00 0A 01 02", done()),
            "12 34 00 00 00 06 11 10 00 01 00 02");
  EXPECT_EQ(response_of("0F 00 13 00 0A 02 CD 01", done()), "12 34 00 00 00 06 11 0F 00 13 00 0A");
  EXPECT_EQ(response_of("16 00 04 00 F2 00 25", done()),
            "12 34 00 00 00 08 11 16 00 04 00 F2 00 25");
  EXPECT_EQ(response_of("03 00 6B 00 02", done({Value{std::uint64_t{1}}})),
            "12 34 00 00 00 03 11 83 04")
      << "a value is missing";
  EXPECT_EQ(response_of("03 00 6B 00 01", failed(Cause::kDeviceError, 2)),
            "12 34 00 00 00 03 11 83 02");
}

// Modbus Application Protocol V1.1b3, 7.
TEST(ServerCodec, EachCauseHasItsException) {
  const auto code_of = [](Cause cause, std::uint16_t code = 0) {
    return static_cast<Exception>(exception_code(failed(cause, code)));
  };
  EXPECT_EQ(code_of(Cause::kDeviceBusy, 6), Exception::kBusy) << "the device's own";
  EXPECT_EQ(code_of(Cause::kDeviceError, 0), Exception::kDeviceFailure);
  EXPECT_EQ(code_of(Cause::kDeviceError, 0x100), Exception::kDeviceFailure) << "no exception code";
  EXPECT_EQ(code_of(Cause::kDeviceError, 1), Exception::kIllegalFunction);
  const std::pair<Exception, std::vector<Cause>> kExceptions[] = {
      {Exception::kIllegalFunction, {Cause::kRawNotAllowed, Cause::kReadOnly, Cause::kUnsupported}},
      {Exception::kIllegalAddress, {Cause::kBadAddress}},
      {Exception::kIllegalValue, {Cause::kRange, Cause::kWrongType}},
      {Exception::kBusy,
       {Cause::kExpired, Cause::kQueueFull, Cause::kRateLimited, Cause::kLeased,
        Cause::kForeignMaster}},
      {Exception::kNoPath, {Cause::kUnknownDevice, Cause::kShutdown}},
      {Exception::kNoResponse,
       {Cause::kNoResponse, Cause::kTruncated, Cause::kChecksum, Cause::kMalformed, Cause::kForeign,
        Cause::kOverlong, Cause::kPortClosed, Cause::kOffline}},
      {Exception::kDeviceFailure, {Cause::kNotVerified}}};
  for (const auto& [exception, causes] : kExceptions) {
    for (const Cause cause : causes) EXPECT_EQ(code_of(cause), exception) << to_text(cause);
  }
}

TEST(ServerCodec, AnInvalidFrameHasItsReason) {
  EXPECT_EQ(to_text(FrameFault::kProtocol), "the protocol identifier is not 0");
  EXPECT_EQ(to_text(FrameFault::kLength), "the length is not that of a Modbus frame");
}

}  // namespace
}  // namespace fieldcast::gateway
