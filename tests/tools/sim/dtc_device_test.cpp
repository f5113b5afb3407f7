#include "tools/sim/families/dtc_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "core/codec/checksum.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/tools/sim/listen.hpp"

namespace fieldcast::sim {
namespace {

using nlohmann::json;

json vectors() {
  std::ifstream file(FIELDCAST_VECTORS "/dtc.json");
  return json::parse(file);
}

DeviceSetup setup(std::uint16_t address, const std::string& threshold = "65535") {
  DeviceSetup made;
  made.spec.name = "plc";
  made.spec.link = {address, {{"threshold", threshold}}};
  made.line = test::kLine;
  made.start = test::kBegin;
  return made;
}

Bytes said(DtcDevice& device, ByteView packet) {
  return test::listen(*device.open_receiver(), packet).response;
}

Bytes plain(std::string_view hex_without_crc) {
  Bytes message = *from_hex(hex_without_crc);
  const std::uint16_t crc = crc16_modbus(message);
  message.push_back(static_cast<std::uint8_t>(crc));
  message.push_back(static_cast<std::uint8_t>(crc >> 8));
  Bytes packet{0};
  append_u16(packet, static_cast<std::uint16_t>(message.size()));
  append(packet, message);
  return packet;
}
std::string refusal(DtcDevice& device, std::string_view hex) {
  return to_hex(said(device, plain(hex)), '\0');
}

std::uint8_t type_of(const json& group) {
  return static_cast<std::uint8_t>(
      std::ranges::find(kDtcAreaNames, group["type"].get<std::string>()) - kDtcAreaNames.begin());
}

std::uint64_t bits_of(const json& value, std::uint8_t type) {
  switch (type) {
    case 1: return static_cast<std::uint16_t>(value.get<std::int16_t>());
    case 2: return static_cast<std::uint32_t>(value.get<std::int32_t>());
    case 3: return std::bit_cast<std::uint32_t>(value.get<float>());
    case 4: return std::bit_cast<std::uint64_t>(value.get<double>());
    default: return value.get<std::uint64_t>();
  }
}

template <typename Visit>
void each_variable(const json& groups, const Visit& visit) {
  for (const json& group : groups) {
    for (std::size_t i = 0; i < group["values"].size(); ++i) {
      const std::uint8_t type = type_of(group);
      visit(type, static_cast<std::uint16_t>(group["first"].get<unsigned>() + i),
            bits_of(group["values"][i], type));
    }
  }
}

TEST(DtcDeviceVectors, RespondsAsPrinted) {
  int reads = 0, writes = 0;
  for (const json& vector : vectors()) {
    const std::string name = vector["name"];
    if (vector["kind"] != "ok" || !vector.contains("request_hex")) continue;
    SCOPED_TRACE(name);
    const Bytes request = *from_hex(vector["request_hex"].get<std::string>());
    ASSERT_EQ(request[0], 0) << "a compressed request: take its address from the message";
    DtcDevice device(setup(request[3], name.find("lzw") != std::string::npos ? "0" : "65535"));
    const bool write = name.starts_with("write_");
    if (!write) {
      each_variable(vector["groups"],
                    [&](auto type, auto at, auto bits) { device.memory().write(type, at, bits); });
    }
    EXPECT_EQ(to_hex(said(device, request), '\0'), vector["response_hex"].get<std::string>());
    each_variable(vector["groups"], [&](auto type, auto at, auto bits) {
      EXPECT_EQ(device.memory().read(type, at, test::kBegin), bits) << int{type} << ":" << at;
    });
    ++(write ? writes : reads);
  }
  EXPECT_GE(reads, 24);
  EXPECT_GE(writes, 12);
}

TEST(DtcDeviceVectors, RefusesAsPrinted) {
  DtcDevice device(setup(7));
  std::map<std::string, std::string> printed;
  for (const json& vector : vectors()) {
    if (vector["kind"] == "exception") printed[vector["name"]] = vector["response_hex"];
  }
  EXPECT_EQ(refusal(device, "07 00 FFFF 01 0002"), printed.at("refusal_2"));
  EXPECT_EQ(refusal(device, "07 00 0000 05 0001"), printed.at("refusal_3"));
  EXPECT_EQ(refusal(device, "07 00 0000 01 0400"), printed.at("refusal_4"));  // a response of 2 KiB
  EXPECT_EQ(refusal(device, "07 00 0000 01"), printed.at("refusal_4"));       // a truncated group
  EXPECT_EQ(refusal(device, "07 00 0000 01 0000"), printed.at("refusal_5"));
  EXPECT_EQ(refusal(device, "07 02").substr(6, 6), "078201");
  EXPECT_EQ(device.statistics().exceptions.at(4), 2u);
}

TEST(DtcDeviceVectors, CompressesAsPrinted) {
  int seen = 0;
  for (const json& vector : vectors()) {
    if (!vector.contains("codes_hex")) continue;
    SCOPED_TRACE(vector["name"]);
    const Bytes codes = *from_hex(vector["codes_hex"].get<std::string>());
    if (vector["kind"] != "ok") {
      EXPECT_FALSE(dtc_expand(codes, vector["original_length"].get<std::size_t>()));
      continue;
    }
    const Bytes original = *from_hex(vector["original_hex"].get<std::string>());
    EXPECT_EQ(to_hex(dtc_compress(original)), to_hex(codes));
    EXPECT_EQ(dtc_expand(codes, original.size()), original);
    ++seen;
  }
  EXPECT_GE(seen, 8);
}

TEST(DtcDevice, AWriteIsAllOrNothing) {
  DtcDevice device(setup(7));
  EXPECT_EQ(refusal(device, "07 01 0001 01 0001 1234 FFFF 01 0002 0000 0000").substr(6, 6),
            "078102");
  EXPECT_EQ(device.memory().read(1, 1, test::kBegin), 0u);
  EXPECT_TRUE(device.statistics().writes.empty());
}

TEST(DtcDevice, OthersAndBrokenMessagesGetSilence) {
  DtcDevice device(setup(7));
  EXPECT_TRUE(said(device, plain("08 00 0000 01 0001")).empty());
  EXPECT_TRUE(said(device, plain("07 80 02")).empty());
  Bytes request = plain("07 00 0000 01 0001");
  for (std::size_t bit = 0; bit < request.size() * 8; ++bit) {
    request[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    EXPECT_TRUE(said(device, request).empty()) << bit;
    request[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
  }
  EXPECT_FALSE(said(device, request).empty());
}

TEST(DtcDevice, AfterNoiseOnlySilenceHelps) {
  DtcDevice device(setup(7));
  const auto receiver = device.open_receiver();
  const Bytes request = plain("07 00 0000 01 0001");
  const Instant hard_upon = test::kBegin + test::kLine.characters(1);
  EXPECT_TRUE(test::listen(*receiver, *from_hex("55"), test::kBegin, false).response.empty());
  EXPECT_TRUE(test::listen(*receiver, request, hard_upon, false).response.empty());
  EXPECT_FALSE(test::listen(*receiver, request, hard_upon + test::kLine.characters(20), false)
                   .response.empty());
}

TEST(DtcDevice, AddressesAreReadAndChannelsLive) {
  EXPECT_EQ(parse_dtc_address("float32:12")->area, 3);
  EXPECT_EQ(parse_dtc_address("int16:65535.15")->bit, 15);
  for (const char* wrong :
       {"", "int16", "int16:", "int16:65536", "int16:1.16", "float32:1.0", "bit:1.0", "int8:1"}) {
    EXPECT_FALSE(parse_dtc_address(wrong)) << wrong;
  }
  DeviceSetup made = setup(7);
  made.only_configured = true;
  made.refused = {{"bit", 3, 4, 9}};
  ChannelSpec channel;
  channel.name = "level";
  channel.at = "float64:4";
  channel.encoding.type = ValueType::kFloat64;
  made.spec.channels = {channel};
  const auto device = make_dtc_device(made);
  ASSERT_TRUE(device.has_value());
  auto& dtc = dynamic_cast<DtcDevice&>(**device);
  EXPECT_NE(dtc.memory().read(4, 4, test::kBegin),
            dtc.memory().read(4, 4, test::kBegin + Duration{1'700'000'000}));
  EXPECT_EQ(said(dtc, plain("07 00 0004 04 0001"))[4], 0x00);
  EXPECT_EQ(refusal(dtc, "07 00 0005 04 0001").substr(6, 6), "078002");
  EXPECT_EQ(refusal(dtc, "07 00 0000 00 0004").substr(6, 6), "078009");
  made.spec.channels[0].at = "float64:65536";
  EXPECT_FALSE(make_dtc_device(made).has_value());
}

// Random reads and writes of masters, in packets of both kinds, match the content of the device.
TEST(DtcDevice, AgreesWithTheMasterOfTheBridge) {
  std::mt19937 random(8);
  int compressed = 0;
  for (int round = 0; round < 400; ++round) {
    const std::string threshold = round % 2 == 0 ? "0" : "65535";
    DtcDevice device(setup(200, threshold));
    const auto protocol = *find_protocol("dtc")->make({200, {{"threshold", threshold}}});
    const auto run = [&](const Request& request) {
      const auto exchange = protocol->begin(request, {});
      Bytes out, none;
      (void)exchange->start(out);
      const Bytes answer = said(device, out);
      compressed += out[0] + (answer.empty() ? 0 : answer[0]);
      EXPECT_EQ(exchange->on_bytes(answer, none).kind, Step::Kind::kDone);
      return exchange->reply();
    };
    ReadRequest read;
    std::vector<Bytes> expected;
    for (int i = 0; i < 6; ++i) {
      const auto type = static_cast<AreaIndex>(random() % 5);
      const Range range{type, static_cast<std::uint32_t>(8000 * i + random() % 7000),
                        static_cast<std::uint32_t>(1 + random() % 15)};
      Bytes items(image_bytes(kDtcBits[type], range.count));
      for (auto& item : items)
        item = static_cast<std::uint8_t>(random() % (type == 0 ? 2 : round % 4 == 0 ? 3 : 256));
      (void)run(WriteRequest{.range = range, .items = items});
      read.ranges.push_back(range);
      expected.push_back(items);
    }
    const Reply reply = run(read);
    ASSERT_EQ(reply.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_EQ(to_hex(reply[i].items), to_hex(expected[i]));
  }
  EXPECT_GT(compressed, 300);
}

}  // namespace
}  // namespace fieldcast::sim
