// Tests defaults for missing line and device settings: those of the program, with a note.
#include "tests/tools/import/support.hpp"

namespace fieldcast::importing {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kList = "Address,Name,Type\n1,a,U16\n";

std::string port_of(const tl::expected<Outcome, std::string>& outcome) {
  if (!outcome) return outcome.error();
  if (outcome->files.empty()) return "nothing is written";
  const std::string& text = outcome->files.front().text;
  const std::size_t at = text.find("port: { ");
  return at == std::string::npos ? "" : text.substr(at + 8, text.find(" }", at) - at - 8);
}

TEST(ImportLines, APortThatTheUserSaysHasTheRateThatIsStated) {
  const auto outcome = import_text("a.csv", kList, {.port = {.serial = "/dev/ttyS1"}});
  EXPECT_EQ(port_of(outcome), "serial: \"/dev/ttyS1\", baud: 9600, format: 8N1");
  EXPECT_THAT(outcome->notes, Contains(HasSubstr("no baud rate: 9600 8N1 is taken")));
  EXPECT_EQ(port_of(import_text(
                "a.csv", kList,
                {.port = {.serial = "/dev/ttyS1", .line = {.baud = 19200, .format = "8E1"}}})),
            "serial: \"/dev/ttyS1\", baud: 19200, format: 8E1");
  EXPECT_EQ(port_of(import_text("a.csv", kList, {.port = {.tcp = "10.0.0.2:502"}})),
            "tcp: \"10.0.0.2:502\"");
}

TEST(ImportLines, AnotherFamilyHasTheLineOfItsFactory) {
  const auto outcome =
      import_text("k.csv", "Tag Name,Address,Data Type,Client Access\n\"a\",V00100,Word,RO\n",
                  {.from = "kepware", .protocol = "s7-ppi", .port = {.serial = "/dev/ttyS1"}});
  EXPECT_EQ(port_of(outcome), "serial: \"/dev/ttyS1\", baud: 9600, format: 8E1");
}

TEST(ImportLines, OnlyListsOfModbusStateTheOrderOfWords) {
  const std::string tags =
      "Tag Name,Address,Data Type,Client Access\n\"a\",V00100,DWord,RO\n\"b\",400001,DWord,RO\n";
  const auto ppi = imported("k.csv", tags, {.from = "kepware", .protocol = "s7-ppi"});
  EXPECT_THAT(ppi.notes, Not(Contains(HasSubstr("low word first"))));
  const auto modbus = import_text("k.csv", tags, {.from = "kepware"});
  EXPECT_THAT(modbus->notes, Contains(HasSubstr("low word first")));
}

TEST(ImportLines, EachProgramHasItsOwnRate) {
  const auto wb = import_text("wb.conf", R"({ "ports": [ { "path": "/dev/ttyS1", "devices": [
      { "slave_id": 1, "name": "a",
        "channels": [ { "name": "x", "reg_type": "input", "address": 2 } ] } ] } ] })");
  EXPECT_EQ(port_of(wb), "serial: \"/dev/ttyS1\", baud: 9600, format: 8N1");
  EXPECT_THAT(wb->notes, Contains(HasSubstr("/dev/ttyS1: the list says no baud rate: 9600 8N1 is "
                                            "taken, the baud rate of wb-mqtt-serial")));
  const auto telegraf = import_text("t.conf",
                                    "[[inputs.modbus]]\n  name = \"a\"\n  slave_id = 1\n"
                                    "  controller = \"file:///dev/ttyUSB0\"\n"
                                    "  coils = [ { name = \"x\", address = [1] } ]\n");
  EXPECT_EQ(port_of(telegraf), "serial: \"/dev/ttyUSB0\", baud: 19200, format: 8E1");
  EXPECT_THAT(telegraf->notes, Contains(HasSubstr("the baud rate of Telegraf")));
  const auto epics = run_import(
      {{"st.cmd",
        "drvAsynSerialPortConfigure(\"S\",\"/dev/ttyS1\",0,0,0)\n"
        "modbusInterposeConfig(\"S\",1,1000,0)\n"
        "drvModbusAsynConfigure(\"P\", \"S\", 1, 3, 0, 20, UINT16, 1000, \"PLC\")\n"
        "dbLoadRecords(\"a.db\")\n"},
       {"a.db", "record(longin, \"x\") { field(DTYP,\"asynInt32\") field(INP,\"@asyn(P 2)\") }\n"}},
      {});
  EXPECT_EQ(port_of(epics), "serial: \"/dev/ttyS1\", baud: 9600, format: 8N1");
  EXPECT_THAT(epics->notes, Contains(HasSubstr("the baud rate of asyn")));
  const auto neuron = [](const std::string& settings) {
    return import_text("n.json", R"({ "nodes": [ { "name": "n", "plugin": "Modbus RTU",
      "params": { "link": 0, "device": "/dev/ttyS1" )" +
                                     settings +
                                     R"( }, "groups": [ { "group": "g", "tags": [
      { "name": "x", "address": "1!400001", "attribute": 1, "type": 3 } ] } ] } ] })");
  };
  EXPECT_EQ(port_of(neuron("")), "serial: \"/dev/ttyS1\", baud: 9600, format: 8N1");
  EXPECT_THAT(neuron("")->notes, Contains(HasSubstr("the baud rate of Neuron")));
  EXPECT_EQ(port_of(neuron(R"(, "baud": 10)")), "serial: \"/dev/ttyS1\", baud: 300, format: 8N1");
  EXPECT_THAT(neuron(R"(, "baud": 3)")->notes, Not(Contains(HasSubstr("baud rate"))));
  EXPECT_THAT(fate_of(*neuron(R"(, "baud": 12)"), "x"), HasSubstr("baud 150 is no rate"));
  EXPECT_THAT(fate_of(*neuron(R"(, "parity": 3)"), "x"), HasSubstr("parity mark or space"));
}

}  // namespace
}  // namespace fieldcast::importing
