#include <fmt/format.h>

#include "tests/tools/import/support.hpp"
#include "tools/import/formats/expression.hpp"

namespace fieldcast::importing {
namespace {

using testing::HasSubstr;

TEST(ImportTelegraf, TheStyleRegisterBecomesOneDevice) {
  const auto outcome = imported("telegraf.conf", R"(
[agent]
  interval = "10s"
[[inputs.modbus]]
  name = "meter"
  slave_id = 7
  timeout = "1s"
  controller = "file:///dev/ttyUSB3"
  baud_rate = 19200
  parity = "E"
  stop_bits = 1
  coils = [ { name = "run", address = [3] } ]
  holding_registers = [
    { name = "energy", byte_order = "CDAB", data_type = "UFIXED", scale = 0.001, address = [5,6] },
    { name = "hole", byte_order = "AB", data_type = "UINT16", scale = 1.0, address = [7,9] },
    { name = "half", byte_order = "AB", data_type = "FLOAT16-IEEE", scale = 1.0, address = [9] },
    { name = "label", byte_order = "AB", data_type = "STRING", address = [20,21,22] },
    { name = "flag", byte_order = "BA", data_type = "BIT", bit = 3, address = [30] },
  ]
  [inputs.modbus.workarounds]
    pause_between_requests = "20ms"
    max_word_registers_per_request = 60
)");
  const std::string& text = outcome.files.front().text;
  EXPECT_THAT(text, HasSubstr("serial: \"/dev/ttyUSB3\", baud: 19200, format: 8E1"));
  EXPECT_THAT(text,
              HasSubstr("address: 7\n        refresh: 10s\n        word-order: little-endian"));
  EXPECT_THAT(text, HasSubstr("timeout: 1s\n        pause: 20ms\n        max-block: 60"));
  EXPECT_EQ(channel_line(outcome, "energy"),
            "{ name: energy, at: \"holding:5\", type: uint32, scale: 0.001 }");
  expect_channels(outcome, {"label -> string(6)", "flag -> at: \"holding:30.11\", type: bool"});
  EXPECT_EQ(fate_of(outcome, "run"), "true and false instead of 1 and 0");
  EXPECT_EQ(fate_of(outcome, "hole"), "no: its addresses do not follow each other");
  EXPECT_THAT(fate_of(outcome, "half"), HasSubstr("no: half-precision"));
}

TEST(ImportTelegraf, RequestsAndMetricsBecomeADeviceForEachSlave) {
  const auto outcome = imported("telegraf.conf", R"(
[[inputs.modbus]]
  name = "gateway"
  controller = "tcp://10.0.0.5:502"
  [[inputs.modbus.request]]
    slave_id = 1
    byte_order = "ABCD"
    register = "input"
    fields = [
      { address=0, name="voltage", type="INT16", scale=0.1 },
      { address=1, name="skip", type="INT32", omit=true },
      { address=3, name="low", type="INT8L" },
    ]
  [[inputs.modbus.metric]]
    slave_id = 2
    measurement = "pump"
    fields = [ { address=8, name="power", type="FLOAT64", register="holding" } ]
)");
  const std::string& text = outcome.files.front().text;
  EXPECT_THAT(text, HasSubstr("tcp: \"10.0.0.5:502\" }\n    protocol: modbus-tcp"));
  EXPECT_THAT(text, HasSubstr("- name: gateway\n        address: 1"));
  EXPECT_THAT(text, HasSubstr("- name: gateway-2\n        address: 2"));
  expect_channels(
      outcome, {"low -> type: int8, byte: low", "pump.power -> at: \"holding:8\", type: float64"});
  EXPECT_EQ(outcome.rows.size(), 3u);
}

TEST(ImportTelegraf, WhatIsNotANumberIsRefusedAndNotLeftOut) {
  const auto outcome = imported("telegraf.conf", R"(
[[inputs.modbus]]
  name = "a"
  controller = "tcp://10.0.0.5:502"
  holding_registers = [
    { name = "less", byte_order = "AB", data_type = "UINT16", scale = 1.0, address = [-1] },
    { name = "scaled", byte_order = "AB", data_type = "UINT16", scale = nan, address = [5] },
    { name = "good", byte_order = "AB", data_type = "UINT16", scale = 0.1, address = [6] },
  ]
)");
  expect_fates(outcome,
               {"less -> no: '-1' is no address", "scaled -> no: scale 'nan' is no number"});
  EXPECT_EQ(fate_of(outcome, "good"), "ok");
}

TEST(ImportTelegraf, Float32OfTheStyleRegisterIsFixedPoint) {
  const auto outcome = imported("telegraf.conf", R"(
[[inputs.modbus]]
  name = "a"
  slave_id = 1
  controller = "tcp://10.0.0.5:502"
  holding_registers = [
    { name = "one", byte_order = "AB", data_type = "FLOAT32", scale = 0.1, address = [54] },
    { name = "two", byte_order = "ABCD", data_type = "FLOAT32", scale = 0.1, address = [56,57] },
    { name="four",byte_order="ABCDEFGH",data_type="FLOAT32",scale=0.1,address=[60,61,62,63] },
    { name="three",byte_order="ABCD",data_type="FLOAT32",scale=0.1,address=[70,71,72] },
    { name="ieee",byte_order="ABCD",data_type="FLOAT32-IEEE",scale=1.0,address=[80,81] },
  ]
[[inputs.modbus]]
  name = "b"
  controller = "tcp://10.0.0.6:502"
  [[inputs.modbus.request]]
    slave_id = 1
    fields = [ { address=0, name="float", type="FLOAT32" } ]
)");
  EXPECT_EQ(channel_line(outcome, "one"),
            "{ name: one, at: \"holding:54\", type: uint16, scale: 0.1 }");
  expect_channels(outcome, {"two -> at: \"holding:56\", type: uint32",
                            "four -> at: \"holding:60\", type: uint64",
                            "ieee -> at: \"holding:80\", type: float32", "float -> type: float32"});
  EXPECT_EQ(fate_of(outcome, "one"), "ok");
  EXPECT_THAT(fate_of(outcome, "two"), HasSubstr("from 1.37 on it is one of IEEE"));
  EXPECT_EQ(fate_of(outcome, "three"), "no: float32 of 3 registers");
  EXPECT_EQ(fate_of(outcome, "ieee"), "ok");
}

TEST(ImportTelegraf, AControllerOfUdpIsNotAPort) {
  const auto outcome = imported("telegraf.conf", R"([[inputs.modbus]]
  name = "a"
  slave_id = 1
  controller = "udp://10.0.0.5:502"
  coils = [ { name = "x", data_type = "BOOL", address = [1] } ]
[[inputs.modbus]]
  name = "b"
  slave_id = 1
  controller = "tcp://10.0.0.5:502"
  coils = [ { name = "y", data_type = "BOOL", address = [1] } ]
)");
  EXPECT_EQ(
      fate_of(outcome, "x"),
      "no: its bus (telegraf.conf:1): its controller udp://10.0.0.5:502: a bus has no port of "
      "UDP");
  EXPECT_EQ(fate_of(outcome, "y"), "ok");
}

TEST(ImportTelegraf, BrokenTomlNamesItsLine) {
  const auto outcome =
      import_text("telegraf.conf", "[[inputs.modbus]]\n  name = \"x\"\n  slave_id = = 1\n");
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error(), HasSubstr("telegraf.conf: line 3: no TOML"));
  // toml++ 3.3.0 fails an assertion here.
  EXPECT_THAT(import_text("telegraf.conf", "[[inputs.modbus]]\n[.a]\n").error(),
              HasSubstr("telegraf.conf: no TOML: a key or a value that is none"));
  // toml++ 3.3.0 has undefined behaviour here.
  EXPECT_THAT(import_text("telegraf.conf", "[[inputs.modbus]]\n  slav\u00F2e_id = 1\n").error(),
              HasSubstr("telegraf.conf: line 2: no TOML"));
}

const std::string kMqm = R"(
modbus:
  networks:
    - name: hall
      address: 10.0.0.6
      port: 1502
      slaves:
        - address: 1,2
          response_timeout: 50ms
        - address: 1
          name: boiler
mqtt:
  client_id: x
  refresh: 10s
  broker: { host: localhost }
  objects:
)";

TEST(ImportMqmgateway, TopicsBecomeChannelsOfEverySlave) {
  const auto outcome = imported("config.yaml", kMqm + R"(
    - topic: ${slave_name}/heat
      network: hall
      slave: 1-2
      state:
        - name: power
          register: 11
          count: 2
          converter: std.float32(low_first=true)
        - name: flow
          register: 0x20
          register_type: input
          refresh: 1s
          converter: expr.evaluate("(R0 - 100) / 4", 2)
      commands:
        - name: set
          register: hall.1.0x30
          register_type: holding
      availability: { name: ok, register: 40, register_type: bit, available_value: 1 }
)");
  const std::string& text = outcome.files.front().text;
  EXPECT_THAT(text, HasSubstr("tcp: \"10.0.0.6:1502\""));
  EXPECT_THAT(text, HasSubstr("- name: boiler\n        address: 1\n"));
  EXPECT_THAT(text, HasSubstr("- name: slave-2\n        address: 2\n"));
  EXPECT_THAT(text, HasSubstr("timeout: 50ms"));
  expect_channels(outcome,
                  {"heat-power -> at: \"holding:10\", type: float32",
                   "heat-flow -> at: \"input-register:32\", type: uint16, scale: 0.25, offset: -25",
                   "heat-set -> access: write-only", "heat-ok -> at: \"input:39\", type: bool"});
}

TEST(ImportMqmgateway, ACommandMakesWhatIsReadWritable) {
  const auto outcome = imported("config.yaml", kMqm + R"(
    - topic: valve
      commands: [ { name: set, register: hall.1.5, register_type: holding,
                  converter: std.multiply(10) } ]
      state: { register: hall.1.5, register_type: holding, converter: std.divide(10) }
)");
  EXPECT_EQ(outcome.rows.size(), 1u);
  EXPECT_THAT(channel_line(outcome, "valve"), HasSubstr("scale: 0.1, access: read-write"));
}

TEST(ImportMqmgateway, EachFileHasItsOwnNetworks) {
  const auto file = [](const std::string& name, const std::string& network, const char* used) {
    return InputFile{name + ".yaml", "modbus: { networks: [ { name: " + network + ", address: " +
                                         name + " } ] }\nmqtt: { objects: [ { topic: " + name +
                                         ", state: { register: " + used + ".1.5 } } ] }\n"};
  };
  const auto outcome = imported_files({file("north", "line", "line"), file("south", "line", "line"),
                                       file("west", "other", "line")});
  const std::string& text = outcome.files.front().text;
  EXPECT_THAT(text, HasSubstr("north:502"));
  EXPECT_THAT(text, HasSubstr("south:502"));
  EXPECT_EQ(fate_of(outcome, "west"), "no: there is no network 'line'");
}

TEST(ImportMqmgateway, CommandsMayBeAMapOfOne) {
  const auto outcome = imported("config.yaml", kMqm + R"(
    - topic: valve
      commands: { name: set, register: hall.1.5, register_type: holding }
)");
  EXPECT_THAT(channel_line(outcome, "valve-set"), HasSubstr("access: write-only"));
}

TEST(ImportMqmgateway, WhatHasNoCounterpartIsReported) {
  const auto outcome = imported("config.yaml", kMqm + R"(
    - { topic: a, state: { register: hall.1.1, converter: my.plugin() } }
    - { topic: b, state: { register: nowhere.1.1 } }
    - { topic: c, state: { register: hall.1.2, converter: 'expr.evaluate("R0 * R0")' } }
    - { topic: d, state: { register: hall.1.0 } }
    - { topic: e, state: { register: hall.1.3, converter: 'std.map("1:on")' } }
    - { topic: f, state: { register: hall.1.4, count: -2, converter: std.string() } }
)");
  expect_fates(outcome,
               {"a -> my.plugin has no counterpart", "b -> no network 'nowhere'", "c -> not linear",
                "d -> count from 1", "e -> not the text", "f -> -2 registers"});
}

TEST(ImportMqmgateway, LinearExpressionsAreUnderstood) {
  const auto form = [](std::string_view text) {
    const auto found = linear_form(text);
    return found ? fmt::format("{}{} {} {}", found->function, found->low_first ? "!" : "",
                               found->scale, found->offset)
                 : "no";
  };
  EXPECT_EQ(form("R0"), " 1 0");
  EXPECT_EQ(form("R0/10"), " 0.1 0");
  EXPECT_EQ(form("-2 * (R0 - 3) + 1"), " -2 7");
  EXPECT_EQ(form("int32(R1, R0) / 1000"), "int32! 0.001 0");
  EXPECT_EQ(form("flt32bs(R0,R1)*2 + flt32bs(R0,R1)"), "flt32bs 3 0");
  EXPECT_EQ(form("R0*R0"), "no");
  EXPECT_EQ(form("1/R0"), "no");
  EXPECT_EQ(form("R0/0"), "no");
  EXPECT_EQ(form("R0 + R1"), "no");
  EXPECT_EQ(form("7"), "no");
  EXPECT_EQ(form(std::string(400, '(')), "no");
}

TEST(ImportNeuron, AFileWithoutAValueSaysSo) {
  const auto outcome = import_text("n.json", R"({
    "nodes": [ { "name": "m", "plugin": "Modbus RTU" } ],
    "tags": [ { "driver": "m", "tags": [ { "name": "a", "address": "1!400001" } ] } ] })");
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error(), HasSubstr("n.json: it looks like Neuron"));
  EXPECT_THAT(outcome.error(), HasSubstr("names no value"));
}

}  // namespace
}  // namespace fieldcast::importing
