// Whole files that load: the examples that users start from, and what they mean.
#include <gtest/gtest.h>

#include "tests/config/support.hpp"

namespace fieldcast::config {
namespace {

TEST(GoodFiles, EveryExampleLoads) {
  const auto examples = files_of(source_dir() / "config/examples", ".yaml");
  ASSERT_FALSE(examples.empty());
  for (const auto& path : examples) EXPECT_EQ(faults_of(load_file(path.string())), "") << path;
}

TEST(GoodFiles, TheMinimalExampleHasTheDefaultsOfTheStandard) {
  const auto loaded = load_file((source_dir() / "config/examples/minimal.yaml").string());
  ASSERT_TRUE(loaded) << faults_of(loaded);
  ASSERT_EQ(loaded->buses.size(), 1u);
  const auto& port = std::get<SerialPortSpec>(loaded->buses[0].port);
  EXPECT_EQ(port, (SerialPortSpec{"/dev/ttyUSB0", LineFormat{19200, 8, Parity::kEven, 1}, false, true, true}));
  EXPECT_EQ(loaded->buses[0].silence, SilenceRule{StandardSilence{}});
  EXPECT_EQ(loaded->buses[0].echo, std::nullopt);
  const auto& device = loaded->buses[0].devices.at(0);
  EXPECT_EQ(device.protocol, "modbus-rtu");
  EXPECT_EQ(device.link.address, 1);
  EXPECT_EQ(device.timeout, std::chrono::milliseconds{200});
  EXPECT_EQ(device.retries, 1u);
  const auto& channel = device.channels.at(0);
  EXPECT_EQ(channel.name, "voltage");
  EXPECT_EQ(channel.range, (Range{2, 0, 2}));
  EXPECT_EQ(channel.encoding.type, ValueType::kFloat32);
  EXPECT_EQ(channel.refresh, std::chrono::seconds{1});
  EXPECT_EQ(channel.unit, "V");
  EXPECT_EQ(loaded->dds, DdsSpec{});
}

}  // namespace
}  // namespace fieldcast::config
