#include <gtest/gtest.h>

#include "core/codec/checksum.hpp"
#include "tests/tools/sim/listen.hpp"
#include "tests/tools/sim/modbus_unit_with_memory.hpp"
#include "tools/sim/families/modbus/modbus_receivers.hpp"

namespace fieldcast::sim {
namespace {

Bytes rtu(Bytes frame) {
  const std::uint16_t crc = crc16_modbus(frame);
  frame.push_back(static_cast<std::uint8_t>(crc));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8));
  return frame;
}

Bytes said(ModbusUnit& unit, const Bytes& frame) {
  RtuReceiver receiver(unit, test::kLine, false);
  return test::listen(receiver, frame).response;
}

TEST(ModbusAddressText, ReadsNamesAndReferenceNumbers) {
  const auto holding = parse_modbus_address("holding:107.3");
  ASSERT_TRUE(holding);
  EXPECT_EQ(holding->area, std::size_t{ModbusArea::kHolding});
  EXPECT_EQ(holding->first, 107);
  EXPECT_EQ(holding->bit, 3);
  EXPECT_EQ(parse_modbus_address("40108")->first, 107);
  EXPECT_EQ(parse_modbus_address("00001")->area, std::size_t{ModbusArea::kCoil});
  EXPECT_EQ(parse_modbus_address("10001")->area, std::size_t{ModbusArea::kInput});
  EXPECT_EQ(parse_modbus_address("365536")->first, 65535);
  for (const char* wrong : {"", "holding", "holding:", "holding:65536", "holding:1.16", "40000",
                            "50001", "4001", "465537", "coil:-1", "4x001"}) {
    EXPECT_FALSE(parse_modbus_address(wrong)) << wrong;
  }
}

TEST(RtuReceiver, WrongChecksumGetsSilenceAndIsCounted) {
  ModbusUnitWithMemory unit(1);
  Bytes frame = rtu({1, 6, 0, 5, 0, 9});
  for (std::size_t bit = 0; bit < frame.size() * 8; ++bit) {
    Bytes broken = frame;
    broken[bit / 8] = static_cast<std::uint8_t>(broken[bit / 8] ^ 1u << (bit % 8));
    EXPECT_TRUE(said(unit, broken).empty()) << bit;
  }
  EXPECT_TRUE(unit.statistics().writes.empty());
  EXPECT_GT(unit.statistics().bad_frames, 0u);
}

TEST(RtuReceiver, BroadcastIsExecutedWithoutResponse) {
  ModbusUnitWithMemory unit(7);
  EXPECT_TRUE(said(unit, rtu({0, 6, 0, 5, 0x12, 0x34})).empty());
  EXPECT_EQ(unit.memory.read(ModbusArea::kHolding, 5, test::kBegin), 0x1234);
  EXPECT_EQ(unit.statistics().broadcasts, 1u);
}

TEST(RtuReceiver, AfterABrokenFrameOnlySilenceHelps) {
  ModbusUnitWithMemory unit(1);
  RtuReceiver receiver(unit, test::kLine, false);
  Bytes broken = rtu({1, 3, 0, 0, 0, 1});
  broken[3] = 9;
  const Bytes good = rtu({1, 3, 0, 0, 0, 1});
  const Instant next = test::kBegin + test::kLine.characters(8);
  EXPECT_TRUE(test::listen(receiver, broken, test::kBegin, false).response.empty());
  EXPECT_TRUE(test::listen(receiver, good, next, false).response.empty());  // immediately after it
  EXPECT_FALSE(
      test::listen(receiver, good, next + test::kLine.characters(13), false).response.empty());
}

TEST(RtuReceiver, ForeignResponseThatHoldsARequestForUsIsNotExecuted) {
  ModbusUnitWithMemory unit(1);
  RtuReceiver receiver(unit, test::kLine, false);
  Bytes answer{2, 3, 8};
  append(answer, rtu({1, 6, 0, 1, 0, 1}));
  EXPECT_TRUE(test::listen(receiver, rtu(answer)).response.empty());
  EXPECT_TRUE(unit.statistics().requests.empty());
}

// Its first eight bytes are a whole request: 01 03 04 03 80 01 with the checksum FA14.
TEST(RtuReceiver, ForeignResponseThatBeginsLikeARequestDoesNotHideTheNextOne) {
  ModbusUnitWithMemory unit(3);
  RtuReceiver receiver(unit, test::kLine, false);
  const Bytes answer{0x01, 0x03, 0x04, 0x03, 0x80, 0x01, 0x14, 0xFA, 0x00};
  ASSERT_EQ(rtu({0x01, 0x03, 0x04, 0x03, 0x80, 0x01, 0x14}), answer);
  Instant at = test::kBegin;
  for (const Bytes& frame : {rtu({1, 3, 3, 0x0A, 0, 2}), answer}) {
    EXPECT_TRUE(test::listen(receiver, frame, at, false).response.empty());
    at += test::kLine.characters(static_cast<std::uint32_t>(frame.size()) + 2);
  }
  EXPECT_FALSE(test::listen(receiver, rtu({3, 3, 0, 0xFB, 0, 0x0B}), at, false).response.empty());
  EXPECT_EQ(unit.statistics().bad_frames, 0u);
}

TEST(RtuReceiver, HeldBackHalfOfAFrameIsAFrameOnAStream) {
  const Bytes request = rtu({1, 3, 0, 0, 0, 1});
  for (const bool stream : {false, true}) {
    ModbusUnitWithMemory unit(1);
    RtuReceiver receiver(unit, test::kLine, stream);
    EXPECT_TRUE(
        test::listen(receiver, ByteView(request).first(3), test::kBegin, false).response.empty());
    const Instant later = test::kBegin + std::chrono::milliseconds{20};
    EXPECT_EQ(test::listen(receiver, ByteView(request).subspan(3), later).response.empty(),
              !stream);
  }
}

TEST(ModbusUnit, ChecksInTheOrderOfTheStandard) {
  ModbusUnitWithMemory unit(1, {.refused = {{"holding", 107, 109, 2}, {"coil", 0, 0, 6}}});
  const auto code = [&](const Bytes& pdu) { return unit.execute(pdu, test::kBegin).at(1); };
  EXPECT_EQ(code({0x03, 0, 107, 0, 0}), 3);      // the quantity is checked first
  EXPECT_EQ(code({0x03, 0, 106, 0, 2}), 2);      // touches 107
  EXPECT_EQ(code({0x03, 0, 105, 0, 2}), 4);      // a good response: its byte count
  EXPECT_EQ(code({0x03, 0xFF, 0xFF, 0, 2}), 2);  // beyond the area
  EXPECT_EQ(code({0x01, 0, 0, 0, 1}), 6);
  EXPECT_EQ(code({0x63, 0, 0, 0, 1}), 1);
  EXPECT_EQ(code({0x10, 0, 107, 0, 1, 2, 0, 1}), 2);
  EXPECT_EQ(code({0x17, 0, 1, 0, 1, 0, 107, 0, 1, 2, 0, 1}), 2);
  EXPECT_TRUE(unit.statistics().writes.empty());
}

TEST(ModbusUnit, ChecksFileRecordsInTheOrderOfTheStandard) {
  ModbusUnitWithMemory unit(1, {.refused = {{"file", 40005, 40005, 4}}});
  const auto code = [&](const Bytes& pdu) {
    const Bytes response = unit.execute(pdu, test::kBegin);
    return response[0] == pdu[0] ? 0 : response.at(1);
  };
  EXPECT_EQ(code({0x14, 7, 6, 0, 4, 0, 1, 0, 2}), 0);
  EXPECT_EQ(code({0x14, 8, 6, 0, 4, 0, 1, 0, 2}), 3);        // byte count
  EXPECT_EQ(code({0x14, 8, 6, 0, 4, 0, 1, 0, 2, 0}), 3);     // no whole group
  EXPECT_EQ(code({0x14, 0}), 3);                             // no group
  EXPECT_EQ(code({0x14, 7, 5, 0, 4, 0, 1, 0, 2}), 2);        // reference type
  EXPECT_EQ(code({0x14, 7, 6, 0, 4, 0x27, 0x10, 0, 1}), 2);  // record 10000
  EXPECT_EQ(code({0x14, 7, 6, 0, 4, 0x27, 0x0F, 0, 2}), 2);  // its end
  EXPECT_EQ(code({0x14, 7, 6, 0, 4, 0, 1, 0, 122}), 3);      // 246 bytes
  EXPECT_EQ(code({0x14, 7, 6, 0, 4, 0, 4, 0, 2}), 4);
  EXPECT_EQ(code({0x15, 9, 6, 0, 4, 0, 5, 0, 1, 0, 1}), 4);
  EXPECT_EQ(code({0x15, 9, 6, 0, 4, 0, 1, 0, 2, 0, 1}), 3);  // one register too few
  EXPECT_EQ(code({0x15, 18, 6, 0, 4, 0, 1, 0, 1, 0, 1, 6, 0, 4, 0, 5, 0, 1, 0, 1}), 4);
  EXPECT_TRUE(unit.statistics().writes.empty()) << "no group is written if one is refused";
  EXPECT_EQ(code({0x15, 18, 6, 0, 4, 0, 1, 0, 1, 0, 1, 6, 0, 5, 0, 1, 0, 1, 0, 1}), 0);
  EXPECT_EQ(unit.statistics().writes.at("file:40001"), 1u);
  EXPECT_EQ(unit.statistics().writes.at("file:50001"), 1u);
}

TEST(ModbusUnit, AQueueEndsAtItsCountOrItsLastRegister) {
  ModbusUnitWithMemory unit(1, {.refused = {{"fifo", 9 * 32 + 2, 9 * 32 + 2, 4}}});
  const auto queue = [&](std::uint8_t pointer) {
    return to_hex(unit.execute(Bytes{0x18, 0, pointer}, test::kBegin));
  };
  EXPECT_EQ(queue(7), "18 00 02 00 00") << "an empty queue";
  unit.memory.write(ModbusArea::kFifo, 7 * 32 + 2, 0x1284);
  EXPECT_EQ(queue(7), "18 00 06 00 02 00 00 12 84");
  unit.memory.write(ModbusArea::kFifo, 7 * 32, 1);
  EXPECT_EQ(queue(7), "18 00 04 00 01 00 00");
  unit.memory.write(ModbusArea::kFifo, 7 * 32, 32);
  EXPECT_EQ(queue(7), "98 03") << "more than 31 registers";
  unit.memory.write(ModbusArea::kFifo, 9 * 32, 1);
  EXPECT_EQ(queue(9), "18 00 04 00 01 00 00");
  unit.memory.write(ModbusArea::kFifo, 9 * 32, 2);
  EXPECT_EQ(queue(9), "98 04");
  EXPECT_EQ(unit.execute(Bytes{0x18, 0}, test::kBegin)[1], 3);
  const Waveform wave{Shape::kRamp, 40, 40, std::chrono::seconds{10}, 0};
  ASSERT_TRUE(unit.memory.add_channel(*parse_modbus_address("fifo:5"), {}, wave));
  EXPECT_EQ(queue(5).substr(0, 14), "18 00 12 00 08") << "a moving count stays below 32";
}

TEST(ModbusUnit, IdentifiesItselfAsAStreamOrObjectByObject) {
  ModbusUnitWithMemory unit(1);
  const auto text = [&](std::uint8_t code, std::uint8_t object) {
    const Bytes response = unit.execute(Bytes{0x2B, 0x0E, code, object}, test::kBegin);
    return std::string(response.begin(), response.end());
  };
  using namespace std::string_literals;
  const std::string first = "\x00\x09"s + "Fieldcast"s, last = "\x02\x03"s + "1.0"s;
  EXPECT_EQ(text(4, 0), "\x2B\x0E\x04\x83\0\0\x01"s + first);
  EXPECT_EQ(text(4, 2), "\x2B\x0E\x04\x83\0\0\x01"s + last);
  EXPECT_EQ(text(4, 3), "\xAB\x02") << "it has no vendor URL";
  EXPECT_EQ(text(5, 0), "\xAB\x03");
  EXPECT_EQ(text(1, 2), "\x2B\x0E\x01\x83\0\0\x01"s + last);
  EXPECT_EQ(text(1, 3), text(1, 0)) << "a stream from an unknown object is the whole one";
  unit.identify_as({std::string(150, 'a'), std::string(150, 'b')});
  EXPECT_EQ(text(1, 0).substr(4, 3), "\xFF\x01\x01") << "the second object follows";
  EXPECT_EQ(text(1, 1).size(), 7 + 2 + 150 + last.size());
  unit.identify_as({"basic"}, 0x01);
  EXPECT_EQ(text(4, 0), "\xAB\x03") << "only streams";
}

TEST(ModbusUnit, OnlyConfiguredAddressesExistWhenSo) {
  ModbusUnitWithMemory unit(1, {.only_configured = true});
  Encoding real;
  real.type = ValueType::kFloat32;
  ASSERT_TRUE(unit.memory.add_channel(*parse_modbus_address("holding:10"), real, Waveform{}));
  const auto refused = [&](std::uint8_t first, std::uint8_t count) {
    return unit.execute(Bytes{3, 0, first, 0, count}, test::kBegin)[0] != 3;
  };
  EXPECT_FALSE(refused(10, 2));
  EXPECT_FALSE(refused(11, 1));
  EXPECT_TRUE(refused(9, 2));
  EXPECT_TRUE(refused(11, 2));
}

TEST(ModbusMemory, WrittenChannelsHoldAndOthersMove) {
  ItemMemory memory(modbus_areas(), {.start = test::kBegin});
  const Waveform wave{Shape::kRamp, 0, 1000, std::chrono::seconds{10}, 0};
  ASSERT_TRUE(memory.add_channel(*parse_modbus_address("holding:1"), {}, wave));
  ASSERT_TRUE(memory.add_channel(*parse_modbus_address("holding:2"), {}, wave));
  memory.write(ModbusArea::kHolding, 1, 4711);
  const Instant later = test::kBegin + std::chrono::seconds{5};
  EXPECT_EQ(memory.read(ModbusArea::kHolding, 1, later), 4711u);
  EXPECT_EQ(memory.read(ModbusArea::kHolding, 2, later), 500u);
}

TEST(ModbusMemory, ACoilHoldsNoNumber) {
  ItemMemory memory(modbus_areas(), {.start = test::kBegin});
  EXPECT_TRUE(memory.add_channel(*parse_modbus_address("coil:3"), {ValueType::kBool}, {}));
  EXPECT_FALSE(memory.add_channel(*parse_modbus_address("coil:3"), {ValueType::kInt16}, {}));
}

TEST(ModbusMemory, BitsOfOneWordMoveApart) {
  ItemMemory memory(modbus_areas(), {.start = test::kBegin});
  Encoding flag;
  flag.type = ValueType::kBool;
  const Waveform square{Shape::kSquare, 0, 1, std::chrono::seconds{2}, 0};
  const Waveform slower{Shape::kSquare, 0, 1, std::chrono::seconds{4}, 0};
  ASSERT_TRUE(memory.add_channel(*parse_modbus_address("holding:5.0"), flag, square));
  ASSERT_TRUE(memory.add_channel(*parse_modbus_address("holding:5.15"), flag, slower));
  const auto word = [&](int seconds) {
    return memory.read(ModbusArea::kHolding, 5, test::kBegin + std::chrono::seconds{seconds});
  };
  EXPECT_EQ(word(0), 0u);
  EXPECT_EQ(word(1), 1u);
  EXPECT_EQ(word(2), 0x8000u);
  EXPECT_EQ(word(3), 0x8001u);
}

}  // namespace
}  // namespace fieldcast::sim
