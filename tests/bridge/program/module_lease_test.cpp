#include "tests/bridge/program/lease_fixture.hpp"
#include "tests/bridge/support/module_device.hpp"

namespace fieldcast {
namespace {

using std::chrono::milliseconds;
using test::bus_of;
using test::ModuleDevice;
using test::TcpClient;

using Lease = test::LeaseFixture;

TEST_F(Lease, ABusOfAModuleCollectsIsProgrammedAndCollectsAgain) {
  start();
  run(bus_of(DialInPortSpec{"17", std::nullopt}));
  TcpClient module = this->module("17\r\n");
  auto plc = std::make_unique<ModuleDevice>(module);
  EXPECT_TRUE(receives_more());
  plc.reset();
  TcpClient client = engineer();
  EXPECT_EQ(pair(client, "17"), "@@0000FEFF");
  EXPECT_TRUE(leased());
  client.send("@@@00program*\rFEFF");
  EXPECT_THAT(module.receive("program*\r"), testing::EndsWith("@00program*\r"));
  module.send("@00ok*\r");
  EXPECT_EQ(client.receive("\rFEFF"), "@@@00ok*\rFEFF");
  plc = std::make_unique<ModuleDevice>(module);
  client.send("@@EDFEFF");
  EXPECT_TRUE(receives_more());
}

TEST_F(Lease, AModuleThatIsLostIsCollectedAgainWhenItDialsIn) {
  start();
  run(bus_of(DialInPortSpec{"17", std::nullopt}));
  {
    TcpClient module = this->module("17\r\n");
    ModuleDevice plc(module);
    ASSERT_TRUE(receives_more());
  }
  ASSERT_TRUE(
      sink.wait_for([](const auto& r) { return r.reports.back().state == BusState::kClosed; }));
  TcpClient module = this->module("17\r\n");
  ModuleDevice plc(module);
  EXPECT_TRUE(receives_more());
}

TEST_F(Lease, AModuleStaysConnectedWhenItsBusStartsAnew) {
  start();
  BusSpec bus = bus_of(DialInPortSpec{"17", std::nullopt});
  run(bus);
  TcpClient module = this->module("17\r\n");
  ModuleDevice plc(module);
  ASSERT_TRUE(receives_more());
  for (int reload = 0; reload < 20; ++reload) {
    end_bus();
    bus.devices[0].channels[0].refresh += milliseconds{1};
    run(bus);
    ASSERT_TRUE(receives_more()) << reload;
  }
  EXPECT_FALSE(module.is_closed(milliseconds{30}));
}

TEST_F(Lease, AModuleThatDialsInWhileItsBusStartsAnewIsFound) {
  start();
  BusSpec bus = bus_of(DialInPortSpec{"17", std::nullopt});
  for (int reload = 0; reload < 20; ++reload) {
    run(bus);
    TcpClient module = this->module("17\r\n");
    ModuleDevice plc(module);
    if (reload % 2 == 0) {
      end_bus();
      run(bus);
    }
    ASSERT_TRUE(receives_more()) << reload;
    end_bus();
  }
}

TEST_F(Lease, ABusThatIsAddedFindsItsModule) {
  start();
  TcpClient module = this->module("17\r\n");
  TcpClient client = engineer();
  ASSERT_EQ(pair(client, "17"), "@@0000FEFF");  // present and not used by a bus
  client.send("@@EDFEFF@@nobody1FEFF");
  ASSERT_EQ(client.receive("FEFF"), "@@0001FEFF");
  run(bus_of(DialInPortSpec{"17", std::nullopt}));
  ModuleDevice plc(module);
  EXPECT_TRUE(receives_more());
}

TEST_F(Lease, AModuleUnderProgrammingGoesToItsNewBusAtTheEnd) {
  start();
  TcpClient module = this->module("17\r\n");
  TcpClient client = engineer();
  ASSERT_EQ(pair(client, "17"), "@@0000FEFF");
  run(bus_of(DialInPortSpec{"17", std::nullopt}));
  client.send("@@@00program*\rFEFF");
  EXPECT_EQ(module.receive("\r"), "@00program*\r");
  client.send("@@EDFEFF");
  ModuleDevice plc(module);
  EXPECT_TRUE(receives_more());
}

TEST_F(Lease, AModuleWhoseBusIsRemovedCanBeProgrammedAndFoundAgain) {
  start();
  run(bus_of(DialInPortSpec{"17", std::nullopt}));
  TcpClient module = this->module("17\r\n");
  auto plc = std::make_unique<ModuleDevice>(module);
  ASSERT_TRUE(receives_more());
  end_bus();
  plc.reset();
  TcpClient client = engineer();
  ASSERT_EQ(pair(client, "17"), "@@0000FEFF");
  client.send("@@@00program*\rFEFF");
  EXPECT_THAT(module.receive("program*\r"), testing::EndsWith("@00program*\r"));
  client.send("@@EDFEFF");
  ASSERT_TRUE(audited("stopped by the engineer"));
  run(bus_of(DialInPortSpec{"17", std::nullopt}));
  plc = std::make_unique<ModuleDevice>(module);
  EXPECT_TRUE(receives_more());
}

}  // namespace
}  // namespace fieldcast
