#include "tests/tools/import/support.hpp"

namespace fieldcast::importing {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::Not;

TEST(ImportOtherKeys, OfTelegrafAreNamed) {
  const auto outcome = imported("t.conf", R"([[inputs.modbus]]
  name = "m"
  controller = "tcp://10.0.0.1:502"
  busy_retries = 3
  configuration_type = "request"
  [inputs.modbus.workarounds]
    pause_after_connect = "1s"
  [[inputs.modbus.request]]
    slave_id = 1
    fields = [ { address = 0, name = "a", type = "UINT16", scale = 0.1 },
               { address = 1, name = "b", type = "UINT16", offset = 4 } ]
    [inputs.modbus.request.tags]
      place = "hall"
)");
  EXPECT_THAT(outcome.notes, Contains("t.conf: key 'busy_retries' of inputs.modbus (line 4) "
                                      "is not moved"));
  for (const char* key : {"'pause_after_connect' of workarounds", "'tags' of a request or metric",
                          "'offset' of a field"})
    EXPECT_THAT(outcome.notes, Contains(AllOf(HasSubstr(key), HasSubstr("is not moved")))) << key;
  for (const char* key : {"'scale'", "'configuration_type'", "'workarounds'"})
    EXPECT_THAT(outcome.notes, Each(Not(HasSubstr(key)))) << key;
}

TEST(ImportOtherKeys, OfMqmgatewayAreNamedOnce) {
  const auto outcome = imported("m.yaml", R"(modbus:
  networks:
    - name: n
      address: 10.0.0.1
      watchdog: { watch_period: 10s }
mqtt:
  objects:
    - topic: a
      retain: false
      state: { register: n.1.1, every: 5s }
    - topic: b
      retain: true
      state: { register: n.1.2 }
)");
  EXPECT_THAT(outcome.notes,
              Contains("m.yaml: key 'retain' of an object (line 9, ..) is not moved"));
  EXPECT_THAT(outcome.notes, Contains(HasSubstr("key 'watchdog' of a network (line 5)")));
  EXPECT_THAT(outcome.notes, Contains(HasSubstr("key 'every' of a state or availability")));
}

TEST(ImportOtherKeys, OfNeuronAreNamedInJsonAndInTables) {
  const auto json = imported("n.json", R"({"nodes":[{"name":"p","plugin":"Modbus TCP",
    "params":{"host":"10.0.0.1","port":502,"max_retries":2},
    "groups":[{"group":"g","interval":1000,"tags":[
      {"name":"a","address":"1!40001","type":3,"attribute":1,"precision":2}]}]}]})");
  EXPECT_THAT(json.notes, Contains(HasSubstr("key 'max_retries' of the settings")));
  EXPECT_THAT(json.notes, Contains(HasSubstr("key 'precision' of a tag (line 4)")));
  const auto table = imported("n.csv",
                              "group,interval,name,address,attribute,type,precision\n"
                              "g,1000,a,1!40001,Read,INT16,2\n");
  EXPECT_THAT(table.notes, Contains("n.csv: column 'precision' is not moved"));
}

TEST(ImportOtherKeys, OfATemplateOfWbAreNamedOnceForAllItsDevices) {
  const auto outcome = imported_files(
      {{"config-a.json", R"({"device_type":"a","device":{"name":"A","id":"a","channels":[
          {"name":"x","reg_type":"holding","address":1,"group":"g","sporadic":true,
           "enum":[1]}]}})"},
       {"wb.conf", R"({"ports":[{"path":"/dev/ttyS1","devices":[
          {"device_type":"a","slave_id":1},{"device_type":"a","slave_id":2}]}]})"}},
      {});
  EXPECT_EQ(std::ranges::count(outcome.notes,
                               "config-a.json: key 'sporadic' of a channel (line 2) is not moved"),
            1);
  EXPECT_THAT(outcome.notes, Contains(HasSubstr("key 'enum' of a channel")));
  EXPECT_THAT(outcome.notes, Each(Not(HasSubstr("'group'"))));
}

TEST(ImportOtherKeys, OfEpicsAreNamedWithTheFileOfTheRecord) {
  const auto outcome = imported_files({{"st.cmd", R"~(drvAsynSerialPortConfigure("L1", "/dev/ttyS1")
asynSetOption("L1", 0, "baud", "9600")
asynSetOption("L1", 0, "crtscts", "N")
modbusInterposeConfig("L1", 1, 500, 0)
drvModbusAsynConfigure("R", "L1", 1, 3, 100, 10, "INT16", 1000, "PLC")
dbLoadRecords("a.db")
)~"},
                                       {"a.db", R"~(record(ai, "a") {
  field(DTYP, "asynInt32") field(INP, "@asyn(R 0)") field(SCAN, "1 second")
  field(PREC, "2") field(EGU, "V")
}
record(ai, "b") {
  field(DTYP, "asynInt32") field(INP, "@asyn(R 1)") field(PREC, "1") field(FLNK, "c")
}
record(calc, "c") { field(CALC, "A+1") }
)~"}},
                                      {});
  EXPECT_THAT(outcome.notes, Contains("st.cmd: key 'crtscts' of asynSetOption (line 3) is not "
                                      "moved"));
  EXPECT_THAT(outcome.notes, Contains("a.db: key 'PREC' of a record (line 1, ..) is not moved"));
  EXPECT_THAT(outcome.notes, Contains("a.db: key 'FLNK' of a record (line 5) is not moved"));
  for (const char* key : {"'baud'", "'EGU'", "'SCAN'", "'DTYP'", "'CALC'"})
    EXPECT_THAT(outcome.notes, Each(Not(HasSubstr(key)))) << key;
}

TEST(ImportOtherKeys, HaveABound) {
  std::string text = "modbus: { networks: [ { name: n, address: 10.0.0.1";
  for (int i = 0; i < 200; ++i) text += ", k" + std::to_string(i) + ": 1";
  text += " } ] }\nmqtt: { objects: [ { topic: a, state: { register: n.1.1 } } ] }\n";
  const auto outcome = imported("m.yaml", text);
  EXPECT_EQ(std::ranges::count_if(outcome.notes,
                                  [](const std::string& note) {
                                    return note.find("is not moved") != std::string::npos;
                                  }),
            50);
}

}  // namespace
}  // namespace fieldcast::importing
