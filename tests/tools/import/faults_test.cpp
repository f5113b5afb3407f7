#include "tests/tools/import/support.hpp"

namespace fieldcast::importing {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST(ImportFaults, APortThatIsNoneStopsNoOtherBus) {
  const auto outcome = imported("telegraf.conf", R"([[inputs.modbus]]
  name = "Good"
  controller = "tcp://10.0.0.1:502"
  slave_id = 1
  holding_registers = [ { name="p", byte_order="AB", data_type="INT16", scale=1.0, address=[1] } ]
[[inputs.modbus]]
  name = "NoPort"
  controller = "tcp://10.0.0.2"
  slave_id = 1
  holding_registers = [ { name="q", byte_order="AB", data_type="INT16", scale=1.0, address=[1] } ]
)");
  EXPECT_EQ(fate_of(outcome, "p"), "ok");
  EXPECT_THAT(fate_of(outcome, "q"), StartsWith("no: its bus (telegraf.conf:6): tcp '10.0.0.2'"));
  EXPECT_THAT(fate_of(outcome, "q"), HasSubstr("host"));
  EXPECT_EQ(outcome.rows.back().origin.line, 10u);
  EXPECT_THAT(outcome.files.front().text, Not(HasSubstr("10.0.0.2")));
}

TEST(ImportFaults, ADeviceWithoutAnAddressOfItsBusStopsNoOtherDevice) {
  const auto outcome = imported("list.csv",
                                "Register,Name,Type,Slave\n40001,A,INT16,1\n40002,B,INT16,300\n"
                                "40003,C,INT16,x\n40004,D,INT16,\"5, 6\"\n40005,E,INT16,248\n"
                                "40006,F,INT16,0x11\n");
  EXPECT_EQ(fate_of(outcome, "A"), "ok");
  EXPECT_EQ(fate_of(outcome, "F"), "ok");
  EXPECT_THAT(fate_of(outcome, "B"), StartsWith("no: '300' is no address of a device"));
  EXPECT_THAT(fate_of(outcome, "E"), StartsWith("no: its device: address 248"));
  EXPECT_EQ(fate_of(outcome, "C"), "no: 'x' is no address of a device");
  EXPECT_EQ(fate_of(outcome, "D"), "no: '5, 6' is no address of a device");
  for (const std::string& note : outcome.notes)
    EXPECT_THAT(note, Not(HasSubstr("says no address"))) << note;
}

TEST(ImportFaults, TheDeviceOfAConfigurationIsNamedByItsPlace) {
  const auto outcome = imported("wb-mqtt-serial.conf", R"({ "ports": [
    { "path": "/dev/ttyS1", "baud_rate": 9600, "devices": [
      { "slave_id": 1, "name": "one",
        "channels": [ { "name": "good", "reg_type": "input", "address": 2 } ] },
      { "slave_id": 300, "name": "far",
        "channels": [ { "name": "lost", "reg_type": "input", "address": 2 } ] },
      { "slave_id": "a", "name": "none",
        "channels": [ { "name": "odd", "reg_type": "input", "address": 2 } ] } ] } ] })");
  EXPECT_EQ(fate_of(outcome, "good"), "ok");
  EXPECT_THAT(fate_of(outcome, "lost"), StartsWith("no: its device (wb-mqtt-serial.conf:5): "));
  EXPECT_EQ(fate_of(outcome, "odd"),
            "no: its device (wb-mqtt-serial.conf:7): 'a' is no address of a device on its bus");
}

// The message of the TOML parser quotes the line end that it did not expect.
TEST(ImportFaults, AFaultOfTomlIsOneLine) {
  const auto outcome = import_text("t.conf", "[[inputs.modbus]]\n  configuration_type =n\n");
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().find('\n'), std::string::npos) << outcome.error();
  EXPECT_THAT(outcome.error(), StartsWith("t.conf: line 2: no TOML: "));
}

TEST(ImportFaults, AnOptionThatIsWrongIsNamedAsTheOption) {
  const auto fault = [](const ImportOptions& options) {
    const auto outcome = import_text("a.csv", "Address,Name,Type\n1,a,U16\n", options);
    return outcome ? "fine" : outcome.error();
  };
  EXPECT_EQ(fault({}), "fine");
  EXPECT_THAT(fault({.address = 300}), StartsWith("--address: "));
  EXPECT_EQ(fault({.protocol = "modbus-tcp", .port = {.tcp = "10.0.0.2:502"}, .address = 255}),
            "fine");
  EXPECT_THAT(fault({.port = {.line = {.baud = 115000}}}), HasSubstr("baud 115000 is no rate"));
  EXPECT_THAT(fault({.protocol = "modbus"}),
              StartsWith("--protocol: protocol 'modbus' is unknown"));
  EXPECT_THAT(fault({.port = {.tcp = "10.0.0.2:"}}), StartsWith("--port, --baud, --format: "));
  EXPECT_EQ(fault({.protocol = "modbus-tcp", .port = {.tcp = "10.0.0.2:502"}}), "fine");
}

}  // namespace
}  // namespace fieldcast::importing
