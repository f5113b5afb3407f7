// Requests and responses are the communication examples of SH-080008, 8.2 and 8.3, in a frame as in
// 5.2.
#include "tools/sim/families/mc_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/tools/sim/device_setup.hpp"
#include "tests/tools/sim/listen.hpp"

namespace fieldcast::sim {
namespace {

std::size_t area(std::string_view name) {
  return static_cast<std::size_t>(std::ranges::find(kMcAreaNames, name) - kMcAreaNames.begin());
}

class Plc {
 public:
  explicit Plc(bool ascii = false) : device_(setup(ascii)) {}

  // The end code and the data, of a request from the command on.
  std::string ask(std::string_view hex) {
    const Bytes content = from_hex(hex).value();
    Bytes request = from_hex("50 00 00 FF FF 03 00 00 00 04 00").value();
    request[7] = static_cast<std::uint8_t>(2 + content.size());
    append(request, content);
    const Bytes response = say(request);
    EXPECT_EQ(to_hex(ByteView(response).first(7)), "D0 00 00 FF FF 03 00");
    EXPECT_EQ(response[7] + response[8] * 256u, response.size() - 9);
    return to_hex(ByteView(response).subspan(9));
  }
  std::string ask_in_digits(const std::string& text) {
    const std::string request = "500000FF03FF00" + length(4 + text.size()) + "0004" + text;
    const Bytes response = say({request.begin(), request.end()});
    return {response.begin() + 18, response.end()};
  }
  Bytes say(const Bytes& request) {
    return test::listen(*device_.open_receiver(), request).response;
  }
  void put(std::string_view name, std::uint32_t item, std::uint64_t bits) {
    device_.memory().write(area(name), item, bits);
  }
  [[nodiscard]] std::uint64_t get(std::string_view name, std::uint32_t item) {
    return device_.memory().read(area(name), item, test::kBegin);
  }
  // Puts a number into the bits from `item` on, its lowest bit first.
  void put_bits(std::string_view name, std::uint32_t item, std::uint32_t number, unsigned count) {
    for (unsigned i = 0; i < count; ++i) put(name, item + i, number >> i & 1u);
  }
  McDevice& device() { return device_; }

 private:
  static DeviceSetup setup(bool ascii) {
    DeviceSetup setup = test::device_setup(0);
    if (ascii) setup.spec.link.options["code"] = "ascii";
    setup.first_on_bus = true;
    return setup;
  }
  static std::string length(std::size_t characters) {
    Bytes text;
    append_hex(text, characters, 4);
    return {text.begin(), text.end()};
  }

  McDevice device_;
};

TEST(McDevice, ReadsBitsInWords) {
  Plc binary, ascii(true);
  for (Plc* plc : {&binary, &ascii}) plc->put_bits("M", 100, 0x00021234, 32);
  EXPECT_EQ(binary.ask("01 04 00 00 64 00 00 90 02 00"), "00 00 34 12 02 00");
  EXPECT_EQ(ascii.ask_in_digits("04010000M*0001000002"), "000012340002");
}

TEST(McDevice, ReadsWordsAndBits) {
  Plc plc;
  plc.put("TN", 100, 0x1234), plc.put("TN", 101, 2), plc.put("TN", 102, 0x1DEF);
  EXPECT_EQ(plc.ask("01 04 00 00 64 00 00 C2 03 00"), "00 00 34 12 02 00 EF 1D");
  plc.put_bits("M", 100, 0b11001000, 8);
  EXPECT_EQ(plc.ask("01 04 01 00 64 00 00 90 08 00"), "00 00 00 01 00 11");
  EXPECT_EQ(plc.ask("01 04 03 00 64 00 00 00 90 00 03 00"), "00 00 00 00") << "iQ-R, odd count";
}

TEST(McDevice, Writes) {
  Plc plc;
  EXPECT_EQ(plc.ask("01 14 00 00 64 00 00 A8 03 00 95 19 02 12 30 11"), "00 00");
  EXPECT_EQ(plc.get("D", 100), 0x1995u);
  EXPECT_EQ(plc.get("D", 102), 0x1130u);
  EXPECT_EQ(plc.ask("01 14 01 00 64 00 00 90 08 00 11 00 11 00"), "00 00");
  EXPECT_EQ(plc.get("M", 101), 1u);
  EXPECT_EQ(plc.get("M", 102), 0u);
  plc.put("M", 50, 1);
  EXPECT_EQ(plc.ask("02 14 01 00 02 32 00 00 90 00 2F 00 00 9D 01"), "00 00");
  EXPECT_EQ(plc.get("M", 50), 0u);
  EXPECT_EQ(plc.get("Y", 0x2F), 1u);
  EXPECT_EQ(plc.device().statistics().write_requests, 3u);
}

TEST(McDevice, ReadsScatteredWordsAndDoubleWords) {
  Plc binary, ascii(true);
  for (Plc* plc : {&binary, &ascii}) {
    plc->put("D", 0, 0x1995), plc->put("TN", 0, 0x1202);
    plc->put_bits("M", 100, 0x2030, 16), plc->put_bits("X", 0x20, 0x4849, 16);
    plc->put("D", 1500, 0x4F4E), plc->put("D", 1501, 0x4C54);
    plc->put_bits("Y", 0x160, 0xC3DEB9AF, 32), plc->put_bits("M", 1111, 0xBADDBCB7, 32);
  }
  EXPECT_EQ(binary.ask("03 04 00 00 04 03 00 00 00 A8 00 00 00 C2 64 00 00 90 20 00 00 9C DC 05 00 "
                       "A8 60 01 00 9D 57 04 00 90"),
            "00 00 95 19 02 12 30 20 49 48 4E 4F 54 4C AF B9 DE C3 B7 BC DD BA");
  EXPECT_EQ(ascii.ask_in_digits("040300000403D*000000TN000000M*000100X*000020D*001500Y*000160M*"
                                "001111"),
            "000019951202203048494C544F4EC3DEB9AFBADDBCB7");
}

TEST(McDevice, RefusesWithTheErrorPart) {
  Plc plc;
  const std::string of_read = " 00 FF FF 03 00 01 04 00 00";
  EXPECT_EQ(plc.ask("01 04 00 00 20 00 00 CC 01 00"), "31 40" + of_read) << "Z32";
  EXPECT_EQ(plc.ask("01 04 00 00 00 00 00 A8 C1 03"), "52 C0" + of_read) << "961 words";
  EXPECT_EQ(plc.ask("01 04 00 00 00 00 00 77 01 00"), "5B C0" + of_read) << "no such device";
  EXPECT_EQ(plc.ask("01 04 00 00 00 00 00 A8 01 00 00"), "61 C0" + of_read) << "too long";
  EXPECT_EQ(plc.ask("01 04 00 00 00 00 00 A8"), "61 C0" + of_read) << "too short";
  EXPECT_EQ(plc.ask("01 04 01 00 00 00 00 A8 01 00"), "5C C0 00 FF FF 03 00 01 04 01 00");
  EXPECT_EQ(plc.ask("01 14 01 00 00 00 00 90 02 00 12"), "60 C0 00 FF FF 03 00 01 14 01 00");
  EXPECT_EQ(plc.ask("13 06 00 00"), "59 C0 00 FF FF 03 00 13 06 00 00");
  Plc ascii(true);
  EXPECT_EQ(ascii.ask_in_digits("04010000D*00001A0001"), "C05000FF03FF0004010000");
}

TEST(McDevice, RepeatsTheSerialNumber) {
  Plc plc;
  plc.put("D", 100, 0x1995);
  EXPECT_EQ(to_hex(plc.say(from_hex("54 00 34 12 00 00 00 FF FF 03 00 0C 00 04 00 01 04 00 00 64 "
                                    "00 00 A8 01 00")
                               .value())),
            "D4 00 34 12 00 00 00 FF FF 03 00 04 00 00 00 95 19");
}

// Stations behind one connection receive each other's responses.
TEST(McDevice, SkipsResponsesOfOtherStations) {
  Plc plc;
  Bytes stream = from_hex("D0 00 00 02 FF 03 00 05 00 00 00 12 34 56").value();
  append(stream,
         from_hex("50 00 00 FF FF 03 00 0C 00 04 00 01 04 00 00 64 00 00 A8 01 00").value());
  EXPECT_EQ(to_hex(plc.say(stream)), "D0 00 00 FF FF 03 00 04 00 00 00 00 00");
}

TEST(McDevice, IgnoresOtherStationsAndEndsABrokenStream) {
  Plc plc;
  EXPECT_TRUE(
      plc.say(from_hex("50 00 01 02 FF 03 00 0C 00 04 00 01 04 00 00 64 00 00 A8 01 00").value())
          .empty());
  EXPECT_TRUE(test::listen(*plc.device().open_receiver(), Bytes{0x51, 0x00}).hang_up);
  EXPECT_TRUE(
      test::listen(*plc.device().open_receiver(), from_hex("50 00 00 FF FF 03 00 FF FF").value())
          .hang_up);
}

}  // namespace
}  // namespace fieldcast::sim
