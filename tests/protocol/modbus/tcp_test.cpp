#include <gtest/gtest.h>

#include "core/protocol/modbus/areas.hpp"
#include "core/protocol/modbus/framing.hpp"
#include "core/protocol/modbus/modbus.hpp"
#include "tests/support/drive.hpp"

namespace fieldcast::modbus {
namespace {

using test::drive;
using test::Outcome;

Bytes bytes(std::string_view text) { return *from_hex(text); }

// Unit 17 reads one holding register; the transaction is 1234.
Outcome outcome_of(std::string_view received) {
  const Request request = ReadRequest{{{static_cast<AreaIndex>(Table::kHolding), 0, 1}}};
  ModbusExchange exchange{tcp_framing(), Header{17, 0x1234}, request, {}};
  return drive(exchange, bytes(received));
}

constexpr std::string_view kResponse = "1234 0000 0005 11 03 02 AE41";

TEST(TcpExchange, TheResponseHasTheTransactionAndTheUnitOfTheRequest) {
  const std::string response(kResponse);
  for (const std::string before :
       {"", "1233 0000 0005 11 03 02 0001", "1234 0000 0005 12 03 02 0001",
        "1234 0000 0005 11 04 02 0001", "1234 0000 0003 11 03 02"}) {
    const Outcome outcome = outcome_of(before + response);
    ASSERT_TRUE(outcome.done()) << before;
    EXPECT_EQ(outcome.reply.front().items, bytes("AE41")) << before;
  }
}

TEST(TcpExchange, AnExceptionIsTheErrorOfTheDevice) {
  const Outcome outcome = outcome_of("1234 0000 0003 11 83 02");
  EXPECT_EQ(outcome.cause, Cause::kDeviceError);
  EXPECT_EQ(outcome.code, 2);
}

struct Silence {
  std::string_view received;
  Cause cause;
};

// After the timeout, the cause is the worst of what was received instead of the response.
TEST(TcpExchange, SilenceHasTheCauseOfWhatWasReceived) {
  for (const Silence& row :
       {Silence{"", Cause::kNoResponse}, Silence{"12", Cause::kTruncated},
        Silence{"1234 0000 0005 11 03 02 AE", Cause::kTruncated}, Silence{"1233", Cause::kForeign},
        Silence{"1233 0000 0005 11 03 02 0001", Cause::kForeign},
        Silence{"1234 0000 0005 12 03 02 0001", Cause::kForeign},
        Silence{"1234 0000 0005 11 04 02 0001", Cause::kForeign},
        Silence{"1234 0000 0007 11 03 04 0001 0002", Cause::kMalformed},
        Silence{"1234 0000 0007 11 03 04 0001 0002 1233 0000 0003 11 83 02", Cause::kMalformed},
        Silence{"1234 0000 0007 11 03 04 0001 0002 1233", Cause::kMalformed},
        Silence{"1233 0000 0003 11 83 02 1234 00", Cause::kTruncated}}) {
    const Outcome outcome = outcome_of(row.received);
    EXPECT_TRUE(outcome.waited) << row.received;
    EXPECT_EQ(outcome.cause, row.cause) << row.received;
  }
}

// V1.0b, 3.1.3: the protocol is 0, and a length counts the unit, a function and at most 252 bytes.
TEST(TcpExchange, AHeaderThatIsInvalidFailsImmediately) {
  for (const std::string_view received : {"1234 01", "1234 0001", "1234 0000 0001",
                                          "1234 0000 0000", "1234 0000 00FF", "1234 0000 0100"}) {
    const Outcome outcome = outcome_of(received);
    EXPECT_FALSE(outcome.waited) << received;
    EXPECT_EQ(outcome.cause, Cause::kMalformed) << received;
  }
}

TEST(TcpStream, ItsFirstFrameIsAsLongAsTheHeaderSays) {
  for (const std::string_view incomplete :
       {"", "12", "1234", "1234 00", "1234 0000", "1234 0000 00", "1234 0000 0002",
        "1234 0000 0002 11", "1234 0000 00FE 11 03"})
    EXPECT_EQ(first_tcp_frame(bytes(incomplete)), 0u) << incomplete;
  for (const std::string_view broken :
       {"1234 01", "1234 0001", "1234 0000 0001", "1234 0000 00FF 11 03"})
    EXPECT_EQ(first_tcp_frame(bytes(broken)), std::nullopt) << broken;
  EXPECT_EQ(first_tcp_frame(bytes("1234 0000 0002 11 07")), 8u);
  EXPECT_EQ(first_tcp_frame(bytes("1234 0000 0002 11 07 1235 01")), 8u);
  Bytes longest = bytes("1234 0000 00FE");
  longest.resize(6 + 254);
  EXPECT_EQ(first_tcp_frame(longest), 260u);
}

}  // namespace
}  // namespace fieldcast::modbus
