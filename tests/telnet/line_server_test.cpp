#include "core/telnet/line_server.hpp"

#include "tests/telnet/frames.hpp"

namespace fieldcast::telnet {
namespace {

class LineServerTest : public testing::Test {
 protected:
  LineServerTest() { server_.on_line({9600, 8, Parity::kNone, 1}); }
  // Returns what the server sends; stores its actions.
  std::string receive(const Bytes& bytes) {
    Bytes out;
    actions_.clear();
    server_.on_bytes(bytes, actions_, out);
    return to_hex(out);
  }
  std::string changed(Kind kind, std::uint32_t value, bool done) {
    Bytes out;
    server_.on_changed({kind, value}, done, out);
    return to_hex(out);
  }
  std::string modem(std::uint8_t state) {
    Bytes out;
    server_.on_modem_state(state, out);
    return to_hex(out);
  }
  [[nodiscard]] LineChange change(std::size_t at = 0) const {
    return std::get<LineChange>(actions_.at(at));
  }

  Bytes first_;
  LineServer server_{first_};
  LineActions actions_;
};

TEST_F(LineServerTest, NegotiatesWithPyserial) {
  EXPECT_EQ(to_hex(first_), "FF FD 2C FF FB 03 FF FB 00 FF FD 00");
  // DO ECHO, WILL SGA, DO SGA, DO COM-PORT-OPTION, WILL COM-PORT-OPTION
  EXPECT_EQ(receive(hex("FF FD 01 FF FB 03 FF FD 03 FF FD 2C FF FB 2C")),
            "FF FB 01 FF FD 03 FF FB 2C");
  EXPECT_TRUE(server_.com_port());
}

TEST_F(LineServerTest, AChangeGetsTheValueInForceAsResponse) {
  EXPECT_EQ(receive(hex(option("01 00 01 C2 00"))), "");
  EXPECT_EQ(change(), (LineChange{Kind::kBaud, 115200}));
  EXPECT_EQ(changed(Kind::kBaud, 115200, true), option("65 00 01 C2 00"));
  receive(hex(option("01 00 2D C6 C0")));
  EXPECT_EQ(changed(Kind::kBaud, 3000000, false), option("65 00 01 C2 00"));
  receive(together({option("02 07"), option("03 03"), option("04 02")}));
  EXPECT_EQ(changed(Kind::kDataBits, 7, true), option("66 07"));
  EXPECT_EQ(changed(Kind::kParity, 3, true), option("67 03"));
  EXPECT_EQ(changed(Kind::kStopBits, 2, true), option("68 02"));
  EXPECT_EQ(server_.line(), (LineFormat{115200, 7, Parity::kEven, 2}));
}

TEST_F(LineServerTest, RequestsAndImpossibleValuesChangeNothing) {
  EXPECT_EQ(receive(together(
                {option("01 00 00 00 00"), option("02 05"), option("03 04"), option("04 03")})),
            option("65 00 00 25 80") + ' ' + option("66 08") + ' ' + option("67 01") + ' ' +
                option("68 01"));
  EXPECT_TRUE(actions_.empty());
}

TEST_F(LineServerTest, AOneByteBaudRateGetsAOneByteResponse) {
  EXPECT_EQ(receive(hex(option("01 00"))), option("65 08"));  // request: 9600
  receive(hex(option("01 0A")));
  EXPECT_EQ(change(), (LineChange{Kind::kBaud, 19200}));
  EXPECT_EQ(changed(Kind::kBaud, 19200, true), option("65 0A"));
}

TEST_F(LineServerTest, ControlsHaveAStateEach) {
  const auto request = [&](const char* code) { return receive(hex(option(code))); };
  EXPECT_EQ(request("05 00"), option("69 01"));  // no flow control
  EXPECT_EQ(request("05 04"), option("69 06"));  // break off
  EXPECT_EQ(request("05 07"), option("69 08"));  // DTR on
  EXPECT_EQ(request("05 0A"), option("69 0B"));  // RTS on
  EXPECT_EQ(request("05 0D"), option("69 0E"));  // no flow control of received data
  for (const std::uint32_t value : {3u, 5u, 9u, 12u}) {
    request(("05 " + to_hex(Bytes{static_cast<std::uint8_t>(value)})).c_str());
    EXPECT_EQ(change(), (LineChange{Kind::kControl, value}));
    changed(Kind::kControl, value, true);
  }
  EXPECT_EQ(request("05 00"), option("69 03"));
  EXPECT_EQ(request("05 04"), option("69 05"));
  EXPECT_EQ(request("05 07"), option("69 09"));
  EXPECT_EQ(request("05 0A"), option("69 0C"));
  EXPECT_EQ(request("05 11"), option("69 10"));  // flow control by DCD: not supported
  EXPECT_EQ(changed(Kind::kControl, 11, false), option("69 0C"));
}

TEST_F(LineServerTest, PurgeIsConfirmedAfterItWasDone) {
  EXPECT_EQ(receive(hex(option("0C 02"))), "");
  EXPECT_EQ(change(), (LineChange{Kind::kPurge, 2}));
  EXPECT_EQ(changed(Kind::kPurge, 2, true), option("70 02"));
}

TEST_F(LineServerTest, DataAndChangesKeepTheirOrder) {
  receive(together({"41 FF FF", option("02 07"), "42", option("0C 01")}));
  ASSERT_EQ(actions_.size(), 4u);
  EXPECT_EQ(std::get<LineData>(actions_[0]).bytes, (Bytes{0x41, 0xFF}));
  EXPECT_EQ(change(1).kind, Kind::kDataBits);
  EXPECT_EQ(std::get<LineData>(actions_[2]).bytes, Bytes{0x42});
  EXPECT_EQ(change(3).kind, Kind::kPurge);
}

TEST_F(LineServerTest, NotifiesChangesOfTheMask) {
  EXPECT_EQ(modem(0xB0), option("6B BB"));  // DCD, DSR, CTS and their changes
  EXPECT_EQ(modem(0xB0), "");
  EXPECT_EQ(modem(0xF0), option("6B F0"));  // RI rises: no trailing edge
  EXPECT_EQ(modem(0xA0), option("6B A5"));  // RI ends, CTS changes
  EXPECT_EQ(receive(hex(option("0B 10"))), option("6F 10"));
  EXPECT_EQ(modem(0x20), "");  // DCD is masked
  EXPECT_EQ(receive(hex(option("07"))), option("6B 20"));
  Bytes out;
  server_.on_line_state(0x10, out);
  EXPECT_EQ(to_hex(out), "");  // the initial mask is 0
  EXPECT_EQ(receive(hex(option("0A 1E"))), option("6E 1E"));
  server_.on_line_state(0x31, out);
  EXPECT_EQ(to_hex(out), option("6A 10"));
}

TEST_F(LineServerTest, TheClientSuspendsDataAndRequestsTheSignature) {
  receive(hex(option("08")));
  EXPECT_TRUE(server_.suspended());
  receive(hex(option("09")));
  EXPECT_FALSE(server_.suspended());
  EXPECT_EQ(receive(hex(option("00"))), option("64 46 69 65 6C 64 63 61 73 74"));
  EXPECT_EQ(receive(hex(option("65 00 00 25 80"))), "");  // a message of a server
}

TEST_F(LineServerTest, AClientMayEnableTheOptionAtTheServer) {
  EXPECT_FALSE(server_.com_port());
  receive(hex("FF FD 2C"));  // DO, without WILL
  EXPECT_TRUE(server_.com_port());
}

TEST_F(LineServerTest, OnlyTheBaudRateHasAOneByteForm) {
  EXPECT_EQ(receive(together({option("01 00"), option("02 00")})),
            option("65 08") + ' ' + option("66 08"));
}

TEST_F(LineServerTest, OtherMessagesGetNoResponse) {
  // The sub-option of TERMINAL-TYPE, a code without a meaning, a request for the line state.
  EXPECT_EQ(receive(together({"FF FA 18 01 FF F0", option("0D"), option("06")})), "");
  EXPECT_TRUE(actions_.empty());
}

}  // namespace
}  // namespace fieldcast::telnet
