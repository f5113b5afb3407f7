#include "tests/tools/import/support.hpp"
#include "tools/import/formats/epics/epics_files.hpp"
#include "tools/import/formats/expression.hpp"

namespace fieldcast::importing {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

const std::string kWbHead = R"({
  // comments are fine
  "device_type": "meter", "device": { "name": "Meter", "id": "meter",
    "response_timeout_ms": 300, "max_read_registers": 20, "guard_interval_us": 5000,
    "setup": [ { "address": 1, "value": 1 } ],
    "parameters": { "mode": { "default": 1 }, "other": { "title": "x" } },
    "subdevices": [ { "title": "lamp", "device": { "channels": [
      { "name": "Level", "reg_type": "holding", "address": 2, "min": 0, "max": 100 } ] } } ],
    "channels": [
)";
const std::string kWbTail = "] } }";

TEST(ImportWb, ChannelsOfATemplateBecomeADevice) {
  const auto outcome = imported("config-meter.json", kWbHead + R"(
    { "name": "Voltage", "type": "voltage", "reg_type": "input", "address": "0x10", "format": "u32",
      "scale": 0.001, "word_order": "little_endian" },
    { "name": "Alarm", "reg_type": "holding", "address": "20:3:1", "readonly": true },
    { "name": "High", "reg_type": "holding", "address": "21:8:8", "readonly": true },
    { "name": "Relay", "reg_type": "coil", "address": 7, "type": "switch" },
    { "name": "Lamp", "device_type": "lamp", "shift": 100, "stride": 3 },
    { "name": "Error", "reg_type": "input", "address": 5, "format": "s16", "error_value": "0x7FFF" }
)" + kWbTail);
  const std::string& text = outcome.files.front().text;
  EXPECT_THAT(text, HasSubstr("timeout: 300ms\n        pause: 5ms\n        max-block: 20"));
  EXPECT_THAT(text, HasSubstr("word-order: little-endian"));
  EXPECT_EQ(channel_line(outcome, "Voltage"),
            "{ name: Voltage, at: \"input-register:16\", type: uint32, scale: 0.001, unit: V }");
  expect_channels(outcome, {"Alarm -> at: \"holding:20.3\", type: bool }",
                            "High -> type: uint8, byte: high", "Relay -> access: read-write",
                            "Lamp-Level -> at: \"holding:105\", type: uint16, access: read-write, "
                            "write: { min: 0, max: 100 }"});
  EXPECT_EQ(fate_of(outcome, "Error"), "the raw value 0x7FFF means an error");
  EXPECT_THAT(outcome.notes, Contains(HasSubstr("1 writes when the program starts")));
}

TEST(ImportWb, WhatTheUsualDeviceLacksIsReadByCommand) {
  const auto outcome = imported("config-meter.json", kWbHead + R"(
    { "name": "there", "reg_type": "input", "address": 1, "condition": "mode==1" },
    { "name": "away", "reg_type": "input", "address": 2, "condition": "(mode>=2)||other==1" },
    { "name": "idle", "reg_type": "input", "address": 3, "enabled": false }
)" + kWbTail);
  EXPECT_EQ(fate_of(outcome, "there"), "ok");
  EXPECT_THAT(channel_line(outcome, "away"), HasSubstr("mode: on-demand"));
  EXPECT_THAT(fate_of(outcome, "away"), HasSubstr("the device has it where (mode>=2)||other==1"));
  EXPECT_THAT(channel_line(outcome, "idle"), HasSubstr("mode: on-demand"));
}

TEST(ImportWb, WhatCannotBeMovedHasItsReason) {
  const auto outcome = imported("config-meter.json", kWbHead + R"(
    { "name": "text", "reg_type": "input", "address": 1, "format": "string",
      "string_data_size": 6 },
    { "name": "bits", "reg_type": "input", "address": "1:2:3" },
    { "name": "odd", "reg_type": "input", "address": 3, "format": "u24" },
    { "name": "foreign", "reg_type": "relay", "address": 3 },
    { "name": "rgb", "consists_of": [ { "reg_type": "holding", "address": 4 } ] },
    { "name": "part", "device_type": "nothing" },
    { "name": "good", "reg_type": "input", "address": 9 }
)" + kWbTail);
  expect_fates(outcome,
               {"text -> no: a text with one character", "bits -> no: 3 bits of a register",
                "odd -> no: the format u24", "foreign -> not of Modbus", "rgb -> several registers",
                "part -> not in the template"});
  EXPECT_EQ(fate_of(outcome, "good"), "ok");
}

TEST(ImportWb, FilesThatAreNoTemplatesOfModbusAreReportedBesideTheOthers) {
  const auto outcome = imported_files(
      {{"config-a.json", R"({"device_type":"a","device":{"name":"A","id":"a","channels":[
          {"name":"x","reg_type":"input","address":1}]}})"},
       {"config-b.json", R"({"device_type":"b","device":{"name":"B","protocol":"milur","channels":[
          {"name":"x","reg_type":"input","address":1}]}})"},
       {"config-c.json.jinja", R"({"device_type":"c","device":{"name":"C","channels":[
          {% for i in range(3) %}{"name":"x","reg_type":"input","address":1},{% endfor %}]}})"}},
      {});
  EXPECT_EQ(outcome.count(Fate::kMoved), 1u);
  expect_fates(outcome, {"B -> milur is not Modbus", "config-c.json -> a Jinja template"});
}

TEST(ImportWb, AConfigurationNamesPortsAndTemplates) {
  const auto outcome = imported_files(
      {{"wb-mqtt-serial.conf", R"({ "ports": [ { "path": "/dev/ttyRS485-1", "baud_rate": 9600,
          "parity": "N", "data_bits": 8, "stop_bits": 2, "devices": [
            { "slave_id": "17", "device_type": "meter", "name": "hall", "mode": 2 },
            { "slave_id": 18, "device_type": "gone" } ] } ] })"},
       {"config-meter.json", kWbHead + R"(
          { "name": "x", "reg_type": "input", "address": 2, "condition": "mode==2" })" +
                                 kWbTail}},
      {});
  EXPECT_THAT(outcome.files.front().text,
              HasSubstr("serial: \"/dev/ttyRS485-1\", baud: 9600, format: 8N2"));
  EXPECT_THAT(outcome.files.front().text, HasSubstr("- name: hall\n        address: 17"));
  EXPECT_EQ(fate_of(outcome, "x"), "ok");
  EXPECT_THAT(fate_of(outcome, "gone"), HasSubstr("\"device_type\": \"gone\""));
}

TEST(ImportWb, ABitThatMeansTheOppositeIsRefused) {
  const auto outcome = imported("config-meter.json", kWbHead + R"(
    { "name": "coil", "reg_type": "coil", "address": 1, "on_value": 0, "off_value": 1 },
    { "name": "input", "reg_type": "discrete", "address": 1, "on_value": "0x00" },
    { "name": "bit", "reg_type": "holding", "address": "10:2:1", "off_value": "1" },
    { "name": "usual", "reg_type": "coil", "address": 2, "on_value": 1, "off_value": 0 },
    { "name": "number", "reg_type": "holding", "address": 3, "on_value": 0, "off_value": 1 }
)" + kWbTail);
  EXPECT_EQ(fate_of(outcome, "coil"),
            "no: a bit that means the opposite (on_value 0, off_value 1); a channel's is on at 1");
  expect_fates(outcome, {"input -> no: a bit that means the opposite",
                         "bit -> no: a bit that means the opposite"});
  EXPECT_EQ(fate_of(outcome, "usual"), "ok");
  EXPECT_EQ(fate_of(outcome, "number"), "a number: 0 is on, 1 is off");
}

TEST(ImportWb, AConfigurationSaysWhichChannelsAreOn) {
  const auto outcome =
      imported_files({{"wb-mqtt-serial.conf",
                       R"({ "ports": [ { "path": "/dev/ttyRS485-1", "baud_rate": 9600,
          "devices": [ { "slave_id": "17", "device_type": "meter", "channels": [
            { "name": "V", "enabled": false }, { "name": "W", "enabled": true },
            { "name": "R", "readonly": true, "address": 99, "read_period_ms": 5000 },
            { "name": "Lamp", "channels": [
              { "name": "Level", "enabled": false, "readonly": true } ] },
            { "name": "Typo", "enabled": false },
            { "name": "Own", "reg_type": "input", "address": 20 } ] } ] } ] })"},
                      {"config-meter.json", kWbHead + R"(
          { "name": "V", "reg_type": "input", "address": 1 },
          { "name": "W", "reg_type": "input", "address": 2, "enabled": false },
          { "name": "R", "reg_type": "coil", "address": 3 },
          { "name": "H", "reg_type": "input", "address": 4, "enabled": false, "hidden": true },
          { "name": "Lamp", "device_type": "lamp" })" +
                                                kWbTail}},
                     {});
  EXPECT_THAT(channel_line(outcome, "V"), HasSubstr("mode: on-demand"));
  EXPECT_EQ(fate_of(outcome, "V"), "off in the configuration: read by command only");
  EXPECT_EQ(fate_of(outcome, "W"), "ok");
  EXPECT_EQ(channel_line(outcome, "W"), "{ name: W, at: \"input-register:2\", type: uint16 }");
  EXPECT_EQ(channel_line(outcome, "R"), "{ name: R, at: \"coil:3\", type: bool, refresh: 5s }");
  EXPECT_EQ(fate_of(outcome, "H"), "ok");
  EXPECT_THAT(channel_line(outcome, "Lamp-Level"), HasSubstr("mode: on-demand }"));
  EXPECT_EQ(fate_of(outcome, "Typo"), "no: no address");
  EXPECT_EQ(fate_of(outcome, "Own"), "ok");
  EXPECT_EQ(outcome.rows.size(), 7u);
}

TEST(ImportWb, PortsAndDevicesThatAreOffAreNotMoved) {
  const auto outcome = imported("wb-mqtt-serial.conf", R"({ "ports": [
    { "path": "/dev/ttyS1", "enabled": false, "devices": [ { "slave_id": 1, "name": "a",
        "channels": [ { "name": "x", "reg_type": "input", "address": 2 } ] } ] },
    { "path": "/dev/ttyS2", "baud_rate": 9600, "enabled": true, "devices": [
        { "slave_id": 2, "name": "b", "enabled": false,
          "channels": [ { "name": "y", "reg_type": "input", "address": 2 } ] },
        { "slave_id": 3, "name": "c",
          "channels": [ { "name": "z", "reg_type": "input", "address": 2 } ] } ] } ] })");
  expect_fates(outcome, {"/dev/ttyS1 -> no: the port is off", "b -> no: the device is off"});
  EXPECT_EQ(fate_of(outcome, "z"), "ok");
  EXPECT_EQ(outcome.files.front().text.find("ttyS1"), std::string::npos);
}

TEST(ImportWb, ConditionsFollowTheirRules) {
  const auto holds = [](std::string_view condition) -> std::string {
    const auto result = condition_holds(condition, [](std::string_view name) {
      return name == "a" ? std::optional<double>(2) : std::nullopt;
    });
    return !result ? "broken" : *result ? "yes" : "no";
  };
  EXPECT_EQ(holds("a==2"), "yes");
  EXPECT_EQ(holds("a!=2||(a>1&&a<=2)"), "yes");
  EXPECT_EQ(holds("b==2"), "no");
  EXPECT_EQ(holds("b!=2"), "yes");
  EXPECT_EQ(holds("isDefined(a)&&isDefined(b)==0"), "yes");
  EXPECT_EQ(holds("a=="), "broken");
  EXPECT_EQ(holds("a==2)"), "broken");
  EXPECT_EQ(holds(std::string(1000, '(')), "broken");
}

const std::string kScript = R"ioc(
epicsEnvSet("DEV", "PLC1")
drvAsynIPPortConfigure("$(DEV)","10.0.0.9:502",0,0,1)
modbusInterposeConfig("$(DEV)",0,2000,10)
drvModbusAsynConfigure("In",  "$(DEV)", 3, 4, 0100, 020, "INT16", 100, "Koyo")
drvModbusAsynConfigure("Bits","$(DEV)", 3, 1, 04000, 040, 0, 250, "Koyo")
drvModbusAsynConfigure("Out", "$(DEV)", 3, 6, 200, 8, 4, 1, "Koyo")
dbLoadRecords("meter.db", "P=X:")
dbLoadTemplate("bits.substitutions")
)ioc";

std::vector<InputFile> ioc(const std::string& database, const std::string& substitutions = {}) {
  std::vector<InputFile> files{{"st.cmd", kScript}, {"db/meter.db", database}};
  files.push_back({"bits.substitutions", substitutions.empty()
                                             ? "# file pattern {\nfile \"a.template\" { }"
                                             : substitutions});
  return files;
}

TEST(ImportEpics, RecordsBehindAStartupScriptBecomeChannels) {
  const auto outcome = imported_files(ioc(R"ioc(
record(ai, "$(P)Power") {
  field(DTYP, "asynInt32")  field(INP, "@asyn(In 2)FLOAT32_LE")
  field(EGU, "kW")  field(SCAN, ".5 second")
  field(HIGH, "90") field(HSV, "MINOR")
}
record(ai, "$(P)Level") {
  field(DTYP, "asynInt32") field(INP, "@asynMask(In 4 12)MODBUS_DATA")
  field(LINR, "LINEAR") field(EGUL, "0") field(EGUF, "4095") field(SCAN, "I/O Intr")
}
record(bi, "$(P)Ready") { field(DTYP, "asynUInt32Digital") field(INP, "@asynMask(In 5 0x80)") }
record(ao, "$(P)Set") { field(DTYP, "asynInt32") field(OUT, "@asyn(Out 1)") }
record(calc, "$(P)Sum") { field(CALC, "A+B") }
)ioc",
                                          R"ioc(
file "../../db/bi_bit.template" { pattern
{P,   R,   PORT, OFFSET, SCAN}
{X:,  C0,  Bits, 010,    "I/O Intr"}
}
file "$(ASYN)/db/asynRecord.db" { pattern {P, R} {X:, Asyn} }
)ioc"),
                                      {});
  const std::string& text = outcome.files.front().text;
  EXPECT_THAT(text, HasSubstr("- name: PLC1\n    port: { tcp: \"10.0.0.9:502\" }"));
  EXPECT_THAT(text, HasSubstr("address: 3\n"));
  EXPECT_THAT(text, HasSubstr("timeout: 2s\n        pause: 10ms"));
  EXPECT_EQ(channel_line(outcome, "X-Power"),
            "{ name: X-Power, at: \"input-register:66\", type: float32, unit: kW, refresh: 500ms, "
            "limits: { high: 90 } }");
  expect_channels(outcome, {"X-Level -> at: \"input-register:68\", type: uint16, refresh: 100ms",
                            "X-Ready -> at: \"input-register:69.7\"",
                            "X-Set -> at: \"holding:201\", type: uint16, access: read-write",
                            "X-C0 -> at: \"coil:2056\", type: bool"});
  EXPECT_THAT(outcome.notes, Contains(HasSubstr("1 records that read no device")));
  EXPECT_THAT(outcome.notes, Contains(HasSubstr("1 records about the driver")));
}

TEST(ImportEpics, WhatCannotBeMovedHasItsReason) {
  const auto outcome = imported_files(ioc(R"ioc(
record(ai, "a") { field(DTYP, "asynInt32") field(INP, "@asyn(In 0)INT16SM") }
record(ai, "b") { field(DTYP, "asynInt32") field(INP, "@asyn(Nowhere 0)INT16") }
record(ao, "c") { field(DTYP, "asynInt32") field(OUT, "@asyn(In 0)INT16") }
record(mbbi, "d") { field(DTYP, "asynUInt32Digital") field(INP, "@asynMask(In 0 0x30)") }
record(ai, "e") { field(DTYP, "asynInt32") field(INP, "@asyn(In 0)") field(LINR, "typeKdegC") }
record(ai, "f") { field(DTYP, "asynInt32") field(INP, "@asyn(In 0)") }
)ioc"),
                                      {});
  expect_fates(outcome, {"a -> sign and magnitude", "b -> makes the port 'Nowhere'",
                         "c -> the record writes", "d -> the bits 0x30", "e -> not linear"});
  EXPECT_EQ(fate_of(outcome, "f"), "ok");
}

TEST(ImportEpics, EachInterfaceHasItsOwnConversion) {
  const auto outcome = imported_files(ioc(R"ioc(
record(ai, "a") { field(DTYP, "asynFloat64") field(INP, "@asyn(In 0)FLOAT32_BE")
  field(LINR, "SLOPE") field(ESLO, "0.5") field(EOFF, "3") field(ASLO, "2") field(AOFF, "1") }
record(ai, "b") { field(DTYP, "asynFloat64") field(INP, "@asyn(In 2)FLOAT32_BE")
  field(LINR, "LINEAR") field(EGUF, "100") }
record(ai, "c") { field(DTYP, "asynInt64") field(INP, "@asyn(In 4)INT64_BE")
  field(LINR, "SLOPE") field(ESLO, "0.5") field(ASLO, "2") }
record(ai, "d") { field(DTYP, "asynInt32") field(INP, "@asyn(In 8)")
  field(LINR, "SLOPE") field(ESLO, "0.5") field(EOFF, "3") field(ASLO, "2") field(AOFF, "1") }
record(ai, "e") { field(DTYP, "asynInt32") field(INP, "@asynMask(In 9 -16)")
  field(LINR, "LINEAR") field(EGUF, "10") field(EGUL, "-10") }
)ioc"),
                                      {});
  expect_channels(outcome, {"a -> type: float32, scale: 2, offset: 1 }", "b -> type: float32 }",
                            "c -> type: int64 }", "d -> type: int16, offset: 3.5 }"});
  // -32767 is -10 and 32767 is 10.
  EXPECT_THAT(channel_line(outcome, "e"), HasSubstr("type: int16, scale: 0.000305185"));
  EXPECT_THAT(channel_line(outcome, "e"), Not(HasSubstr("offset")));
}

TEST(ImportEpics, LimitsOfWhatIsWrittenAreMoved) {
  const auto outcome = imported_files(ioc(R"ioc(
record(ao, "a") { field(DTYP, "asynInt32") field(OUT, "@asyn(Out 0)")
  field(ASLO, "0.1") field(DRVH, "50") field(DRVL, "1.5") }
record(longout, "b") { field(DTYP, "asynInt32") field(OUT, "@asyn(Out 1)") field(DRVH, "7") }
record(longout, "c") { field(DTYP, "asynInt32") field(OUT, "@asyn(Out 2)") field(DRVH, "-7") }
)ioc"),
                                      {});
  EXPECT_THAT(channel_line(outcome, "a"), HasSubstr("write: { min: 1.5, max: 50 }"));
  EXPECT_THAT(fate_of(outcome, "a"), HasSubstr("beyond DRVL and DRVH is refused"));
  EXPECT_THAT(channel_line(outcome, "b"), HasSubstr("write: { min: 0, max: 7 }"));
  EXPECT_THAT(channel_line(outcome, "c"), Not(HasSubstr("write: {")));
}

TEST(ImportEpics, BitsOfANumberKeepTheirSign) {
  const auto outcome = imported_files(ioc(R"ioc(
record(longin, "low")   { field(DTYP, "asynInt32") field(INP, "@asynMask(In 0 8)") }
record(longin, "signed") { field(DTYP, "asynInt32") field(INP, "@asynMask(In 1 -8)MODBUS_DATA") }
record(longin, "twelve") { field(DTYP, "asynInt32") field(INP, "@asynMask(In 2 12)") }
record(longin, "minus") { field(DTYP, "asynInt32") field(INP, "@asynMask(In 3 -12)") }
record(longin, "all")   { field(DTYP, "asynInt32") field(INP, "@asynMask(In 4 16)INT16") }
record(longin, "wide")  { field(DTYP, "asynInt32") field(INP, "@asynMask(In 5 20)INT16") }
record(longin, "odd")   { field(DTYP, "asynInt32") field(INP, "@asynMask(In 6 77)") }
record(longin, "float") { field(DTYP, "asynInt32") field(INP, "@asynMask(In 7 8)FLOAT32_BE") }
record(longout, "out")  { field(DTYP, "asynInt32") field(OUT, "@asynMask(Out 1 -8)") }
record(bi, "state")     { field(DTYP, "asynInt32") field(INP, "@asyn(In 9)") }
)ioc"),
                                      {});
  EXPECT_THAT(channel_line(outcome, "low"), HasSubstr("type: uint8, byte: low"));
  EXPECT_EQ(fate_of(outcome, "low"), "ok");
  EXPECT_THAT(channel_line(outcome, "signed"), HasSubstr("type: int8, byte: low"));
  EXPECT_EQ(fate_of(outcome, "twelve"), "bits above 11 are not cut off");
  EXPECT_EQ(fate_of(outcome, "minus"), "no: a sign in bit 11 of a number of 16 bits");
  EXPECT_THAT(channel_line(outcome, "all"), HasSubstr("type: uint16"));
  EXPECT_EQ(fate_of(outcome, "wide"), "no: 20 bits of a number of 16");
  EXPECT_EQ(fate_of(outcome, "odd"), "no: 77 bits");
  EXPECT_EQ(fate_of(outcome, "float"), "no: 8 bits of a floating-point number");
  EXPECT_THAT(channel_line(outcome, "out"), HasSubstr("type: int16"));
  EXPECT_THAT(fate_of(outcome, "out"), HasSubstr("bits above 7 are not cut off"));
  EXPECT_EQ(fate_of(outcome, "state"), "a number: 0 is off, any other is on");
}

TEST(ImportEpics, AFileThatIsMissingIsNamed) {
  const auto alone = imported_files({{"meter.db",
                                      "record(ai, \"x\") { field(DTYP, \"asynInt32\") "
                                      "field(INP, \"@asyn(In 0)\") }"}},
                                    {});
  EXPECT_TRUE(alone.files.empty());
  EXPECT_THAT(fate_of(alone, "x"), HasSubstr("st.cmd"));
  const auto script = imported_files({{"st.cmd", kScript}}, {});
  EXPECT_THAT(fate_of(script, "meter.db"), HasSubstr("not among those that were given"));
}

TEST(ImportEpics, MacrosThatNameThemselvesEnd) {
  EXPECT_EQ(expand("$(A)-$(B=7)-${C}", {{"A", "x$(D)"}, {"D", "y"}}), "xy-7-${C}");
  EXPECT_LT(expand("$(A)", {{"A", "$(A)$(A)$(A)"}}).size(), 3 * kMaxExpanded);
  EXPECT_EQ(c_number("04000"), 2048);
  EXPECT_EQ(c_number("0x1F"), 31);
  EXPECT_EQ(c_number("-16"), -16);
  EXPECT_EQ(c_number("12x"), std::nullopt);
}

TEST(ImportNeuron, TagsOfGroupsBecomeChannelsOfEachSlave) {
  const auto outcome = imported("neuron.json", R"({ "nodes": [ {
    "name": "plant", "plugin": "Modbus RTU",
    "params": { "link": 0, "device": "/dev/ttyS2", "baud": 3, "parity": 2, "data": 3, "stop": 0,
                "timeout": 3000, "interval": 20, "endianess": 4 },
    "groups": [ { "group": "g", "interval": 3000, "tags": [
      { "name": "power", "address": "1!400001", "attribute": 1, "type": 9, "decimal": 0.1,
        "bias": 5 },
      { "name": "count", "address": "2!300010#BB", "attribute": 3, "type": 6 },
      { "name": "run", "address": "1!000003", "attribute": 3, "type": 11 },
      { "name": "flag", "address": "1!400020.4", "attribute": 1, "type": 11 },
      { "name": "text", "address": "1!400030.10L", "attribute": 1, "type": 13 },
      { "name": "raw", "address": "1!400040.8", "attribute": 1, "type": 14 } ] } ] },
    { "name": "other", "plugin": "S7COMM", "groups": [] } ] })");
  const std::string& text = outcome.files.front().text;
  EXPECT_THAT(text, HasSubstr("serial: \"/dev/ttyS2\", baud: 19200, format: 8E1"));
  EXPECT_THAT(text, HasSubstr("refresh: 3s\n        word-order: little-endian"));
  EXPECT_EQ(channel_line(outcome, "power"),
            "{ name: power, at: \"holding:0\", type: float32, scale: 0.1, offset: 5 }");
  expect_channels(
      outcome, {"count -> at: \"input-register:9\", type: uint32", "run -> at: \"coil:2\"",
                "flag -> at: \"holding:19.4\"", "text -> string(10), byte-order: little-endian"});
  expect_fates(outcome, {"raw -> no counterpart", "other -> s7comm is not Modbus"});
}

TEST(ImportNeuron, ANodeWithoutSettingsHasNotThoseOfTheNodeBefore) {
  const auto outcome = import_text("neuron.json", R"({ "nodes": [
    { "name": "first", "params": { "host": "10.0.0.1", "timeout": 3000, "interval": 20 },
      "groups": [ { "group": "g",
                    "tags": [ { "name": "a", "address": "1!400001", "type": 4 } ] } ] },
    { "name": "second",
      "groups": [ { "group": "g",
                    "tags": [ { "name": "b", "address": "2!400001", "type": 4 } ] } ] }
    ] })");
  ASSERT_TRUE(outcome) << outcome.error();
  const std::string& text = outcome->files.front().text;
  EXPECT_THAT(text, HasSubstr("name: first\n        address: 1\n        timeout: 3s"));
  EXPECT_THAT(text, HasSubstr("name: second\n        address: 2\n        channels:"));
}

TEST(ImportNeuron, TablesOfItsPagesAreUnderstood) {
  const auto outcome =
      imported("tags.csv",
               "group,interval,name,address,attribute,type,description,decimal,precision,bias\n"
               "a,1000,power,1!400001,Read Subscribe,FLOAT,,0.5,,\n"
               "b,2000,set,1!400003#B,Read Write,INT16,setpoint,,,\n");
  expect_channels(outcome, {"a.power -> type: float32, scale: 0.5, refresh: 1s",
                            "b.set -> byte-order: little-endian", "b.set -> access: read-write"});
}

}  // namespace
}  // namespace fieldcast::importing
