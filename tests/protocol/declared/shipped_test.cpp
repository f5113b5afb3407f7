// Golden frames for the declarations that are shipped. Each test names the source of its frames.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/declared_device.hpp"
#include "tests/support/drive.hpp"

namespace fieldcast::test {
namespace {

Device meter(const std::string& protocol, const std::string& address) {
  return Device(std::move(*declared::make(declaration(protocol), {.long_address = address})));
}

Bytes bytes_of(std::string_view hex) { return from_hex(hex).value(); }
Bytes ascii(std::string_view text) { return {text.begin(), text.end()}; }

std::string items_of(const Device& device, const Request& request, const Bytes& response) {
  const Outcome outcome = drive(*device.begin(request), response);
  return outcome.done() ? to_hex(outcome.reply[0].items) : to_text(outcome);
}

// Source: EBYTE IoT laboratory, DLT645 frames in a forum of EET China
// (mbb.eet-china.com/forum/topic/114707_1_1.html).
TEST(Dlt645, ReadsTheEnergyOfAPublishedExchange) {
  const Device device = meter("dlt645-2007", "652022122003");
  const Request request = device.read("combined:0", 1);
  EXPECT_EQ(to_hex(device.request_bytes(request)),
            "FE FE FE FE 68 03 20 12 22 20 65 68 11 04 33 33 33 33 8D 16");
  EXPECT_EQ(items_of(device, request,
                     bytes_of("68 03 20 12 22 20 65 68 91 08 33 33 33 33 33 33 33 33 DD 16")),
            "00 00 00 00");
}

// Source: comments in a Java utility for DL/T 645 frames (DLT645FrameUtils on GitHub):
// 000000.04 kWh of the meter 398192000337.
TEST(Dlt645, ReadsTheForwardEnergyOfAPublishedExchange) {
  const Device device = meter("dlt645-2007", "398192000337");
  const Request request = device.read("energy:10000", 1);
  EXPECT_EQ(to_hex(device.request_bytes(request)),
            "FE FE FE FE 68 37 03 00 92 81 39 68 11 04 33 33 34 33 38 16");
  const Bytes response = bytes_of("68 37 03 00 92 81 39 68 91 08 33 33 34 33 37 33 33 33 8C 16");
  EXPECT_EQ(items_of(device, request, response), "00 00 00 04");
  // The same behind the wake-up bytes that a meter may send.
  Bytes awake(4, 0xFE);
  append(awake, response);
  EXPECT_EQ(items_of(device, request, awake), "00 00 00 04");
  // Another meter of the line.
  const Device other = meter("dlt645-2007", "398192000338");
  EXPECT_FALSE(drive(*other.begin(other.read("energy:10000", 1)), response).done());
}

// Sources: Go packages for MULTICAL meters on GitHub, tests of their frames: 1234.56 GJ with a byte
// of the number escaped, and a register with the exponent 17.
TEST(KamstrupKmp, TheExponentHasASignOfItsOwn) {
  const Device device = declared_device("kamstrup-kmp", 63);
  const auto energy = [&](std::string_view response) {
    const auto outcome = drive(*device.begin(device.read("energy", 13)), bytes_of(response));
    if (!outcome.done()) return to_text(outcome);
    const Bytes& items = outcome.reply[0].items;
    return std::string(items.begin(), std::ranges::find(items, 0));
  };
  EXPECT_EQ(energy("40 3F 10 00 3C 08 04 42 00 01 E2 1B BF 7E 4A 0D"), "1234.56");
  EXPECT_TRUE(energy("40 3F 10 00 1B 7F 16 04 11 01 2A F0 24 63 03 0D").starts_with("failed"));
  const auto fields = declared::explain(
      *declaration("kamstrup-kmp"), bytes_of("40 3F 10 00 1B 7F 16 04 11 01 2A F0 24 63 03 0D"));
  EXPECT_TRUE(std::ranges::any_of(
      fields, [](const FrameField& field) { return field.value == "1959120400000000000000000"; }));
}

// Source: esphome-jk-bms, docs/protocol-design-uart-ttl-gps-port.md.
TEST(JkBms, ReadsThePackOfAPublishedExchange) {
  const Device pack = declared_device("jk-bms", 1);
  const Bytes response = bytes_of(
      "4E57 011B 00000000 06 00 01 79 2A 010EED 020EFA 030EF7 040EEC 050EF8 060EFA 070EF1 080EF8 "
      "090EE3 0A0EFA 0B0EF1 0C0EFB 0D0EFB 0E0EF2 80001D 81001E 82001C 8314EF 8480D0 850F 8602 "
      "870004 8900000000 8A000E 8B0000 8C0007 8E1626 8F10AE 900FD2 910FA0 920005 930BEA 940C1C "
      "950005 96012C 970007 980003 990005 9A0005 9B0CE4 9C0008 9D01 9E005A 9F0046 A00064 A10064 "
      "A20014 A30046 A40046 A5FFEC A6FFF6 A7FFEC A8FFF6 A90E AA0000000E AB01 AC01 AD0411 AE01 "
      "AF01 B0000A B114 B231323334353600000000 B300 B4496E707574205573 B532313031 B60000E200 "
      "B748362E585F5F53362E312E33535F5F B800 B900000000 "
      "BA425433303732303230313230303030323030353231303031 C001 00000000 68 0000 54D1");
  const auto read = [&](std::string_view at, std::uint32_t items) {
    const Request request = pack.read(at, items);
    EXPECT_EQ(to_hex(pack.request_bytes(request)),
              "4E 57 00 13 00 00 00 00 06 03 00 00 00 00 00 00 68 00 00 01 29");
    return items_of(pack, request, response);
  };
  EXPECT_EQ(read("cell-1", 1), "0E ED");
  EXPECT_EQ(read("cell-14", 1), "0E F2");
  EXPECT_EQ(read("voltage", 1), "14 EF");
  EXPECT_EQ(read("current", 1), "80 D0");
  EXPECT_EQ(read("charge", 1), "00 0F");
  EXPECT_EQ(read("state", 1), "00 07");
  EXPECT_TRUE(read("cell-15", 1).starts_with("failed")) << "the pack has 14 cells";
}

// Constructed from section 5 of the standard: values with a sign, and refusals.
TEST(Dlt645, ReadsSignsAndRefusals) {
  const Device device = meter("dlt645-2007", "398192000337");
  const Request request = device.read("power:2030000", 1);
  const auto respond = [](Bytes data, std::uint8_t control) {
    Bytes frame = bytes_of("68 37 03 00 92 81 39 68");
    frame.push_back(control);
    frame.push_back(static_cast<std::uint8_t>(data.size()));
    for (const std::uint8_t byte : data) frame.push_back(static_cast<std::uint8_t>(byte + 0x33));
    std::uint8_t sum = 0;
    for (const std::uint8_t byte : frame) sum = static_cast<std::uint8_t>(sum + byte);
    frame.push_back(sum);
    frame.push_back(0x16);
    return frame;
  };
  EXPECT_EQ(items_of(device, request, respond(bytes_of("00 00 03 02 45 23 01"), 0x91)),
            "00 00 30 39");  // 012345
  EXPECT_EQ(items_of(device, request, respond(bytes_of("00 00 03 02 45 23 81"), 0x91)),
            "FF FF CF C7");  // -012345
  const Outcome refused = drive(*device.begin(request), respond({2}, 0xD1));
  EXPECT_EQ(refused.cause, Cause::kDeviceError);
  EXPECT_EQ(refused.code, 2);
  // Of another item, and with a digit that is none.
  EXPECT_FALSE(
      drive(*device.begin(request), respond(bytes_of("00 01 03 02 45 23 01"), 0x91)).done());
  EXPECT_FALSE(
      drive(*device.begin(request), respond(bytes_of("00 00 03 02 4A 23 01"), 0x91)).done());
}

TEST(Dlt645, RefusesAddressesThatNoMeterHas) {
  for (const std::string address : {"1000000000000", "12a", "-1"}) {
    const auto made = declared::make(declaration("dlt645-2007"), {.long_address = address});
    ASSERT_FALSE(made) << address;
    EXPECT_EQ(made.error().allowed, "0..999999999999");
  }
}

// Source: ADAM-4000 Series User Manual, 5-13: the voltages of a module at address 21h.
TEST(Adam, ReadsTheExampleOfTheManual) {
  const Device device = declared_device("adam-4000", 0x21);
  const Request request = device.read("ai1", 4);
  EXPECT_EQ(device.request_bytes(request), ascii("#21\r"));
  EXPECT_EQ(items_of(device, request,
                     ascii(">+7.2111+7.2567+7.3125+7.1000+7.4712+7.2555+7.1234+7.5678\r")),
            "2B 37 2E 32 35 36 37 00");  // +7.2567
}

// Constructed from the manual's command set.
TEST(Adam, SetsOutputsAndClearsTheStatus) {
  const Device device = declared_device("adam-4000", 0x21);
  const Request outputs = device.write("do", "00 12");
  EXPECT_EQ(device.request_bytes(outputs), ascii("#210012\r"));
  EXPECT_TRUE(drive(*device.begin(outputs), ascii(">\r")).done());
  const Outcome refused = drive(*device.begin(outputs), ascii("?21\r"));
  EXPECT_EQ(refused.cause, Cause::kDeviceError);
  const Request clear = device.write("host-ok", "01");
  EXPECT_EQ(device.request_bytes(clear), ascii("~211\r"));
  EXPECT_TRUE(drive(*device.begin(clear), ascii("!21\r")).done());
  // A trigger cannot be read, and only true can be written.
  EXPECT_FALSE(device.protocol().size(device.read("host-ok", 1)));
  EXPECT_FALSE(device.protocol().size(device.write("host-ok", "00")));
}

// Source: Reference Manual MT-SICS 11780711, command S; "S I" and "S +" are its refusals.
TEST(MtSics, ReadsTheExampleOfTheManual) {
  const Device device = declared_device("mt-sics", 1);
  const Request request = device.read("weight", 5);
  EXPECT_EQ(device.request_bytes(request), ascii("SI\r\n"));
  EXPECT_EQ(items_of(device, request, ascii("S S     100.00 g\r\n")), to_hex(ascii("    100.00")));
  EXPECT_EQ(items_of(device, device.read("unit", 3), ascii("S D     100.00 kg\r\n")),
            "6B 67 00 00 00 00");
  EXPECT_EQ(drive(*device.begin(request), ascii("S I\r\n")).cause, Cause::kDeviceBusy);
  const Outcome overload = drive(*device.begin(request), ascii("S +\r\n"));
  EXPECT_EQ(overload.cause, Cause::kDeviceError);
  EXPECT_EQ(overload.code, '+');
}

TEST(MtSics, TaresWithoutAValue) {
  const Device device = declared_device("mt-sics", 1);
  const Request tare = device.write("tare", "01");
  EXPECT_EQ(device.request_bytes(tare), ascii("T\r\n"));
  EXPECT_TRUE(drive(*device.begin(tare), ascii("T S     100.00 g\r\n")).done());
  EXPECT_TRUE(drive(*device.begin(device.write("zero", "01")), ascii("Z A\r\n")).done());
  EXPECT_EQ(drive(*device.begin(tare), ascii("T I\r\n")).cause, Cause::kDeviceBusy);
}

// Each command is refused with its own letters, and ES, ET and EL refuse any command.
TEST(MtSics, RefusesEachCommand) {
  const Device device = declared_device("mt-sics", 1);
  const Request tare = device.read("tare-weight", 5), at_once = device.write("tare-at-once", "01"),
                clear = device.write("clear-tare", "01");
  const auto end = [&](const Request& request, std::string_view response) {
    const Outcome outcome = drive(*device.begin(request), ascii(response));
    return std::pair(outcome.cause, outcome.code);
  };
  EXPECT_EQ(device.request_bytes(tare), ascii("TA\r\n"));
  EXPECT_EQ(device.request_bytes(at_once), ascii("TI\r\n"));
  EXPECT_EQ(device.request_bytes(clear), ascii("TAC\r\n"));
  EXPECT_EQ(end(at_once, "TI D     100.00 g\r\n").first, Cause::kNone);
  EXPECT_EQ(end(clear, "TAC A\r\n").first, Cause::kNone);
  EXPECT_EQ(end(tare, "TA I\r\n"), std::pair(Cause::kDeviceBusy, std::uint16_t{'I'}));
  EXPECT_EQ(end(tare, "TA L\r\n"), std::pair(Cause::kDeviceError, std::uint16_t{'L'}));
  EXPECT_EQ(end(at_once, "TI -\r\n"), std::pair(Cause::kDeviceError, std::uint16_t{'-'}));
  EXPECT_EQ(end(clear, "TAC I\r\n"), std::pair(Cause::kDeviceBusy, std::uint16_t{'I'}));
  for (const Request& request : {tare, at_once, clear, device.read("weight", 5)}) {
    EXPECT_EQ(end(request, "ES\r\n"), std::pair(Cause::kDeviceError, std::uint16_t{'S'}));
    EXPECT_EQ(end(request, "ET\r\n"), std::pair(Cause::kDeviceBusy, std::uint16_t{'T'}));
    EXPECT_EQ(end(request, "EL\r\n"), std::pair(Cause::kDeviceError, std::uint16_t{'L'}));
  }
}

// Source: frame of a Sensus PolluStat, test/test-frames/SEN_Pollustat.hex of libmbus (rscada).
constexpr std::string_view kHeatMeter =
    "68 42 42 68 08 08 72 76 00 05 21 18 4E 31 04 51 00 00 00 0C 07 64 08 00 00 0C 14 92 98 79 00 "
    "0C 7B 02 03 00 00 0C 2C 58 54 00 00 0A 5A 55 07 0A 5E 94 05 0B 60 76 60 01 0C 78 76 00 05 21 "
    "0C FD 10 76 00 05 21 1F B3 16";

Outcome read_meter(const Device& device, std::string_view at, std::uint32_t count, Bytes* session,
                   std::initializer_list<Bytes> responses) {
  const auto exchange = device.protocol().begin(device.read(at, count), {.session = session});
  return drive(*exchange, std::span<const Bytes>(responses.begin(), responses.size()));
}

TEST(MBus, ReadsTheFrameOfAHeatMeterAfterOneReset) {
  const Device device = declared_device("m-bus", 8);
  Bytes session;
  const Outcome first =
      read_meter(device, "energy-10kwh-digits", 2, &session, {Bytes{0xE5}, bytes_of(kHeatMeter)});
  ASSERT_TRUE(first.done()) << to_text(first);
  EXPECT_EQ(to_hex(first.reply[0].items), "00 00 03 60");  // 864
  ASSERT_EQ(first.sent.size(), 2u);
  EXPECT_EQ(to_hex(first.sent[0]), "10 40 08 48 16");
  EXPECT_EQ(to_hex(first.sent[1]), "10 5B 08 63 16");
  // The link is reset once for a connection, and again after a failure.
  const Outcome second =
      read_meter(device, "flow-temperature", 1, &session, {bytes_of(kHeatMeter)});
  ASSERT_TRUE(second.done()) << to_text(second);
  EXPECT_EQ(to_hex(second.reply[0].items), "02 F3");  // 75.5 degrees
  EXPECT_EQ(read_meter(device, "state", 1, &session, {}).cause, Cause::kNoResponse);
  const Outcome third = read_meter(device, "state", 1, &session, {Bytes{0xE5}});
  EXPECT_EQ(to_hex(third.sent[0]), "10 40 08 48 16");
  // A second meter of the line has its own reset.
  session.clear();
  (void)read_meter(device, "state", 1, &session, {Bytes{0xE5}, bytes_of(kHeatMeter)});
  const Outcome other = read_meter(declared_device("m-bus", 9), "state", 1, &session, {});
  EXPECT_EQ(to_hex(other.sent[0]), "10 40 09 49 16");
}

TEST(MBus, RefusesAValueThatTheMeterDoesNotSend) {
  const Device device = declared_device("m-bus", 8);
  const Outcome absent =
      read_meter(device, "energy-wh", 2, nullptr, {Bytes{0xE5}, bytes_of(kHeatMeter)});
  EXPECT_EQ(absent.cause, Cause::kDeviceError);
  Bytes broken = bytes_of(kHeatMeter);
  broken[2] = 0x41;  // the two lengths differ
  EXPECT_FALSE(read_meter(device, "state", 1, nullptr, {Bytes{0xE5}, broken}).done());
}

// The same meter, selected by its number (EN 13757-3, 11.3).
TEST(MBus, SelectsAMeterByItsNumber) {
  const Device device = meter("m-bus-secondary", "21050076");
  const Outcome outcome =
      read_meter(device, "medium", 1, nullptr, {Bytes{0xE5}, bytes_of(kHeatMeter)});
  ASSERT_TRUE(outcome.done()) << to_text(outcome);
  EXPECT_EQ(to_hex(outcome.reply[0].items), "00 04");
  EXPECT_EQ(to_hex(outcome.sent[0]), "68 0B 0B 68 53 FD 52 76 00 05 21 FF FF FF FF 3A 16");
  EXPECT_EQ(to_hex(outcome.sent[1]), "10 5B FD 58 16");
  const Device other = meter("m-bus-secondary", "21050077");
  EXPECT_FALSE(read_meter(other, "medium", 1, nullptr, {Bytes{0xE5}, bytes_of(kHeatMeter)}).done());
}

// Source: readout of an ITRON EM214 in a test of smartmeter-obis, without its C codes; the end and
// the block check character are those of the standard (6.3.1, 6.3.14).
TEST(Iec62056, ReadsThePublishedReadoutOfAMeter) {
  Bytes readout = ascii(
      "F.F(00000000)\r\n0.0.0(1240007670003202)\r\n0.2.0(V01.69#EEA3546C)\r\n"
      "0.2.1(00017245)\r\n1.7.0(00.49*kW)\r\n2.7.0(00.00*kW)\r\n1.8.1(022108.7*kWh)\r\n"
      "1.8.2(000000.0*kWh)\r\n2.8.1(010452.0*kWh)\r\n31.7.0(+000.8*A)\r\n51.7.0(+000.7*A)\r\n"
      "71.7.0(+001.2*A)\r\n!\r\n\x03");
  std::uint8_t check = 0;
  for (const std::uint8_t byte : readout) check ^= byte;
  readout.insert(readout.begin(), 0x02);
  readout.push_back(check);
  const Device device = declared_device("iec62056-21", 1);
  const auto value = [&](std::string_view at, std::uint32_t items) {
    const Outcome outcome =
        read_meter(device, at, items, nullptr, {ascii("/ITR5EM214\r\n"), readout});
    if (!outcome.done()) return to_text(outcome);
    const Bytes& bytes = outcome.reply[0].items;
    return std::string(bytes.begin(), std::ranges::find(bytes, std::uint8_t{0}));
  };
  EXPECT_EQ(value("energy-import-1", 6), "022108.7");
  EXPECT_EQ(value("current-1", 4), "+000.8");
  EXPECT_EQ(value("serial", 8), "1240007670003202");
  const Outcome outcome =
      read_meter(device, "power-import", 5, nullptr, {ascii("/ITR5EM214\r\n"), readout});
  EXPECT_EQ(outcome.sent, (std::vector<Bytes>{ascii("/?!\r\n"), ascii("\x06"
                                                                      "000\r\n")}));
  // 1.8.0 is not in this readout; a damaged one is not accepted.
  EXPECT_EQ(
      read_meter(device, "energy-import", 6, nullptr, {ascii("/ITR5EM214\r\n"), readout}).cause,
      Cause::kDeviceError);
  readout[20] ^= 1;
  EXPECT_EQ(read_meter(device, "current-1", 4, nullptr, {ascii("/ITR5EM214\r\n"), readout}).cause,
            Cause::kChecksum);
}

}  // namespace
}  // namespace fieldcast::test
