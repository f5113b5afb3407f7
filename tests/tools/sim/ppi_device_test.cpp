#include "tools/sim/families/ppi_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/vectors.hpp"
#include "tests/tools/sim/device_setup.hpp"
#include "tests/tools/sim/listen.hpp"

namespace fieldcast::sim {
namespace {

using fieldcast::test::GoldenVector;

Bytes said(PpiDevice& device, const Bytes& request) {
  return test::listen(*device.open_receiver(), request).response;
}
std::string asked(PpiDevice& device, std::string_view hex) {
  return to_hex(said(device, *from_hex(hex)), '\0');
}

// Fills the memory so that a read gives this response.
void prepare(ItemMemory& memory, ByteView request, ByteView answer) {
  ByteView data = answer.subspan(4 + 3 + 12 + 2);
  for (std::size_t item = 4 + 3 + 10 + 2; item + 12 <= request.size() - 2; item += 12) {
    const auto row = std::ranges::find(kPpiAreas, request[item + 8], &S7Area::code);
    if (row == kPpiAreas.end()) return;
    const auto area = static_cast<std::size_t>(row - kPpiAreas.begin());
    const std::uint32_t address = read_u32(request, item + 8) & 0xFFFFFF;
    std::size_t size = data[1] == 0x04 ? read_u16(data, 2) / 8u : read_u16(data, 2);
    if (data[0] != 0xFF) size = 0;
    const std::size_t each = row->counted ? row->bits / 8 + 1 : row->bits / 8;
    for (std::size_t i = 0; i < size / each; ++i) {
      std::uint64_t value = 0;
      for (std::size_t byte = row->counted ? 1 : 0; byte < each; ++byte)
        value = value << 8 | data[4 + i * each + byte];
      if (request[item + 3] == 0x01) value <<= address % 8;
      memory.write(area,
                   (row->counted ? address : address / row->bits) + static_cast<std::uint32_t>(i),
                   value);
    }
    data = data.subspan(std::min(data.size(), 4 + size + size % 2));
  }
}

// A timer's status byte may differ: it is 0 here.
TEST(PpiDeviceVectors, RespondsAsPrinted) {
  int seen = 0;
  for (const GoldenVector& vector : fieldcast::test::load_vectors("ppi")) {
    if (vector.master.size() < 2 || vector.kind == "malformed" || vector.name == "read_t32_x3")
      continue;
    SCOPED_TRACE(vector.name);
    PpiDevice device(test::device_setup(2));
    if (vector.master[0][4 + 3 + 10] == 0x04)
      prepare(device.memory(), vector.master[0], vector.slave[1]);
    for (std::size_t round = 0; round < vector.master.size(); ++round) {
      EXPECT_EQ(to_hex(said(device, vector.master[round])), to_hex(vector.slave[round])) << round;
    }
    ++seen;
  }
  EXPECT_GE(seen, 25);
}

TEST(PpiDeviceVectors, WritesLandInMemory) {
  std::map<std::string, Bytes> requests;
  for (const GoldenVector& vector : fieldcast::test::load_vectors("ppi"))
    requests[vector.name] = vector.request;
  PpiDevice device(test::device_setup(2));
  const auto item = [&](std::size_t area, std::uint32_t at) {
    return device.memory().read(area, at, test::kBegin);
  };
  EXPECT_EQ(to_hex(said(device, requests.at("write_qb0_ff"))), "E5");
  EXPECT_EQ(item(3, 0), 0xFFu);
  EXPECT_EQ(to_hex(said(device, requests.at("write_vb_multi_bytes"))), "E5");
  EXPECT_EQ(item(0, 100) << 24 | item(0, 101) << 16 | item(0, 102) << 8 | item(0, 103),
            0xDEADBEEFu);
  EXPECT_EQ(to_hex(said(device, requests.at("write_m0_1_on_padded"))), "E5");
  EXPECT_EQ(item(1, 0), 2u);
  EXPECT_EQ(to_hex(said(device, requests.at("write_protected"))), "E5");
  EXPECT_EQ(item(2, 0), 0u);
}

TEST(PpiDeviceVectors, MalformedTelegramsGetSilence) {
  int seen = 0;
  for (const GoldenVector& vector : fieldcast::test::load_vectors("ppi")) {
    if (vector.kind != "malformed" || vector.request.empty() || vector.name == "stale_reference")
      continue;
    SCOPED_TRACE(vector.name);
    PpiDevice device(test::device_setup(2));
    EXPECT_EQ(to_hex(said(device, vector.request)), vector.expect == "accept_tail" ? "E5" : "");
    EXPECT_EQ(device.statistics().write_requests, 0u);
    ++seen;
  }
  EXPECT_GE(seen, 7);
}

constexpr std::string_view kReadVb0 =
    "681B1B6802006C320100000000000E00000401120A100200010001840000006816";

TEST(PpiDevice, APollBringsTheResponseOnceAndTheSamePollItAgain) {
  PpiDevice device(test::device_setup(2));
  EXPECT_EQ(asked(device, "1002005C5E16"), "100002090B16");  // empty queue
  EXPECT_EQ(asked(device, kReadVb0), "E5");
  const std::string answer = asked(device, "1002005C5E16");
  EXPECT_EQ(answer.substr(0, 2), "68");
  EXPECT_EQ(asked(device, "1002005C5E16"), answer);
  EXPECT_EQ(asked(device, "1002007C7E16"), "100002090B16");
  EXPECT_EQ(asked(device, "100200494B16"), "100002000216");  // FDL status
}

TEST(PpiDevice, OthersGetSilenceAndTelegramsAreFoundInNoise) {
  PpiDevice device(test::device_setup(2));
  std::string other(kReadVb0);
  other.replace(8, 2, "03").replace(62, 2, "69");
  EXPECT_EQ(asked(device, other), "");
  EXPECT_EQ(asked(device, "1003005C5F16"), "");
  EXPECT_EQ(asked(device, "00FF6868" + std::string(kReadVb0)), "E5");
  // after a silence, an incomplete telegram is dropped
  const auto receiver = device.open_receiver();
  EXPECT_TRUE(test::listen(*receiver, *from_hex("681B1B68")).response.empty());
  EXPECT_EQ(
      to_hex(test::listen(*receiver, *from_hex(kReadVb0), test::kBegin + Duration{100'000'000})
                 .response),
      "E5");
}

TEST(PpiDevice, VariablesAreReadInTheNotationOfTheSiemensSoftware) {
  EXPECT_EQ(parse_s7_address(kPpiAreas, "VW100")->first, 100u);
  EXPECT_EQ(parse_s7_address(kPpiAreas, "AIW4")->first, 2u);
  EXPECT_EQ(parse_s7_address(kPpiAreas, "T37")->area, 8u);
  EXPECT_EQ(parse_s7_address(kPpiAreas, "SM0.5")->area, 5u);
  EXPECT_EQ(parse_s7_address(kPpiAreas, "S1.5")->area, 4u);
  EXPECT_EQ(parse_s7_address(kPpiAreas, "V10.3")->bit, 3);
  for (const char* wrong : {"", "V", "V10", "VB", "AIW3", "T37.1", "VB1.1", "V1.8", "X1"})
    EXPECT_FALSE(parse_s7_address(kPpiAreas, wrong)) << wrong;
}

}  // namespace
}  // namespace fieldcast::sim
