// Golden frames for the declarations that are shipped. Each test names the source of its frames.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace fieldcast::test
