#include "core/telnet/com_port.hpp"

#include "tests/telnet/frames.hpp"

namespace fieldcast::telnet {
namespace {

// RFC 2217, sections "Client to Access Server" and "Access Server to Client".
const std::pair<Message, std::string> kFrames[] = {
    {{From::kClient, Kind::kSignature, 0, "Ab"}, option("00 41 62")},
    {{From::kServer, Kind::kSignature}, option("64")},
    {{From::kClient, Kind::kBaud, 9600}, option("01 00 00 25 80")},
    {{From::kServer, Kind::kBaud, 65280}, option("65 00 00 FF FF 00")},  // FF is doubled
    {{From::kClient, Kind::kBaud, 0}, option("01 00 00 00 00")},
    {{From::kClient, Kind::kDataBits, 7}, option("02 07")},
    {{From::kServer, Kind::kParity, 3}, option("67 03")},
    {{From::kClient, Kind::kStopBits, 2}, option("04 02")},
    {{From::kClient, Kind::kControl, 5}, option("05 05")},     // break on
    {{From::kServer, Kind::kControl, 12}, option("69 0C")},    // RTS off
    {{From::kServer, Kind::kLineState, 16}, option("6A 10")},  // break detected
    {{From::kServer, Kind::kModemState, 0xB0}, option("6B B0")},
    {{From::kServer, Kind::kSuspend}, option("6C")},
    {{From::kClient, Kind::kResume}, option("09")},
    {{From::kClient, Kind::kLineStateMask, 0xFF}, option("0A FF FF")},
    {{From::kServer, Kind::kModemStateMask, 1}, option("6F 01")},
    {{From::kClient, Kind::kPurge, 3}, option("0C 03")},
    // Codes of older Cisco servers.
    {{From::kServer, Kind::kBaud, 9600, {}, true}, option("65 08")},
    {{From::kClient, Kind::kBaud, 115200, {}, true}, option("01 0E")},
};

std::optional<Message> read(const Bytes& frame) {
  Parser parser;
  ByteView in = frame;
  const auto item = parser.next(in);
  const auto* sub = item ? std::get_if<Subnegotiation>(&*item) : nullptr;
  return sub != nullptr && sub->option == kComPort ? message_from(sub->bytes) : std::nullopt;
}

TEST(ComPortMessage, IsAsRfc2217Says) {
  for (const auto& [message, frame] : kFrames) {
    Bytes out;
    append_message(out, message);
    EXPECT_EQ(to_hex(out), frame);
    EXPECT_EQ(read(hex(frame)), message) << frame;
  }
}

TEST(ComPortMessage, OtherSizesAndCodesAreNoMessages) {
  for (const char* body : {"", "0D", "71", "01 00 00 25", "01 00 00 25 80 00", "01 63", "02 07 07",
                           "08 00", "FF", "0C 01 01"}) {
    EXPECT_FALSE(message_from(body[0] == '\0' ? Bytes{} : hex(body))) << body;
  }
}

TEST(ComPortMessage, ABaudRateWithoutACodeIsSentInFourBytes) {
  Bytes out;
  append_message(out, {From::kServer, Kind::kBaud, 187500, {}, true});
  EXPECT_EQ(to_hex(out), option("65 00 02 DC 6C"));
}

TEST(ComPortMessage, ALongSignatureIsCutOff) {
  Bytes out;
  append_message(out, {From::kServer, Kind::kSignature, 0, std::string(500, 'x')});
  EXPECT_EQ(read(out)->text, std::string(kMaxSignature, 'x'));
}

TEST(ComPortMessage, ALineHasAValueForEachSetting) {
  LineFormat line{115200, 7, Parity::kEven, 2};
  EXPECT_EQ(value_of(Kind::kBaud, line), 115200u);
  EXPECT_EQ(value_of(Kind::kDataBits, line), 7u);
  EXPECT_EQ(value_of(Kind::kParity, line), 3u);
  EXPECT_EQ(value_of(Kind::kStopBits, line), 2u);
  EXPECT_TRUE(set_value(line, Kind::kBaud, 9600));
  EXPECT_TRUE(set_value(line, Kind::kDataBits, 8));
  EXPECT_TRUE(set_value(line, Kind::kParity, 2));
  EXPECT_TRUE(set_value(line, Kind::kStopBits, 1));
  EXPECT_EQ(line, (LineFormat{9600, 8, Parity::kOdd, 1}));
  // 0 is a request; 5 data bits, mark, space and 1.5 stop bits are not supported.
  for (const auto& [kind, value] : {std::pair{Kind::kBaud, 0},
                                    {Kind::kDataBits, 5},
                                    {Kind::kParity, 0},
                                    {Kind::kParity, 4},
                                    {Kind::kStopBits, 3}})
    EXPECT_FALSE(set_value(line, kind, static_cast<std::uint32_t>(value)));
  EXPECT_EQ(line, (LineFormat{9600, 8, Parity::kOdd, 1}));
}

TEST(ComPortMessage, ACommandIsNotASettingOfTheLine) {
  LineFormat line{9600, 8, Parity::kOdd, 1};
  EXPECT_EQ(value_of(Kind::kPurge, line), 0u);
  EXPECT_FALSE(set_value(line, Kind::kPurge, 1));
  EXPECT_EQ(line, (LineFormat{9600, 8, Parity::kOdd, 1}));
}

}  // namespace
}  // namespace fieldcast::telnet
