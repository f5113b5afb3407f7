#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/tools/sim/modbus_unit_with_memory.hpp"
#include "tools/sim/families/modbus/modbus_receivers.hpp"

namespace fieldcast::sim {
namespace {

struct Vector {
  std::string name, framing, kind;
  Bytes request, response;
};

std::vector<Vector> vectors() {
  std::ifstream file(FIELDCAST_VECTORS "/modbus.json");
  std::vector<Vector> all;
  for (const auto& entry : nlohmann::json::parse(file)) {
    if (entry.value("request_unverified", false)) continue;
    all.push_back({entry["name"], entry["framing"], entry["kind"],
                   *from_hex(entry.value("request_hex", "")),
                   *from_hex(entry.value("response_hex", ""))});
  }
  return all;
}

Bytes content(const Vector& vector, const Bytes& frame) {
  if (vector.framing == "rtu") return {frame.begin(), frame.end() - 2};
  if (vector.framing == "tcp") return {frame.begin() + 6, frame.end()};
  const std::string digits(frame.begin() + 1, frame.end() - 4);
  return *from_hex(digits);
}

std::unique_ptr<Receiver> receiver_for(const Vector& vector, ModbusUnit& unit) {
  if (vector.framing == "rtu") return std::make_unique<RtuReceiver>(unit, test::kLine, false);
  if (vector.framing == "ascii") return std::make_unique<AsciiReceiver>(unit);
  return std::make_unique<TcpReceiver>(unit, false);
}

std::vector<std::uint16_t> registers(ByteView bytes) {
  std::vector<std::uint16_t> values;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) values.push_back(read_u16(bytes, i));
  return values;
}

std::vector<std::uint16_t> bits(ByteView bytes, std::size_t count) {
  std::vector<std::uint16_t> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(bytes[i / 8] >> (i % 8) & 1u);
  return values;
}

// Fills the memory so that the device must give the vector's response.
void prepare(ModbusUnitWithMemory& unit, ByteView request, ByteView answer) {
  const std::uint8_t function = request[1];
  const auto preset = [&](std::size_t area, std::uint32_t first,
                          const std::vector<std::uint16_t>& values) {
    for (const std::uint16_t value : values) unit.memory.write(area, first++, value);
  };
  const auto first = [&] { return read_u16(request, 2); };
  switch (function) {
    case 0x01:
      return preset(ModbusArea::kCoil, first(), bits(answer.subspan(3), read_u16(request, 4)));
    case 0x02:
      return preset(ModbusArea::kInput, first(), bits(answer.subspan(3), read_u16(request, 4)));
    case 0x03: return preset(ModbusArea::kHolding, first(), registers(answer.subspan(3)));
    case 0x04: return preset(ModbusArea::kInputRegister, first(), registers(answer.subspan(3)));
    case 0x07: return preset(ModbusArea::kCoil, 0, bits(answer.subspan(2), 8));
    case 0x14: {
      std::size_t group = 3;
      for (std::size_t at = 3; at < answer.size(); at += 1u + answer[at], group += 7)
        preset(ModbusArea::kFile,
               read_u16(request, group + 1) * 10000u + read_u16(request, group + 3),
               registers(answer.subspan(at + 2, answer[at] - 1u)));
      return;
    }
    case 0x16: return preset(ModbusArea::kHolding, first(), {0x0012});
    case 0x17: return preset(ModbusArea::kHolding, first(), registers(answer.subspan(3)));
    case 0x18: return preset(ModbusArea::kFifo, first() * 32u, registers(answer.subspan(4)));
    case 0x2B: {
      std::vector<std::string> objects;
      for (std::size_t at = 8; at + 1 < answer.size(); at += 2u + answer[at + 1]) {
        objects.resize(answer[at] + std::size_t{1});
        objects.back().assign(
            answer.begin() + static_cast<std::ptrdiff_t>(at) + 2,
            answer.begin() + static_cast<std::ptrdiff_t>(at) + 2 + answer[at + 1]);
      }
      return unit.identify_as(objects, answer[4]);
    }
    default: return;
  }
}

// Refuses the range of the vector's exception, unless the request itself is wrong.
DeviceSetup refusing(std::uint8_t code) {
  DeviceSetup setup;
  if (code == 3) return setup;
  for (const auto area : kModbusAreaNames)
    setup.refused.push_back({std::string(area), 0, 65535, code});
  return setup;
}

TEST(ModbusVectors, DeviceRespondsAsPrinted) {
  int good = 0, refused = 0;
  for (const Vector& vector : vectors()) {
    if (vector.kind == "malformed" || vector.request.empty() || vector.response.empty()) continue;
    SCOPED_TRACE(vector.name);
    const Bytes request = content(vector, vector.request),
                answer = content(vector, vector.response);
    const bool ok = vector.kind == "ok";
    ModbusUnitWithMemory unit(request[0], ok ? DeviceSetup{} : refusing(answer[2]));
    if (ok) prepare(unit, request, answer);
    const Bytes said = test::listen(*receiver_for(vector, unit), vector.request).response;
    if (vector.framing != "tcp" && request[0] == 0) {
      EXPECT_TRUE(said.empty()) << "a broadcast has no response";
    } else {
      EXPECT_EQ(to_hex(said), to_hex(vector.response));
    }
    ++(vector.kind == "ok" ? good : refused);
  }
  EXPECT_GE(good, 50);
  EXPECT_GE(refused, 25);
}

TEST(ModbusVectors, WritesLandInMemory) {
  const auto items = [](ModbusUnitWithMemory& unit, std::size_t area, std::uint32_t first,
                        std::uint32_t count) {
    std::vector<std::uint64_t> all;
    for (std::uint32_t i = 0; i < count; ++i)
      all.push_back(unit.memory.read(area, first + i, test::kBegin));
    return all;
  };
  const auto written = [](ModbusUnit& unit, const char* request) {
    RtuReceiver receiver(unit, test::kLine, false);
    return test::listen(receiver, *from_hex(request)).response;
  };
  ModbusUnitWithMemory unit(0x2A), seventeen(0x11);
  EXPECT_FALSE(written(unit, "2A06001012348363").empty());
  EXPECT_EQ(items(unit, ModbusArea::kHolding, 0x10, 1), (std::vector<std::uint64_t>{0x1234}));
  EXPECT_FALSE(written(unit, "2A100010000204123456780773").empty());
  EXPECT_EQ(items(unit, ModbusArea::kHolding, 0x10, 2),
            (std::vector<std::uint64_t>{0x1234, 0x5678}));
  EXPECT_FALSE(written(unit, "2A0F0010000A021234002E").empty());
  EXPECT_EQ(items(unit, ModbusArea::kCoil, 0x10, 16),
            (std::vector<std::uint64_t>{0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
                                        0}));  // bits beyond the tenth are ignored
  EXPECT_FALSE(written(seventeen, "111700030006000E00030600FF00FF00FF4B54").empty());
  EXPECT_EQ(items(seventeen, ModbusArea::kHolding, 14, 3),
            (std::vector<std::uint64_t>{0xFF, 0xFF, 0xFF}));
  EXPECT_EQ(unit.statistics().writes.at("holding:16"), 2u);
  EXPECT_EQ(unit.statistics().writes.at("holding:17"), 1u);
}

struct Malformed {
  const char* name;
  enum { kSilence, kBroadcast, kAnswer, kRefusal1, kRefusal3, kHangUp } expected;
};

TEST(ModbusVectors, MalformedRequestsDoNoHarm) {
  const Malformed table[] = {
      {"ascii_garbage_prefix", Malformed::kBroadcast},
      {"ascii_restart_on_colon", Malformed::kAnswer},
      {"ascii_lowercase", Malformed::kSilence},
      {"ascii_nonhex", Malformed::kSilence},
      {"tcp_bad_protocol_id", Malformed::kHangUp},
      {"tcp_bad_protocol_id_pymodbus", Malformed::kHangUp},
      {"tcp_len_zero", Malformed::kHangUp},
      {"tcp_len_max", Malformed::kRefusal1},
      {"tcp_bad_fc15_bc0", Malformed::kRefusal3},
      {"tcp_bad_fc15_missing", Malformed::kRefusal3},
      {"tcp_bad_fc16_bc3", Malformed::kRefusal3},
      {"tcp_bad_fc16_trailing", Malformed::kRefusal3},
      {"tcp_fc23_write122_overlong", Malformed::kHangUp},
  };
  const auto all = vectors();
  for (const Malformed& row : table) {
    SCOPED_TRACE(row.name);
    const auto found = std::ranges::find(all, row.name, &Vector::name);
    ASSERT_NE(found, all.end());
    const Bytes& stream = found->request.empty()
                              ? found->response
                              : found->request;  // requests are printed on both sides
    const bool tcp = found->framing == "tcp";
    ModbusUnitWithMemory unit(tcp ? stream[6] : std::uint8_t{0x11});
    const Reaction reaction = test::listen(*receiver_for(*found, unit), stream);
    EXPECT_EQ(reaction.hang_up, row.expected == Malformed::kHangUp);
    EXPECT_TRUE(unit.statistics().writes.empty());
    EXPECT_EQ(unit.statistics().broadcasts, row.expected == Malformed::kBroadcast ? 1u : 0u);
    if (row.expected == Malformed::kRefusal1 || row.expected == Malformed::kRefusal3) {
      ASSERT_EQ(reaction.response.size(), 9u);
      EXPECT_EQ(reaction.response[8], row.expected == Malformed::kRefusal1 ? 1 : 3);
    } else {
      EXPECT_EQ(reaction.response.empty(), row.expected != Malformed::kAnswer);
    }
  }
}

TEST(ModbusVectors, TwoSlavesBackToBack) {
  const Bytes stream = *from_hex("02030000000184390203021234F133010300000001840A");
  ModbusUnitWithMemory unit(1);
  unit.memory.write(ModbusArea::kHolding, 0, 0);
  RtuReceiver receiver(unit, test::kLine, false);
  EXPECT_EQ(to_hex(test::listen(receiver, stream, test::kBegin, false).response, '\0'),
            "0103020000B844");
  EXPECT_EQ(unit.statistics().requests.at("03"), 1u);
  EXPECT_EQ(unit.statistics().bad_frames, 0u);
}

}  // namespace
}  // namespace fieldcast::sim
