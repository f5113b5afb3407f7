#include "core/telnet/line_client.hpp"

#include "tests/telnet/frames.hpp"

namespace fieldcast::telnet {
namespace {

class LineClientTest : public testing::Test {
 protected:
  // Returns what the client sends.
  std::string receive(const Bytes& bytes) {
    Bytes out;
    client_.on_bytes(bytes, data_, out);
    return to_hex(out);
  }
  // The options agreed, the settings not yet confirmed.
  std::string agree() { return receive(hex("FF FD 00 FF FB 00 FF FD 03 FF FB 03 FF FD 2C")); }
  void open() {
    agree();
    receive(
        together({option("65 00 01 C2 00"), option("66 07"), option("67 03"), option("68 02")}));
    ASSERT_TRUE(client_.open()) << client_.fault();
  }

  Bytes first_, data_;
  LineClient client_{{115200, 7, Parity::kEven, 2}, kStart, first_};
};

TEST_F(LineClientTest, RequestsItsOptionsFirst) {
  EXPECT_EQ(to_hex(first_),
            "FF FB 00 FF FB 03 "  // WILL BINARY, WILL SUPPRESS-GO-AHEAD
            "FF FD 00 FF FD 03 "  // DO the same
            "FF FB 2C");          // WILL COM-PORT-OPTION
}

TEST_F(LineClientTest, SetsTheLineWhenTheOptionsAreAgreed) {
  EXPECT_EQ(receive(hex("FF FD 2C FF FD 00")), "");
  EXPECT_EQ(receive(hex("FF FB 00")),
            option("01 00 01 C2 00") + ' ' + option("02 07") + ' ' + option("03 03") + ' ' +
                option("04 02") + ' ' + option("05 01") + ' ' + option("05 08") + ' ' +
                option("05 0B") + ' ' +                                            // no flow
                option("0A 00") + ' ' + option("0B 00") + ' ' + option("0C 03"));  // masks, purge
  EXPECT_EQ(receive(hex("FF FD 2C")), "");
}

TEST_F(LineClientTest, IsOpenWhenAllValuesAreInForce) {
  agree();
  receive(together({"41", option("67 03"), option("65 0E"), option("66 07")}));  // 0E: 115200
  EXPECT_FALSE(client_.open());
  EXPECT_EQ(client_.deadline(), kStart + LineClient::kLimit);
  receive(together({"42", option("68 02"), "43 FF FF 44"}));
  EXPECT_TRUE(client_.open());
  EXPECT_EQ(client_.deadline(), kNever);
  EXPECT_EQ(data_, (Bytes{0x43, 0xFF, 0x44}));  // without the stale bytes
}

TEST_F(LineClientTest, AnotherValueIsAFault) {
  agree();
  receive(hex(option("65 00 00 25 80")));
  EXPECT_EQ(client_.fault(), "the server reports baud rate 9600, configured is 115200");
}

TEST_F(LineClientTest, AnotherParityIsNamed) {
  agree();
  receive(hex(option("67 01")));
  EXPECT_EQ(client_.fault(), "the server reports parity none, configured is even");
}

TEST_F(LineClientTest, AChangeByOthersIsAFaultAndEndsTheData) {
  open();
  receive(together({"41", option("65 00 00 25 80"), "42"}));
  EXPECT_EQ(client_.fault(), "the server reports baud rate 9600, configured is 115200");
  EXPECT_EQ(data_, Bytes{0x41});
}

TEST_F(LineClientTest, AnEngineerChangesTheLineAndIsTold) {
  using Changed = LineClient::Changed;
  open();
  Bytes out;
  const LineChange baud{Kind::kBaud, 9600}, parity{Kind::kParity, 1};
  client_.change(baud, kStart, out);
  client_.change(parity, kStart, out);
  EXPECT_EQ(to_hex(out), option("01 00 00 25 80") + ' ' + option("03 01"));
  EXPECT_TRUE(client_.take_changed().empty());
  receive(hex(option("67 03")));  // the server keeps the parity
  EXPECT_EQ(client_.take_changed(), std::vector{(Changed{parity, 3})});
  receive(together({"41", option("65 00 00 25 7E"), "42"}));  // it rounds the rate
  EXPECT_EQ(client_.take_changed(), std::vector{(Changed{baud, 9598})});
  EXPECT_EQ(client_.deadline(), kNever);
  EXPECT_EQ(data_, (Bytes{0x41, 0x42}));
  EXPECT_EQ(client_.fault(), "");
  EXPECT_TRUE(client_.changes_line());
}

TEST_F(LineClientTest, AChangeWithoutAResponseIsNotInForce) {
  open();
  Bytes out;
  const LineChange dtr{Kind::kControl, 9};
  client_.change(dtr, kStart, out);
  client_.on_time(kStart + LineClient::kLimit - Duration{1});
  EXPECT_TRUE(client_.take_changed().empty());
  client_.on_time(client_.deadline());
  EXPECT_EQ(client_.take_changed(), std::vector{LineClient::Changed{dtr}});
  client_.change(dtr, kStart, out);
  receive(hex(option("69 08")));  // refused
  EXPECT_EQ(client_.take_changed(), std::vector{LineClient::Changed{dtr}});
  EXPECT_TRUE(client_.open());
  EXPECT_EQ(client_.deadline(), kNever);
}

TEST_F(LineClientTest, AFloodOfChangesIsBounded) {
  open();
  Bytes out;
  for (std::size_t i = 0; i <= LineClient::kMaxAwaited; ++i)
    client_.change({Kind::kBaud, 9600}, kStart, out);
  EXPECT_EQ(client_.take_changed(), (std::vector{LineClient::Changed{{Kind::kBaud, 9600}}}));
}

TEST_F(LineClientTest, ARefusalIsAFault) {
  receive(hex("FF FE 2C"));
  EXPECT_EQ(client_.fault(),
            "the server refuses COM-PORT-OPTION (RFC 2217); use 'tcp' for raw bytes");
}

TEST_F(LineClientTest, ARefusedBinaryIsAFault) {
  receive(hex("FF FD 2C FF FC 00"));
  EXPECT_EQ(client_.fault(), "the server refuses BINARY, so it would change bytes of the line");
}

TEST_F(LineClientTest, AServerMayEnableTheOptionAtItsEnd) {
  EXPECT_EQ(receive(hex("FF FB 2C")), "FF FD 2C");  // WILL, DO
  EXPECT_NE(receive(hex("FF FD 00 FF FB 00 FF FE 2C")), "");
  EXPECT_EQ(client_.fault(), "");
}

TEST_F(LineClientTest, TheFaultNamesWhatIsMissingAfterThreeSeconds) {
  client_.on_time(kStart + LineClient::kLimit - std::chrono::milliseconds{1});
  EXPECT_EQ(client_.fault(), "");
  client_.on_time(kStart + LineClient::kLimit);
  EXPECT_EQ(client_.fault(), "the server has not agreed on COM-PORT-OPTION (RFC 2217) within 3s");
}

TEST_F(LineClientTest, AMissingBinaryAndAMissingValueAreNamed) {
  receive(hex("FF FD 2C"));
  LineClient silent = client_;
  silent.on_time(kStart + LineClient::kLimit);
  EXPECT_EQ(silent.fault(), "the server has not agreed on BINARY within 3s");
  receive(together({"FF FD 00 FF FB 00", option("65 0E"), option("67 03")}));
  client_.on_time(kStart + LineClient::kLimit);
  EXPECT_EQ(client_.fault(), "the server has not confirmed the data bits within 3s");
}

TEST_F(LineClientTest, TheServerSuspendsData) {
  open();
  receive(hex(option("6C")));
  EXPECT_TRUE(client_.suspended());
  receive(hex(option("6D")));
  EXPECT_FALSE(client_.suspended());
}

TEST_F(LineClientTest, RespondsToARequestForItsSignature) {
  open();
  EXPECT_EQ(receive(hex(option("64"))), option("00 46 69 65 6C 64 63 61 73 74"));
  EXPECT_EQ(receive(hex(option("64 41"))), "");
  EXPECT_EQ(receive(hex(option("6B B0"))), "");  // a notification
}

TEST_F(LineClientTest, AReportedValueHasTheNameOfTheStandard) {
  agree();
  const std::pair<const char*, const char*> kReports[] = {
      {"67 05", "parity space, configured is even"},
      {"67 09", "parity unknown, configured is even"},
      {"68 01", "stop bits 1, configured is 2"},
      {"68 03", "stop bits 1.5, configured is 2"}};
  for (const auto& [report, text] : kReports) {
    LineClient client = client_;
    Bytes out;
    client.on_bytes(hex(option(report)), data_, out);
    EXPECT_EQ(client.fault(), std::string("the server reports ") + text);
  }
}

TEST_F(LineClientTest, ADisabledBinaryIsARefusal) {
  receive(hex("FF FE 00"));  // DONT
  EXPECT_EQ(client_.fault(), "the server refuses BINARY, so it would change bytes of the line");
}

TEST_F(LineClientTest, SettingsBeforeTheAgreementAndOtherMessagesAreIgnored) {
  receive(hex(option("65 00 00 25 80")));  // the line of the last client
  EXPECT_EQ(client_.fault(), "");
  open();
  // The sub-option of TERMINAL-TYPE, a message of a client, a baud rate of three bytes.
  receive(together({"FF FA 18 01 FF F0", option("01 00 00 25 80"), option("65 00 25 80")}));
  EXPECT_EQ(client_.fault(), "");
  EXPECT_TRUE(client_.open());
}

TEST_F(LineClientTest, AConfirmedPurgeIsDoneWhateverItsValue) {
  open();
  Bytes out;
  const LineChange purge{Kind::kPurge, 3};
  client_.change(purge, kStart, out);
  receive(hex(option("70 01")));
  EXPECT_EQ(client_.take_changed(), std::vector{(LineClient::Changed{purge, 3})});
}

}  // namespace
}  // namespace fieldcast::telnet
