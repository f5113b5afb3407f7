// Golden frames for the shipped declarations of PLCs. Each test names the source of its frames.
#include <gtest/gtest.h>

#include "tests/support/declared_device.hpp"
#include "tests/support/drive.hpp"

namespace fieldcast::test {
namespace {

Bytes plc_bytes(std::string_view text) { return {text.begin(), text.end()}; }

std::string sent_text(const Device& device, const Request& request) {
  const Bytes sent = device.request_bytes(request);
  return {sent.begin(), sent.end()};
}

// The items of the reply, or what went wrong.
std::string reply_text(const Device& device, const Request& request, std::string_view response) {
  const Outcome outcome = drive(*device.begin(request), plc_bytes(response));
  return outcome.done() ? to_hex(outcome.reply[0].items) : to_text(outcome);
}

std::string words(std::size_t count) { return to_hex(Bytes(2 * count, 1)); }

bool accepts(const Device& device, const Request& request, std::string_view response) {
  return drive(*device.begin(request), plc_bytes(response)).done();
}

// Source: examples of the manuals WUME-MEWCP-03 and ACG-M0015-2, as quoted by MewtocolFrameTests of
// the C# library IndustrialCommunication.
TEST(Mewtocol, ReadsAndWritesTheWordsOfTheManual) {
  const Device device = declared_device("panasonic-mewtocol", 1);
  const Request read = device.read("DT1105", 3);
  EXPECT_EQ(sent_text(device, read), "%01#RDD011050110757\r");
  EXPECT_EQ(reply_text(device, read, "%01$RD630044330A0062\r"), "00 63 33 44 00 0A");
  EXPECT_FALSE(accepts(device, read, "%01$RD630044330A0063\r"));  // wrong check code
  EXPECT_FALSE(accepts(declared_device("panasonic-mewtocol", 2), read, "%01$RD630044330A0062\r"));
  const Request write = device.write("DT400", "00 64 00 00");
  EXPECT_EQ(sent_text(device, write), "%01#WDD00400004016400000053\r");
  EXPECT_TRUE(accepts(device, write, "%01$WD13\r"));
}

// Source: the same manuals, the BCC test of MewtocolNet, and the comment on a serial trial in
// mewtocol-go.
TEST(Mewtocol, ReadsAndWritesTheContactsOfTheManual) {
  const Device device = declared_device("panasonic-mewtocol", 1);
  EXPECT_EQ(sent_text(device, device.read("XA", 1)), "%01#RCSX000A6C\r");
  const Request first = device.read("X0", 1);
  EXPECT_EQ(sent_text(device, first), "%01#RCSX00001D\r");
  EXPECT_EQ(reply_text(device, first, "%01$RC021\r"), "00");
  EXPECT_EQ(reply_text(device, first, "%01$RC120\r"), "01");
  EXPECT_EQ(sent_text(device, device.write("YA", "01")), "%01#WCSY000A159\r");
  // Bit F of word 10 alone, and in its word.
  EXPECT_TRUE(sent_text(device, device.read("R10F", 1)).starts_with("%01#RCSR010F"));
  EXPECT_TRUE(sent_text(device, device.read("WR10.15", 1)).starts_with("%01#RCCR00100010"));
}

// Source: the refusal of MewtocolFrameTests; 42 is "command not supported".
TEST(Mewtocol, ReportsTheCodeOfARefusal) {
  const Device device = declared_device("panasonic-mewtocol", 1);
  const Request read = device.read("DT1105", 3);
  const Outcome refused = drive(*device.begin(read), plc_bytes("%01!4203\r"));
  EXPECT_EQ(refused.cause, Cause::kDeviceError);
  EXPECT_EQ(refused.code, 0x42);
}

// A frame has at most 118 characters.
TEST(Mewtocol, KeepsTheLimitOfAFrame) {
  const Device device = declared_device("panasonic-mewtocol", 1);
  const auto size = [&](const Request& request) { return device.protocol().size(request); };
  EXPECT_EQ(size(device.read("DT0", 27))->response_characters, 117u);
  EXPECT_FALSE(size(device.read("DT0", 28)));
  EXPECT_LE(size(device.write("DT0", words(24)))->request_characters, 118u);
  EXPECT_FALSE(size(device.write("DT0", words(25))));
}

// Source: FBs-PLC User's Manual, Appendix 2, commands 46 and 44, as in t-command.cpp of libfatek.
TEST(Fatek, ReadsTheExamplesOfTheManual) {
  const Device device = declared_device("fatek-facon", 1);
  const Request registers = device.read("R12", 3);
  EXPECT_EQ(sent_text(device, registers),
            "\x02"
            "014603R00012"
            "75\x03");
  EXPECT_EQ(reply_text(device, registers,
                       "\x02"
                       "01460"
                       "10A57FC40001"
                       "89\x03"),
            "10 A5 7F C4 00 01");
  const Request inputs = device.read("X50", 6);
  EXPECT_EQ(sent_text(device, inputs),
            "\x02"
            "014406X0050"
            "4E\x03");
  EXPECT_EQ(reply_text(device, inputs,
                       "\x02"
                       "01440"
                       "010110"
                       "1E\x03"),
            "00 01 00 01 01 00");
  EXPECT_FALSE(accepts(device, inputs,
                       "\x02"
                       "01440"
                       "010111"
                       "1E\x03"));
}

// Source: the requests of FatekWriteDataCmdTest and FatekWriteDiscreteCmdTest of jfatek; their
// checksums and the responses follow from Appendix 2.
TEST(Fatek, WritesRegistersAndContacts) {
  const Device device = declared_device("fatek-facon", 1);
  const Request registers = device.write("F12", "AA AA 55 55");
  EXPECT_EQ(sent_text(device, registers),
            "\x02"
            "014702F00012AAAA5555"
            "41\x03");
  EXPECT_TRUE(accepts(device, registers,
                      "\x02"
                      "01470"
                      "FE\x03"));
  EXPECT_EQ(sent_text(device, device.write("Y10", "01 00 01")),
            "\x02"
            "014503Y0010101"
            "DB\x03");
  const Outcome refused = drive(*device.begin(registers), plc_bytes("\x02"
                                                                    "0147A"
                                                                    "0F\x03"));
  EXPECT_EQ(refused.cause, Cause::kDeviceError);
  EXPECT_EQ(refused.code, 10);
}

// Source: DVP-ES2/EX2/SS2/SA2/SX2/SE Operation Manual, Programming, 4.2.2 and 4.5. The check of the
// response to command 1 is the one of the manual's table; its line prints D6.
TEST(DeltaDvp, ReadsTheExamplesOfTheManual) {
  const Device device = declared_device("delta-dvp-ascii", 1);
  const Request contacts = device.read("T20", 37);
  EXPECT_EQ(sent_text(device, contacts), ":010106140025BF\r\n");
  EXPECT_EQ(reply_text(device, contacts, ":010105CD6BB20E1BE6\r\n").substr(0, 23),
            "01 00 01 01 00 00 01 01");
  const Request timers = device.read("TV20", 8);
  EXPECT_EQ(sent_text(device, timers), ":010306140008DA\r\n");
  EXPECT_EQ(reply_text(device, timers, ":01031000010002000300040005000600070008C8\r\n"),
            "00 01 00 02 00 03 00 04 00 05 00 06 00 07 00 08");
  const Request outputs = device.read("Y0", 1);
  const Outcome refused = drive(*device.begin(outputs), plc_bytes(":0181027C\r\n"));
  EXPECT_EQ(refused.cause, Cause::kDeviceError);
  EXPECT_EQ(refused.code, 2);
}

// Such a code refuses no address: the request is sent again.
TEST(Plcs, ARequestThatTheLineDamagedIsATemporaryState) {
  for (const auto& [protocol, at, response] :
       {std::tuple{"panasonic-mewtocol", "DT1", "%01!4001\r"},
        std::tuple{"delta-dvp-ascii", "D1", ":01830775\r\n"}}) {
    const Device device = declared_device(protocol, 1);
    const Outcome refused = drive(*device.begin(device.read(at, 1)), plc_bytes(response));
    EXPECT_EQ(refused.cause, Cause::kDeviceBusy) << protocol;
  }
  const Device device = declared_device("delta-dvp-rtu", 1);
  EXPECT_EQ(drive(*device.begin(device.read("D1", 1)), *from_hex("01 83 07 00 F2")).cause,
            Cause::kDeviceBusy);
}

TEST(DeltaDvp, WritesTheExamplesOfTheManual) {
  const Device device = declared_device("delta-dvp-ascii", 1);
  const Request output = device.write("Y0", "01");
  EXPECT_EQ(sent_text(device, output), ":01050500FF00F6\r\n");
  EXPECT_TRUE(accepts(device, output, ":01050500FF00F6\r\n"));
  const Request outputs = device.write("Y0", "01 00 01 01 00 00 01 01 01 00");
  EXPECT_EQ(sent_text(device, outputs), ":010F0500000A02CD0111\r\n");
  EXPECT_TRUE(accepts(device, outputs, ":010F0500000AE1\r\n"));
  const Request timers = device.write("TV0", "00 0A 01 02");
  EXPECT_EQ(sent_text(device, timers), ":01100600000204000A0102D6\r\n");
  EXPECT_TRUE(accepts(device, timers, ":011006000002E7\r\n"));
  // The same output by RTU (instruction MODRW, 3-339).
  const Device rtu = declared_device("delta-dvp-rtu", 1);
  EXPECT_EQ(to_hex(rtu.request_bytes(rtu.write("Y0", "01"))), "01 05 05 00 FF 00 8C F6");
}

// Source: the table of the same manual, 4.4. M and D continue at a second address.
TEST(DeltaDvp, FindsTheDevicesOfTheTable) {
  const Device device = declared_device("delta-dvp-rtu", 1);
  for (const auto& [at, address] :
       std::initializer_list<std::pair<const char*, const char*>>{{"S1023", "03 FF"},
                                                                  {"X377", "04 FF"},
                                                                  {"Y0", "05 00"},
                                                                  {"TV255", "06 FF"},
                                                                  {"M0", "08 00"},
                                                                  {"M1535", "0D FF"},
                                                                  {"M1536", "B0 00"},
                                                                  {"M4095", "B9 FF"},
                                                                  {"C255", "0E FF"},
                                                                  {"CV199", "0E C7"},
                                                                  {"D0", "10 00"},
                                                                  {"D4095", "1F FF"},
                                                                  {"D4096", "90 00"}})
    EXPECT_EQ(to_hex(device.request_bytes(device.read(at, 1))).substr(6, 5), address) << at;
  EXPECT_FALSE(device.protocol().parse_address("M4096"));
  EXPECT_FALSE(device.protocol().parse_address("X8"));
}

// Source: requests and responses in tests of plc-comm-hostlink-python (test_comprehensive.py).
// Constructed: leading zeros, which a PLC may send.
TEST(KeyenceKv, ReadsWordsAndRelays) {
  const Device device = declared_device("keyence-kv", 1);
  const Request words = device.read("DM0", 3);
  EXPECT_EQ(sent_text(device, words), "RDS DM0.U 3\r");
  EXPECT_EQ(reply_text(device, words, "10 20 30\r\n"), "00 0A 00 14 00 1E");
  EXPECT_EQ(reply_text(device, words, "00010 61551 65535\r\n"), "00 0A F0 6F FF FF");
  EXPECT_FALSE(accepts(device, words, "10 20\r\n"));
  EXPECT_FALSE(accepts(device, words, "10 20 65536\r\n"));
  const Request relays = device.read("CR3614", 4);
  EXPECT_EQ(sent_text(device, relays), "RDS CR3614 4\r");
  EXPECT_EQ(reply_text(device, relays, "0 1 0 1\r\n"), "00 01 00 01");
}

// Source: the same tests; BuildWriteCommand of HslCommunication for relays.
TEST(KeyenceKv, WritesWordsAndRelays) {
  const Device device = declared_device("keyence-kv", 1);
  const Request words = device.write("DM10", "00 64 00 C8");
  EXPECT_EQ(sent_text(device, words), "WRS DM10.U 2 100 200\r");
  EXPECT_TRUE(accepts(device, words, "OK\r\n"));
  EXPECT_EQ(sent_text(device, device.write("MR1015", "01 00")), "WRS MR1015 2 1 0\r");
  const auto control = device.protocol().parse_address("CR0");
  EXPECT_FALSE(device.protocol().areas()[control->area].writable);
}

// Source: DEVICE_RANGES of plc-comm-hostlink-python, GetAddressStartFormat of KeyenceNanoAddress in
// HslCommunication.
TEST(KeyenceKv, HasTheDevicesOfItsSources) {
  const Device device = declared_device("keyence-kv", 1);
  for (const auto& [at, request] : std::initializer_list<std::pair<const char*, const char*>>{
           {"DM65534", "RDS DM65534.U 1\r"},
           {"ZF524287", "RDS ZF524287.U 1\r"},
           {"W7FFF", "RDS W7FFF.U 1\r"},
           {"Z1", "RDS Z1.U 1\r"},
           {"Z12", "RDS Z12.U 1\r"},
           {"TC3999", "RDS TC3999.D 1\r"},
           {"R5", "RDS R5 1\r"},
           {"R199915", "RDS R199915 1\r"},
           {"MR399915", "RDS MR399915 1\r"},
           {"LR99915", "RDS LR99915 1\r"},
           {"CR7915", "RDS CR7915 1\r"},
           {"B1F", "RDS B1F 1\r"},
           {"VBF9FF", "RDS VBF9FF 1\r"}})
    EXPECT_EQ(sent_text(device, device.read(at, 1)), request);
  for (const char* at : {"DM65535", "W8000", "Z0", "Z13", "R200000", "MR16", "LR100000", "CR7916"})
    EXPECT_FALSE(device.protocol().parse_address(at)) << at;
  EXPECT_TRUE(device.protocol().size(device.read("DM0", 64)));
  EXPECT_FALSE(device.protocol().size(device.read("DM0", 65)));
  EXPECT_FALSE(device.protocol().size(device.read("TC0", 33)));
}

// Source: table of abnormal responses in PROTOCOL_SPEC.md of plc-comm-hostlink-python.
TEST(KeyenceKv, ReportsTheCodeOfARefusal) {
  const Device device = declared_device("keyence-kv", 1);
  for (const Request& request : {device.read("DM0", 1), device.write("DM0", "00 01")}) {
    const Outcome refused = drive(*device.begin(request), plc_bytes("E4\r\n"));
    EXPECT_EQ(refused.cause, Cause::kDeviceError);
    EXPECT_EQ(refused.code, 0xE4);
  }
}

}  // namespace
}  // namespace fieldcast::test
