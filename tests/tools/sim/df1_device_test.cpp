// Frames as in 1770-6.5.16: chapters 4 and 5, 7-17, 7-18 and 14-2.
#include "tools/sim/families/df1_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/codec/checksum.hpp"
#include "tests/tools/sim/device_setup.hpp"
#include "tests/tools/sim/listen.hpp"

namespace fieldcast::sim {
namespace {

using namespace std::chrono_literals;

class Plc {
 public:
  explicit Plc(bool half_duplex = false)
      : device_(setup(half_duplex)), receiver_(device_.open_receiver()) {}

  // `hex`: all bytes of a frame.
  std::string say(std::string_view hex) {
    return to_hex(test::listen(*receiver_, from_hex(hex).value()).response);
  }
  // `hex`: a command from FNC on. The response from CMD on, without its check.
  std::string ask(std::string_view hex) {
    Bytes data{0x11, 0x00, 0x0F, 0x00, ++tns_, 0x00};
    append(data, from_hex(hex).value());
    Bytes frame{0x10, 0x02};
    append(frame, data);
    append(frame, Bytes{0x10, 0x03, lrc8(data)});
    const Bytes response = test::listen(*receiver_, frame).response;
    (void)say("10 06");
    return response.size() < 11 ? to_hex(response)
                                : to_hex(ByteView(response).subspan(6, response.size() - 9));
  }
  std::uint64_t get(std::string_view name, std::uint32_t item) {
    const auto area = std::ranges::find(kDf1AreaNames, name) - kDf1AreaNames.begin();
    return device_.memory().read(static_cast<std::size_t>(area), item, test::kBegin);
  }
  void put(std::string_view name, std::uint32_t item, std::uint64_t bits) {
    ASSERT_TRUE(device_.poke(name, item, bits));
  }
  Receiver& receiver() { return *receiver_; }

 private:
  static DeviceSetup setup(bool half_duplex) {
    DeviceSetup setup = test::device_setup(17);
    setup.spec.link.options["check"] = "bcc";
    if (half_duplex) setup.spec.link.options["duplex"] = "half";
    return setup;
  }

  Df1Device device_;
  std::unique_ptr<Receiver> receiver_;
  std::uint8_t tns_ = 0x20;
};

TEST(Df1Device, ReadsAndWritesWords) {
  Plc plc;
  plc.put("N", 7005, 0x1234), plc.put("F", 8003, 0x47F1E600), plc.put("T", 12002, 0x0122);
  EXPECT_EQ(plc.ask("A2 02 07 89 05 00"), "4F 00 21 00 34 12");
  EXPECT_EQ(plc.ask("A2 04 08 8A 03 00"), "4F 00 22 00 00 E6 F1 47");
  EXPECT_EQ(plc.ask("A2 02 04 86 00 02"), "4F 00 23 00 22 01");
  EXPECT_EQ(plc.ask("AA 04 07 89 00 00 02 00 03 01"), "4F 00 24 00");
  EXPECT_EQ(plc.get("N", 7000), 2u);
  EXPECT_EQ(plc.get("N", 7001), 0x0103u);
  EXPECT_EQ(plc.ask("AB 02 07 89 00 00 0F 00 05 00"), "4F 00 25 00");
  EXPECT_EQ(plc.get("N", 7000), 5u);
}

TEST(Df1Device, RefusesWhatItDoesNotHave) {
  Plc plc;
  EXPECT_EQ(plc.ask("A2 02 07 8F 05 00"), "4F 50 21 00") << "file type";
  EXPECT_EQ(plc.ask("A2 02 03 84 05 00"), "4F 50 22 00") << "status file 3";
  EXPECT_EQ(plc.ask("A2 03 07 89 05 00"), "4F 50 23 00") << "an odd size";
  EXPECT_EQ(plc.ask("A2 F0 07 89 05 00"), "4F 10 10 24 00") << "too long; a byte 10 is doubled";
  EXPECT_EQ(plc.ask("68 02 07 89 05 00"), "4F 10 10 25 00") << "function";
  EXPECT_EQ(plc.ask("AA 04 07 89 00 00 02 00"), "4F 10 10 26 00") << "too few data";
  EXPECT_EQ(plc.ask("AA 02 00 8B 00 00 02 00"), "4F F0 27 00 10 10") << "an output";
}

TEST(Df1Device, KeepsAResponseUntilItIsAcknowledged) {
  Plc plc;
  const std::string first = "10 02 11 00 0F 00 01 00 A2 02 07 89 00 00 10 03 AB";
  const std::string second = "10 02 11 00 0F 00 02 00 A2 02 07 89 00 00 10 03 AA";
  EXPECT_EQ(plc.say(first), "10 06 10 02 00 11 4F 00 01 00 00 00 10 03 9F");
  EXPECT_EQ(plc.say(second), "10 06") << "the first response is not acknowledged";
  EXPECT_EQ(plc.say("10 15"), "10 02 00 11 4F 00 01 00 00 00 10 03 9F") << "NAK repeats it";
  EXPECT_EQ(plc.say("10 06"), "10 02 00 11 4F 00 02 00 00 00 10 03 9E");
  EXPECT_EQ(plc.say("10 06"), "");
  EXPECT_EQ(plc.say(second), "10 06") << "a repeated command";
}

TEST(Df1Device, RequestsAMissingAcknowledgement) {
  Plc plc;
  EXPECT_EQ(plc.receiver().sends_at(), kNever);
  (void)plc.say("10 02 11 00 0F 00 01 00 A2 02 07 89 00 00 10 03 AB");
  for (int i = 0; i < 3; ++i) {
    Reaction reaction;
    plc.receiver().send(plc.receiver().sends_at(), reaction);
    EXPECT_EQ(to_hex(reaction.response), "10 05");
  }
  Reaction reaction;
  plc.receiver().send(plc.receiver().sends_at(), reaction);
  EXPECT_EQ(to_hex(reaction.response), "") << "given up";
  EXPECT_EQ(plc.receiver().sends_at(), kNever);
}

TEST(Df1Device, RefusesADamagedCommandAndRepeatsThat) {
  Plc plc;
  EXPECT_EQ(plc.say("10 05"), "10 15");
  EXPECT_EQ(plc.say("10 02 11 00 0F 00 01 00 A2 02 07 89 00 00 10 03 AC"), "10 15");
  EXPECT_EQ(plc.say("10 05"), "10 15");
}

TEST(Df1Device, ASlaveSpeaksWhenItIsPolled) {
  Plc plc(true);
  EXPECT_EQ(plc.say("10 05 11 EF"), "10 04");
  const std::string command = "10 01 11 10 02 11 00 0F 00 04 00 A2 02 07 89 00 00 10 03 97";
  EXPECT_EQ(plc.say(command), "10 06");
  const std::string response = "10 02 00 11 4F 00 04 00 00 00 10 03 9C";
  EXPECT_EQ(plc.say("10 05 11 EF"), response);
  EXPECT_EQ(plc.say("10 05 12 EE"), "") << "another station";
  EXPECT_EQ(plc.say("10 05 11 EF"), response) << "not acknowledged";
  EXPECT_EQ(plc.say("10 06"), "");
  EXPECT_EQ(plc.say("10 05 11 EF"), "10 04");
  EXPECT_EQ(plc.say("10 02 11 00 0F 00 05 00 A2 02 07 89 00 00 10 03 A7"), "") << "no station";
}

}  // namespace
}  // namespace fieldcast::sim
