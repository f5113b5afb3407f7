#include "tools/sim/families/fx_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/codec/checksum.hpp"
#include "tests/support/vectors.hpp"
#include "tests/tools/sim/device_setup.hpp"
#include "tests/tools/sim/listen.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {
namespace {

using fieldcast::test::GoldenVector;

Bytes said(FxDevice& device, const Bytes& request) {
  return test::listen(*device.open_receiver(), request).response;
}

Bytes framed(const std::string& text) {
  Bytes body = test::bytes(text + "\x03"), frame{0x02};
  append_hex(body, sum8(body), 2);
  append(frame, body);
  return frame;
}
std::string asked(FxDevice& device, const std::string& text) {
  return to_hex(said(device, framed(text)));
}

std::size_t area(std::string_view name) {
  return static_cast<std::size_t>(std::ranges::find(kFxAreaNames, name) - kFxAreaNames.begin());
}

// Writes what the response shows to the address that the request reads.
TEST(FxDeviceVectors, RespondsAsPrinted) {
  int seen = 0;
  for (const GoldenVector& vector : fieldcast::test::load_vectors("fx")) {
    if (vector.kind != "ok" || vector.response.empty() || vector.name == "ext_e11_805c")
      continue;  // E11: programs are not simulated
    SCOPED_TRACE(vector.name);
    FxDevice device(test::device_setup(0));
    const std::string request(vector.request.begin(), vector.request.end());
    const std::string answer(vector.response.begin(), vector.response.end());
    if (request[1] == '0') {
      EXPECT_EQ(asked(device, "1" + request.substr(2, 6) + answer.substr(1, answer.size() - 4)),
                "06");
    }
    EXPECT_EQ(to_hex(said(device, vector.request)), to_hex(vector.response));
    ++seen;
  }
  EXPECT_GE(seen, 24);
}

TEST(FxDeviceVectors, ItemsLieWhereTheSourcesSay) {
  std::map<std::string, Bytes> requests;
  for (const GoldenVector& vector : fieldcast::test::load_vectors("fx"))
    requests[vector.name] = vector.request;
  FxDevice device(test::device_setup(0));
  const auto item = [&](std::string_view name, std::uint32_t at) {
    return device.memory().read(area(name), at, test::kBegin);
  };
  EXPECT_EQ(to_hex(said(device, requests.at("write_d0_d1"))), "06");
  EXPECT_EQ(item("D", 0), 0x1234u);
  EXPECT_EQ(item("D", 1), 0x5678u);
  for (const char* name : {"force_m17_on", "force_y0_on", "force_y12_on", "force_s5_on",
                           "force_m8001_on", "fx3u_m0_on"}) {
    EXPECT_EQ(to_hex(said(device, requests.at(name))), "06") << name;
  }
  EXPECT_EQ(item("M", 17) + item("Y", 0) + item("Y", 012) + item("S", 5) + item("M8000", 1) +
                item("M", 0),
            6u);
  EXPECT_EQ(to_hex(said(device, requests.at("force_m17_off"))), "06");
  EXPECT_EQ(item("M", 17), 0u);
  device.memory().write(area("D"), 123, 12);
  EXPECT_EQ(to_hex(said(device, requests.at("read_d123_4"))), to_hex(framed("0C000000")));
  device.memory().write(area("D8000"), 1, 22210);
  EXPECT_EQ(asked(device, "00E0202"), to_hex(framed("C256")));
  device.memory().write(area("C200"), 0, 1000);
  EXPECT_EQ(asked(device, "00C0004"), to_hex(framed("E8030000")));
}

TEST(FxDevice, RefusesWhatItCannotDo) {
  FxDevice device(test::device_setup(0));
  Bytes wrong_sum = framed("0100002");
  wrong_sum.back() ^= 1u;
  EXPECT_EQ(to_hex(said(device, wrong_sum)), "15");
  for (const char* text : {"9100002", "0100000", "0100041", "0FFFF02", "11000041234",
                           "110000212345", "0G00002", "7FF1F", "E20100002"}) {
    EXPECT_EQ(asked(device, text), "15") << text;
  }
  EXPECT_EQ(asked(device, "04E7E03"), "15");  // the last D is 7999
  EXPECT_EQ(asked(device, "04E7E02"), to_hex(framed("0000")));
}

TEST(FxDevice, SaysThatItIsThereBetweenFramesOnly) {
  FxDevice device(test::device_setup(0));
  EXPECT_EQ(to_hex(said(device, {0x05})), "06");
  EXPECT_TRUE(said(device, {0x02, 0x30, 0x05}).empty());
  Bytes noise{0x3F, 0x02, 0x31};
  append(noise, framed("0100002"));
  EXPECT_EQ(to_hex(said(device, noise)), to_hex(framed("0000")));
}

TEST(FxDevice, NumbersOfInputsAndOutputsAreOctal) {
  DeviceSetup setup = test::device_setup(0);
  setup.spec.channels = {test::channel("lamp", "Y12", ValueType::kBool),
                         test::channel("big", "C200", ValueType::kInt32),
                         test::channel("date", "D8010", ValueType::kUint16),
                         test::channel("bit", "D7.15", ValueType::kBool)};
  auto made = make_fx_device(setup);
  ASSERT_TRUE(made.has_value()) << made.error();
  auto& memory = dynamic_cast<FxDevice&>(**made).memory();
  EXPECT_TRUE(memory.configured(area("Y"), 10));
  EXPECT_TRUE(memory.configured(area("C200"), 0));
  EXPECT_TRUE(memory.configured(area("D8000"), 10));
  EXPECT_TRUE(memory.configured(area("D"), 7));
  for (const char* at : {"Y8", "D8256x", "Z1", "D1.16", "C256", "D8600", "M1.1", ""}) {
    setup.spec.channels = {test::channel("wrong", at, ValueType::kBool)};
    EXPECT_FALSE(make_fx_device(setup).has_value()) << at;
  }
}

}  // namespace
}  // namespace fieldcast::sim
