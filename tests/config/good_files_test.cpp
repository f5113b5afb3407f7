#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>

#include "core/dispatch/scheduler.hpp"
#include "core/model/bus_spec.hpp"
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
  EXPECT_EQ(port, (SerialPortSpec{"/dev/ttyUSB0", LineFormat{19200, 8, Parity::kEven, 1}, false,
                                  true, true}));
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

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

class Everything : public testing::Test {
 protected:
  void SetUp() override {
    const auto folder = source_dir() / "tests/config/good";
    auto loaded = load_text(slurp(folder / "everything.yaml"), "everything.yaml", within(folder));
    ASSERT_TRUE(loaded) << faults_of(loaded);
    spec = std::move(*loaded);
    ASSERT_EQ(spec.buses.size(), 6u);
    ASSERT_EQ(spec.buses[0].devices.size(), 3u);
  }

  static ChannelSpec full() {
    ChannelSpec channel;
    channel.name = "full";
    channel.at = "40101";
    channel.range = {2, 100, 2};
    channel.encoding = {.type = ValueType::kInt32,
                        .word_order = WordOrder::kLittleEndian,
                        .byte_order = ByteOrder::kLittleEndian,
                        .scale = 0.5,
                        .offset = -40};
    channel.encoding.not_available = {0x8000'0000, 0xFFFF'FFFF};
    channel.refresh = milliseconds{250};
    channel.mode = Mode::kScheduled;
    channel.access = Access::kReadWrite;
    channel.on_interest = true;
    channel.priority = 100;
    channel.elasticity = 2.5;
    channel.unit = "°C";
    channel.digits = 3;
    channel.description = "every key of a channel";
    channel.deadband = 0.25;
    channel.heartbeat = minutes{1};
    channel.limits = {-10, -5, 50, 60.5, 0.75, seconds{7}, AlarmPriority::kCritical};
    channel.write_min = -4;
    channel.write_max = 40;
    channel.write_interval = milliseconds{200};
    return channel;
  }

  BridgeSpec spec;
};

// Not in everything.yaml, because they exclude its `security`.
TEST(GoodFiles, DiscoveryServersKeepTheirOrder) {
  const auto folder = source_dir() / "tests/config/good";
  const auto loaded = load_text(slurp(folder / "servers.yaml"), "servers.yaml", within(folder));
  ASSERT_TRUE(loaded) << faults_of(loaded);
  EXPECT_EQ(loaded->dds.discovery_servers,
            (std::vector<std::string>{"10.0.0.3:11811", "10.0.0.2:11811"}));
}

TEST_F(Everything, TopLevelKeysArrive) {
  EXPECT_EQ(spec.name, "all.keys_1");
  EXPECT_EQ(spec.dds, (DdsSpec{7,
                               {"127.0.0.1", "192.168.1.20"},
                               std::vector<std::string>{},
                               "profile.xml",
                               "hall",
                               "member",
                               false,
                               2'500'000}));
  EXPECT_EQ(spec.log.level, LogLevel::kDebug);
  EXPECT_EQ(spec.store, (StoreSpec{"plant.db",
                                   {"serial", "server/*/x"},
                                   std::chrono::hours{36},
                                   2'000'000'000,
                                   std::chrono::hours{90 * 24},
                                   Duration{}}));
}

TEST(GoodFiles, AStoreOnAServerIsKeptAsItIsWritten) {
  const std::string rest =
      ", keep: forever }\nbuses: [ { name: b, port: { tcp: \"h:1\" }, protocol: modbus-rtu, "
      "devices: [ { name: d, "
      "address: 1, allow: [raw-read] } ] } ]\n";
  const auto loaded =
      load_text("bridge: b\nstore: { url: \"postgresql://ann:x@h/d\", samples: []" + rest,
                "dir/b.yaml", disk_reader());
  ASSERT_TRUE(loaded) << faults_of(loaded);
  EXPECT_EQ(loaded->store, (StoreSpec{"postgresql://ann:x@h/d", {}, Duration{}, 0}));
  const auto file = load_text("bridge: b\nstore: { path: a.db" + rest, "dir/b.yaml", disk_reader());
  ASSERT_TRUE(file) << faults_of(file);
  EXPECT_EQ(file->store->address, "dir/a.db") << "relative to the configuration";
}

TEST_F(Everything, PortsArrive) {
  EXPECT_EQ(spec.buses[0].port,
            PortSpec(SerialPortSpec{"/dev/ttyS7", LineFormat{57600, 7, Parity::kOdd, 2}, true,
                                    false, false, FenceSpec{Fence::kListen, milliseconds{250}}}));
  EXPECT_EQ(spec.buses[1].port,
            PortSpec(TcpPortSpec{"plc.local", 4001, LineFormat{9600, 8, Parity::kNone, 1},
                                 seconds{5}, FenceSpec{Fence::kOneClient}}));
  EXPECT_EQ(spec.buses[2].port, PortSpec(TcpPortSpec{"fe80::1", 502, std::nullopt, seconds{3}}));
  EXPECT_EQ(spec.buses[3].port,
            PortSpec(DialInPortSpec{"17", LineFormat{9600, 7, Parity::kEven, 2}}));
  EXPECT_EQ(spec.buses[4].port,
            PortSpec(Rfc2217PortSpec{"line.local", 4002, LineFormat{4800, 7, Parity::kOdd, 2},
                                     seconds{4}, FenceSpec{Fence::kOneClient}}));
  const auto& secured = std::get<TcpPortSpec>(spec.buses[5].port);
  EXPECT_EQ(secured.name(), "tls plc.local:802");
  EXPECT_EQ(secured.certified_name(), "plc-7");
  EXPECT_EQ(secured.connect_timeout, seconds{5});
  EXPECT_TRUE(secured.fence.is(Fence::kOneClient));
  ASSERT_TRUE(secured.tls);
  EXPECT_EQ(spec.buses[1].devices[0].number, "P3");
  ASSERT_TRUE(spec.program.engineers && spec.program.modules);
  const EngineersSpec& engineers = *spec.program.engineers;
  EXPECT_EQ(engineers.listen, (ListenSpec{"0.0.0.0", 4950}));
  for (const TlsSpec& tls : {engineers.tls, spec.program.modules->tls, *secured.tls}) {
    for (const std::string* file : {&tls.certificate, &tls.key, &tls.authority, &tls.revoked})
      EXPECT_TRUE(file->ends_with("profile.xml")) << *file;
  }
  EXPECT_EQ(engineers.proof, LoginProof::kBoth);
  EXPECT_EQ(engineers.login, LoginRule::kAlways);
  EXPECT_EQ(engineers.heartbeat, seconds{2});
  EXPECT_EQ(engineers.idle, seconds{90});
  EXPECT_EQ(
      engineers.ports,
      (std::vector<EngineerPortSpec>{{"P3", {"127.0.0.1", 4961}, false, "ann", {"10.0.7.0/24"}}}));
  EXPECT_EQ(spec.program.modules->listen, (ListenSpec{"::1", 4951}));
  EXPECT_EQ(spec.program.modules->registration,
            (program::RegistrationRule{program::RegistrationRule::Ask::kWords, "N", 3, 100, 4,
                                       seconds{9}}));
}

TEST_F(Everything, WhatModulesHaveToShowArrives) {
  const ModulesSpec& modules = *spec.program.modules;
  EXPECT_EQ(modules.subjects, (std::map<std::string, std::vector<std::string>>{
                                  {"gateway", {"18", "P2"}}, {"hut", {"17"}}}));
  EXPECT_EQ(modules.from, (std::vector<std::string>{"10.0.7.0/24", "fd00::/8"}));
  EXPECT_EQ(modules.second, SecondModule::kReplace);
  EXPECT_EQ(modules.secrets, "");  // a module polled for words cannot respond to a challenge
}

TEST(GoodFile, ModulesOffTheLoopbackNeedOneWordOfSecurity) {
  const auto modules_of = [](const std::string& keys) {
    const auto file = load_text(
        "bridge: b\nprogram: { modules: { listen: \"0.0.0.0:4951\", " + keys +
            " } }\nbuses:\n  - { name: x, port: { serial: /dev/ttyS0 }, protocol: modbus-rtu, "
            "devices: [ { name: d, address: 1, channels: [ { name: a, at: \"holding:1\", "
            "type: int16 } ] } ] }\n",
        "good/x.yaml", within(source_dir() / "tests/config"));
    EXPECT_TRUE(file) << keys << faults_of(file);
    return file ? *file->program.modules : ModulesSpec{};
  };
  EXPECT_TRUE(modules_of("security: none").without_security);
  EXPECT_EQ(modules_of("secrets: profile.xml").secrets, "good/profile.xml");
  EXPECT_EQ(modules_of("from: [10.0.0.0/8]").from.size(), 1u);
}

TEST_F(Everything, MetricsListenWhereTheyAreConfigured) {
  EXPECT_EQ(spec.metrics, (MetricsSpec{{"192.168.1.20", 9464}}));
}

TEST(LearnedSilence, HasALeastOneOrNone) {
  const auto silence_of_text = [](const std::string& text) {
    const auto loaded = load_text(
        "bridge: b\nbuses:\n  - { name: x, port: { serial: /dev/a }, protocol: modbus-rtu, "
        "defaults: { silence: " +
            text +
            " }, devices: [{ name: d, address: 1, channels: [{ name: c, at: \"holding:1\", type: "
            "int16 }] }] "
            "}\n",
        "b.yaml", {});
    EXPECT_TRUE(loaded) << to_text(loaded.error().front());
    return loaded ? loaded->buses.front().silence : SilenceRule{};
  };
  EXPECT_EQ(silence_of_text("learn"), SilenceRule{LearnedSilence{}});
  EXPECT_EQ(silence_of_text("learn 1ms"), SilenceRule{LearnedSilence{milliseconds{1}}});
}

TEST_F(Everything, BusKeysArrive) {
  EXPECT_EQ(spec.buses[0].silence, SilenceRule{CharacterSilence{4.5}});
  EXPECT_EQ(spec.buses[0].gap_allowance, milliseconds{33});
  EXPECT_EQ(spec.buses[0].echo, true);
  EXPECT_EQ(spec.buses[0].planner, Planner::kDynamicBlocks);
  ASSERT_TRUE(spec.buses[0].capture);
  EXPECT_TRUE(spec.buses[0].capture->folder.ends_with("wire")) << spec.buses[0].capture->folder;
  EXPECT_EQ(spec.buses[0].capture->file_bytes, 250'000u);
  EXPECT_EQ(spec.buses[0].capture->files, 3u);
  EXPECT_FALSE(spec.buses[1].capture);
  const GatewaySpec gateway{
      .listen = {"0.0.0.0", 1502},
      .writes = true,
      .verify = true,
      .units = {{std::uint8_t{9}, "special"}},
      .rows = {{"special",
                {{.first = 100, .count = 5, .at = "holding:7"},
                 {.first = 200, .type = ValueType::kFloat32, .at = "holding:20"},
                 {.bits = true,
                  .first = 3,
                  .count = 20,
                  .type = ValueType::kBool,
                  .at = "holding:7.8"}}}},
      .clients = {"10.0.7.0/24"},
      .max_age = seconds{2},
      .share = 0.1,
      .timeout = seconds{3},
      .idle = seconds{4},
      .connections = 5};
  EXPECT_EQ(spec.buses[0].gateway, gateway);
  EXPECT_FALSE(spec.buses[1].gateway);
  EXPECT_EQ(spec.buses[1].planner, Planner::kCyclic);
  EXPECT_EQ(spec.buses[1].silence, SilenceRule{Duration{microseconds{600}}});
  EXPECT_EQ(spec.buses[1].echo, false);
  EXPECT_EQ(spec.buses[2].silence, SilenceRule{StandardSilence{}});
  EXPECT_EQ(spec.buses[2].echo, std::nullopt);
}

TEST_F(Everything, DefaultsOfABusReachDevicesAndChannelsThatSayNothing) {
  const auto& device = spec.buses[0].devices[0];
  EXPECT_EQ(device.protocol, "modbus-ascii");
  EXPECT_EQ(device.link, (DeviceLink{0x11, {{"read-write", "true"}}}));
  EXPECT_EQ(device.timeout, milliseconds{1500});
  EXPECT_EQ(device.retries, 4u);
  EXPECT_EQ(device.pause, microseconds{750});
  EXPECT_EQ(device.max_block, 64);
  EXPECT_EQ(device.max_gap, 0);
  EXPECT_TRUE(device.allow_raw_read);
  EXPECT_FALSE(device.allow_raw_write);

  ChannelSpec value;
  value.name = "value";
  value.at = "holding:0";
  value.range = {2, 0, 1};
  value.encoding = {.type = ValueType::kUint16,
                    .word_order = WordOrder::kLittleEndian,
                    .byte_order = ByteOrder::kLittleEndian};
  value.refresh = seconds{2};
  value.mode = Mode::kIntensive;
  value.access = Access::kReadWrite;
  value.on_interest = true;
  value.priority = -7;
  value.elasticity = 0.5;
  value.deadband = 2;
  value.heartbeat = seconds{90};
  EXPECT_EQ(device.channels.at(0), value);
}

TEST_F(Everything, DefaultsHoldWhereTheyCan) {
  const auto& fixed = spec.buses[0].devices[0].channels.at(1);
  EXPECT_EQ(fixed.access, Access::kReadOnly) << "an input cannot be written, whatever the bus says";
  EXPECT_EQ(fixed.heartbeat, std::nullopt) << "no deadband, no heartbeat";
  EXPECT_EQ(fixed.encoding.type, ValueType::kBool) << "an input is one bit";
}

TEST_F(Everything, ADeviceOverridesItsTemplateAndTheTemplateItsBus) {
  const auto& device = spec.buses[0].devices[1];
  EXPECT_EQ(
      device.link,
      (DeviceLink{18,
                  {{"mask-write", "true"}, {"read-write", "true"}, {"write-single", "multiple"}}}));
  EXPECT_FALSE(device.allow_raw_read);
  EXPECT_TRUE(device.allow_raw_write);
  EXPECT_EQ(device.timeout, milliseconds{60});
  EXPECT_EQ(device.retries, 0u);
  EXPECT_EQ(device.pause, milliseconds{1});
  EXPECT_EQ(device.max_block, 32);
  EXPECT_EQ(device.max_gap, 5);

  ASSERT_EQ(device.channels.size(), 8u);
  ChannelSpec coil;
  coil.name = "from-template";
  coil.at = "coil:5";
  coil.range = {0, 5, 1};
  coil.encoding.type = ValueType::kBool;
  coil.refresh = seconds{3};
  coil.mode = Mode::kOnDemand;
  coil.priority = 8;
  coil.elasticity = 3;
  EXPECT_EQ(device.channels[0], coil);
}

TEST_F(Everything, AChannelOverridesItsDevice) {
  EXPECT_EQ(spec.buses[0].devices[1].channels.at(1), full());
  const auto& bit = spec.buses[0].devices[1].channels.at(2);
  EXPECT_EQ(bit.encoding.bit, 9);
  EXPECT_EQ(bit.range, (Range{2, 7, 1}));
  const auto& byte = spec.buses[0].devices[1].channels.at(3);
  EXPECT_EQ(byte.encoding.type, ValueType::kUint8);
  EXPECT_EQ(byte.encoding.bit, 8);
  const auto& spelt = spec.buses[0].devices[1].channels.at(4);
  EXPECT_EQ(
      spelt.encoding.text_number,
      (TextNumber{
          .kind = TextNumber::Kind::kDecimal, .decimals = 2, .leading_zeros = true, .plus = true}));
  EXPECT_EQ(spelt.range, (Range{2, 20, 4}));
  EXPECT_EQ(spec.buses[0].devices[1].channels.at(5).encoding.charset, Charset::kGbk);
}

TEST_F(Everything, AChannelListSaysTheSameAsYaml) {
  const auto& channels = spec.buses[0].devices[2].channels;
  ASSERT_EQ(channels.size(), 5u);
  auto same = full();
  same.description = "a \"list\"; of keys";
  EXPECT_EQ(channels[0], same);
  EXPECT_EQ(channels[1].encoding.bit, 9);
  EXPECT_EQ(channels[2].encoding.type, ValueType::kUint8);
  EXPECT_EQ(channels[2].encoding.bit, 8);
  EXPECT_EQ(channels[3].encoding.text_number,
            spec.buses[0].devices[1].channels.at(4).encoding.text_number);
  EXPECT_EQ(channels[4].encoding.charset, Charset::kGbk);
}

TEST_F(Everything, AnExponentWidensTheRangeOfItsChannel) {
  const auto& channels = spec.buses[0].devices[1].channels;
  const auto behind = std::ranges::find(channels, "behind", &ChannelSpec::name);
  ASSERT_NE(behind, channels.end());
  EXPECT_EQ(behind->range, (Range{2, 40, 6}));
  EXPECT_EQ(behind->encoding.exponent_distance, 5);
  EXPECT_EQ(behind->exponent_from, "holding:45");
  EXPECT_EQ(behind->access, Access::kReadOnly) << "a default from above holds where it can";
  const auto before = std::ranges::find(channels, "before", &ChannelSpec::name);
  ASSERT_NE(before, channels.end());
  EXPECT_EQ(before->range, (Range{2, 45, 3}));
  EXPECT_EQ(before->encoding.exponent_distance, -1);
}

TEST_F(Everything, ADeviceMaySpeakAnotherProtocolThanItsBus) {
  EXPECT_EQ(spec.buses[1].devices[0].protocol, "modbus-rtu");
  EXPECT_TRUE(spec.buses[1].devices[0].link.options.empty())
      << "the bus's options are those of its own protocol";
  EXPECT_TRUE(spec.buses[1].devices[0].allow_raw_read && spec.buses[1].devices[0].allow_raw_write);
  EXPECT_EQ(spec.buses[2].devices[0].link.address, 255);
}

TEST(GoodFiles, TheDemoHasAHundredModbusChannelsOnSixDevicesAndABusForEachFamily) {
  const auto demo = load_file((source_dir() / "config/examples/demo.yaml").string());
  ASSERT_TRUE(demo) << faults_of(demo);
  std::size_t devices = 0, channels = 0;
  std::set<std::string> families, shared;
  for (std::size_t i = 0; i < demo->buses.size(); ++i) {
    std::set<std::string> here;
    for (const auto& device : demo->buses[i].devices) {
      here.insert(device.protocol);
      if (i < 2) ++devices, channels += device.channels.size();
    }
    families.insert(here.begin(), here.end());
    if (here.size() > 1) shared = here;
  }
  EXPECT_EQ(devices, 6u);
  EXPECT_EQ(channels, 100u);
  for (const char* family : {"dtc", "instrument", "mitsubishi-fx", "modbus-rtu", "omron-hostlink",
                             "s7-freeport", "s7-ppi"}) {
    EXPECT_TRUE(families.contains(family)) << family;
  }
  EXPECT_EQ(shared.size(), 3u);
}

// Assumes responses after 5 ms, to keep the examples realistic.
TEST(GoodFiles, ExamplesNeedLessThanHalfOfEachWire) {
  for (const auto& path : files_of(source_dir() / "config/examples", ".yaml")) {
    const auto loaded = load_file(path.string());
    ASSERT_TRUE(loaded) << faults_of(loaded);
    for (const auto& bus : loaded->buses) {
      const auto line = line_of(bus.port);
      ScheduleInput input{line, silence_of(bus.silence, line), {}, {}};
      std::vector<std::unique_ptr<Protocol>> protocols;
      for (const auto& device : bus.devices) {
        protocols.push_back(std::move(*make_protocol(device, line)));
        input.devices.push_back({protocols.back().get(), milliseconds{5}, device.pause,
                                 device.max_block, device.max_gap});
        for (const auto& channel : device.channels) {
          const auto index = static_cast<DeviceIndex>(input.devices.size() - 1);
          input.points.push_back(
              {index, channel.range, channel.refresh, channel.mode, channel.priority});
        }
      }
      EXPECT_LT(make_scheduler(input)->planned_load(), 0.5) << path << ", bus " << bus.name;
    }
  }
}

}  // namespace
}  // namespace fieldcast::config
