// The list of devices that a bridge sends to engineers.
#include "core/program/list_client.hpp"
#include "tests/bridge/program/lease_fixture.hpp"
#include "tests/bridge/support/certificates.hpp"
#include "tests/bridge/support/pty.hpp"
#include "tests/bridge/support/tls_client.hpp"

namespace fieldcast::test {
namespace {

using program::ListedDevice;
using State = ListedDevice::State;
using testing::ElementsAre;
using testing::Field;
using testing::IsEmpty;
using testing::StartsWith;

auto is(const std::string& number, const std::string& bus, const std::string& device, State state) {
  return testing::AllOf(Field(&ListedDevice::number, number), Field(&ListedDevice::bus, bus),
                        Field(&ListedDevice::device, device), Field(&ListedDevice::state, state));
}

class DeviceList : public LeaseFixture {
 protected:
  // Requests the list in a new connection, which logs in as anna first if `login`.
  [[nodiscard]] std::vector<ListedDevice> list(const std::string& login = "") const {
    TcpClient client = engineer();
    client.send(login + "@@LS:FEFF");
    program::ListClient reader("", "");
    for (std::string frame = client.receive("FEFF"); !frame.empty();
         frame = client.receive("FEFF")) {
      const auto result = reader.on_bytes(program::as_bytes(frame));
      if (!result) continue;
      EXPECT_TRUE(*result) << result->error().text;
      return *result ? (*result)->devices : std::vector<ListedDevice>{};
    }
    ADD_FAILURE() << "no list";
    return {};
  }
  // Repeats the request until `matches`, because a registration takes some time.
  void expect_list(const testing::Matcher<std::vector<ListedDevice>>& matches) const {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{10};
    auto devices = list();
    while (!matches.Matches(devices) && std::chrono::steady_clock::now() < deadline)
      devices = list();
    EXPECT_THAT(devices, matches);
  }

  Pty pty;
  SerialPortSpec serial = [this] {
    SerialPortSpec made;
    made.path = pty.path();
    made.line = {115200, 8, Parity::kNone, 1};
    return made;
  }();
};

TEST_F(DeviceList, HasTheDevicesWithANumberAndThoseOfALeasedBusAreInUse) {
  BusSpec bus = bus_of(serial);
  bus.devices.push_back(bus.devices.front());
  bus.devices.back().name = "plc-2";
  bus.devices.back().number = "P2";
  bus.devices.push_back(bus.devices.front());
  bus.devices.back().name = "meter";
  bus.devices.back().number = "";
  start();
  EXPECT_THAT(list(), IsEmpty());
  run(bus);
  EXPECT_THAT(list(), ElementsAre(is("P1", "line", "plc", State::kFree),
                                  is("P2", "line", "plc-2", State::kFree)));
  std::unique_ptr<TcpClient> first;  // paired when the bus has opened its port
  ASSERT_EQ(paired(server.engineers_port(), "P1", first), "@@0000FEFF");
  EXPECT_THAT(list(), ElementsAre(is("P1", "line", "plc", State::kInUse),
                                  is("P2", "line", "plc-2", State::kInUse)));
  TcpClient second = engineer();
  second.send("@@P2FEFF");
  EXPECT_EQ(second.receive("FEFF"), "@@0002FEFF");
  first->send("@@EDFEFF");
  expect_list(
      ElementsAre(is("P1", "line", "plc", State::kFree), is("P2", "line", "plc-2", State::kFree)));
}

TEST_F(DeviceList, HasModulesAndReportsABusWhoseModuleHasNotDialledIn) {
  BusSpec bus = bus_of(DialInPortSpec{"18", std::nullopt});
  start();
  run(bus);
  EXPECT_THAT(list(), ElementsAre(is("18", "line", "plc", State::kNotOnline),
                                  is("P1", "line", "plc", State::kNotOnline)));
  const TcpClient without_bus = module("17\n"), of_bus = module("18\n");
  expect_list(ElementsAre(is("17", "dial-in", "17", State::kFree),
                          is("18", "line", "plc", State::kFree),
                          is("P1", "line", "plc", State::kFree)));
  TcpClient client = engineer();
  client.send("@@17FEFF");
  ASSERT_EQ(client.receive("FEFF"), "@@0000FEFF");
  EXPECT_THAT(list(), testing::Contains(is("17", "dial-in", "17", State::kInUse)));
}

TEST_F(DeviceList, NamesTheEngineersOnlyToUsersThatHaveLoggedIn) {
  start();
  const TcpClient module = this->module("17\n");
  TcpClient client = engineer();
  client.send(kLoginOfAnna);
  ASSERT_EQ(pair(client, "17"), "@@0000FEFF");
  EXPECT_THAT(list(), ElementsAre(Field(&ListedDevice::who, "")));
  EXPECT_THAT(list(kLoginOfAnna),
              ElementsAre(Field(&ListedDevice::who, StartsWith("anna (127.0.0.1:"))));
  EXPECT_TRUE(audited("1 device listed"));
}

TEST_F(DeviceList, NeedsTheLoginOfAPairing) {
  spec.engineers->login = LoginRule::kAlways;
  start();
  TcpClient nobody = engineer();
  nobody.send("@@LS:FEFF");
  EXPECT_EQ(nobody.receive("FEFF"), "@@0004FEFF");
  EXPECT_TRUE(nobody.is_closed());
  EXPECT_TRUE(audited("login refused: the list of devices was requested without a login"));
  TcpClient bob = engineer();
  bob.send(std::string(kLoginOfBob) + "@@LS:FEFF");
  EXPECT_EQ(bob.receive("FEFF"), "@@0004FEFF");
  EXPECT_TRUE(bob.is_closed());
  EXPECT_THAT(list(kLoginOfAnna), IsEmpty());
}

TEST_F(DeviceList, ACertificateIsTheLogin) {
  Certificates files;
  files.issue("bridge", "bridge");
  files.issue("anna", "anna");
  files.issue("bob", "bob");
  spec.engineers->tls = {files.file("bridge.pem"), files.file("bridge.key"), files.file("ca.pem"),
                         ""};
  spec.engineers->proof = LoginProof::kCertificate;
  start();
  SecureClient anna(server.engineers_port(), files.file("anna"));
  anna.send("@@LS:FEFF");
  EXPECT_EQ(anna.receive("FEFF"), "@@LE0FEFF");
  SecureClient bob(server.engineers_port(), files.file("bob"));
  bob.send("@@LS:FEFF");
  EXPECT_EQ(bob.receive("FEFF"), "@@0004FEFF");
}

TEST_F(DeviceList, APortOfOneDeviceListsNothing) {
  spec.engineers->ports.push_back({.device = "17", .listen = {"127.0.0.1", 0}, .raw = true});
  start();
  TcpClient module = this->module("17\n");
  TcpClient first = engineer();
  ASSERT_EQ(pair(first, "17"), "@@0000FEFF");  // registered
  first.send("@@EDFEFF");
  ASSERT_TRUE(audited("stopped by the engineer"));
  const TcpClient client(server.engineers_port(1));
  client.send("@@LS:FEFF");
  EXPECT_EQ(module.receive("FEFF"), "@@LS:FEFF");  // bytes for the device
}

}  // namespace
}  // namespace fieldcast::test
