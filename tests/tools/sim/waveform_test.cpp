// Tests the simulator's own encoding with the bridge's codec, which is independent of it.
#include "tools/sim/device/waveform.hpp"

#include <gtest/gtest.h>

#include "core/codec/value_codec.hpp"
#include "tests/tools/sim/device_setup.hpp"

namespace fieldcast::sim {
namespace {

Bytes image(const std::vector<std::uint16_t>& items) {
  Bytes bytes;
  for (const std::uint16_t item : items) append_u16(bytes, item);
  return bytes;
}

double number(const Value& value) {
  return std::visit(
      [](const auto& v) -> double {
        if constexpr (std::is_arithmetic_v<std::decay_t<decltype(v)>>)
          return static_cast<double>(v);
        return 0;
      },
      value);
}

TEST(Waveform, EveryTypeAndOrderReadsBack) {
  for (const auto type :
       {ValueType::kInt16, ValueType::kUint16, ValueType::kInt32, ValueType::kUint32,
        ValueType::kInt64, ValueType::kUint64, ValueType::kFloat32, ValueType::kFloat64,
        ValueType::kBcd16, ValueType::kBcd32}) {
    for (const auto words : {WordOrder::kBigEndian, WordOrder::kLittleEndian}) {
      for (const auto bytes : {ByteOrder::kBigEndian, ByteOrder::kLittleEndian}) {
        Encoding encoding;
        encoding.type = type;
        encoding.word_order = words;
        encoding.byte_order = bytes;
        const bool is_signed =
            type == ValueType::kInt16 || type == ValueType::kInt32 || type == ValueType::kInt64;
        const double low = is_signed ? -30000 : 0, high = 9999;
        const Waveform wave{Shape::kRamp, low, high, std::chrono::seconds{10}, 0};
        for (int ms = 0; ms < 10000; ms += 37) {
          const Duration at = std::chrono::milliseconds{ms};
          const auto value = decode_value(encoding, 16, image(waveform_items(wave, encoding, at)));
          ASSERT_TRUE(value) << to_text(type);
          ASSERT_NEAR(number(*value), wave.at(at), 0.51) << to_text(type) << " at " << ms;
        }
      }
    }
  }
}

TEST(Waveform, TextsReadBack) {
  Encoding text;
  text.type = ValueType::kString;
  text.string_bytes = 9;
  const Waveform wave{Shape::kConstant, 42, 42, std::chrono::seconds{10}, 0};
  const auto value = decode_value(text, 16, image(waveform_items(wave, text, Duration{})));
  ASSERT_TRUE(value);
  EXPECT_EQ(std::get<std::string>(*value), "LOT-00042");
}

TEST(Waveform, DatesReadBackAndHaveTheirWeekday) {
  const Waveform wave{Shape::kConstant, 90061, 90061, std::chrono::seconds{10}, 0};
  for (const auto& [layout, text] :
       {std::pair{TextLayout::kDtl, "2026-01-02T01:01:01.000000000"},
        std::pair{TextLayout::kDateAndTime, "2026-01-02T01:01:01.000"}}) {
    const Encoding date{
        .type = ValueType::kString, .string_bytes = date_time_characters(layout), .layout = layout};
    const Bytes items = image(waveform_items(wave, date, Duration{}));
    EXPECT_EQ(decode_value(date, 8, items), Value{std::string(text)});
    EXPECT_EQ(encode_value(date, 8, Value{std::string(text)}), items);
  }
}

TEST(Waveform, StaysInsideItsChannelsLimits) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    ChannelSpec channel;
    channel.name = "pressure";
    channel.encoding.type = ValueType::kInt16;
    channel.encoding.scale = 0.1;
    channel.encoding.offset = -5;
    channel.limits.low = 1;
    channel.limits.high = 20;
    const Waveform wave = waveform_for(channel, seed);
    for (int s = 0; s < 100; ++s) {
      const double value = wave.at(std::chrono::milliseconds{s * 333}) * 0.1 - 5;
      ASSERT_GE(value, 1 - 1e-9) << seed;
      ASSERT_LE(value, 20 + 1e-9) << seed;
    }
  }
}

// A channel whose exponent is in another register, which is a channel too.
DeviceSetup with_exponent(const std::string& protocol, const std::string& at,
                          const std::string& exponent) {
  DeviceSetup setup = test::device_setup(1);
  setup.spec.protocol = protocol;
  setup.only_configured = true;
  ChannelSpec value = test::channel("voltage", at, ValueType::kUint16);
  value.exponent_from = exponent;
  value.encoding.exponent_distance = 3;
  value.limits.low = 210;
  value.limits.high = 250;
  setup.spec.channels = {test::channel("exponent", exponent, ValueType::kInt16), value};
  return setup;
}

TEST(Waveform, AnExponentIsConstantAndItsValueStaysInsideItsLimits) {
  struct Case {
    const char *protocol, *at, *exponent, *area;
  };
  for (const Case& each : {Case{"modbus-rtu", "holding:100", "40104", "holding"},
                           Case{"omron-hostlink", "DM100", "DM103", "DM"}}) {
    const auto device =
        find_device_kind(each.protocol)->make(with_exponent(each.protocol, each.at, each.exponent));
    ASSERT_TRUE(device) << device.error();
    for (int s = 0; s < 60; ++s) {
      const Instant now = test::kBegin + std::chrono::milliseconds{s * 333};
      ASSERT_EQ((*device)->peek(each.area, 103, now), 0xFFFFu) << each.protocol;
      const double value = static_cast<double>((*device)->peek(each.area, 100, now).value()) / 10;
      ASSERT_GE(value, 210) << each.protocol;
      ASSERT_LE(value, 250) << each.protocol;
    }
  }
  EXPECT_FALSE(
      find_device_kind("modbus-rtu")->make(with_exponent("modbus-rtu", "holding:100", "coil:3")));
}

TEST(Waveform, TheSameSeedIsTheSamePlant) {
  ChannelSpec channel;
  channel.name = "flow";
  const auto at = [&](std::uint64_t seed) {
    return waveform_for(channel, seed).at(std::chrono::seconds{3});
  };
  EXPECT_EQ(at(7), at(7));
  EXPECT_NE(at(7), at(8));
}

}  // namespace
}  // namespace fieldcast::sim
