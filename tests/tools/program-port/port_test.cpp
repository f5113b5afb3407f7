#include <fstream>

#include "tests/tools/program-port/port_support.hpp"

namespace fieldcast::test {
namespace {

using testing::HasSubstr;
using Port = PortFixture;

std::string content_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Waits until the file contains the text twice.
bool becomes_twice(const std::string& path, const std::string& text) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{15};
  while (std::chrono::steady_clock::now() < deadline) {
    const std::string content = content_of(path);
    const auto first = content.find(text);
    if (first != content.npos && content.find(text, first + 1) != content.npos) return true;
    ::poll(nullptr, 0, 20);
  }
  return false;
}

TEST_F(Port, SoftwareOnTheVirtualPortTalksToAFarPlc) {
  start();
  TcpClient module = this->module("17\n");
  wait_for_module();
  for (const auto& framing : {std::vector<std::string>{}, std::vector<std::string>{"--markers"}}) {
    Process port(FIELDCAST_PORT, arguments(framing));
    ASSERT_THAT(port.said("paired"), HasSubstr("17: paired"));
    const SerialSoftware software(link);
    software.send("@00FA0FEFF*\r");
    EXPECT_EQ(module.receive("\r"), "@00FA0FEFF*\r");
    module.send("@00FA00@@FEFF*\r");
    EXPECT_EQ(software.receive(15), "@00FA00@@FEFF*\r");
    port.signal(SIGINT);
    EXPECT_EQ(port.exit_code(), 0) << port.output();
    EXPECT_THAT(port.output(), HasSubstr("12 bytes sent"));
    EXPECT_THAT(port.output(), HasSubstr("15 received"));
    EXPECT_FALSE(std::filesystem::is_symlink(link));
    ASSERT_TRUE(audited("stopped by the engineer"));
    wait_for_module();
  }
}

TEST_F(Port, EveryByteValuePassesBothWays) {
  start();
  TcpClient module = this->module("17\n");
  wait_for_module();
  Process port(FIELDCAST_PORT, arguments());
  ASSERT_THAT(port.said("paired"), HasSubstr("17: paired"));
  const SerialSoftware software(link);
  std::string all;
  for (int i = 0; i < 1024; ++i) all.push_back(static_cast<char>(i));
  software.send(all);
  EXPECT_EQ(module.receive_bytes(all.size()), all);
  module.send(all);
  EXPECT_EQ(software.receive(all.size()), all);
}

TEST_F(Port, ADeviceThatIsNotThereIsSaidAndTheLinkGoes) {
  start();
  Process port(FIELDCAST_PORT, arguments());
  EXPECT_EQ(port.exit_code(), 3);
  EXPECT_THAT(port.output(), HasSubstr("the device is not online"));
  EXPECT_FALSE(std::filesystem::is_symlink(link));
}

TEST_F(Port, ADeviceInUseIsSaid) {
  start();
  TcpClient module = this->module("17\n");
  TcpClient other = engineer();
  ASSERT_EQ(pair(other, "17"), "@@0000FEFF");
  Process port(FIELDCAST_PORT, arguments());
  EXPECT_EQ(port.exit_code(), 3);
  EXPECT_THAT(port.output(), HasSubstr("in use by another engineer"));
}

TEST_F(Port, TheLossOfTheDeviceEndsIt) {
  start();
  TcpClient module = this->module("17\n");
  wait_for_module();
  Process port(FIELDCAST_PORT, arguments());
  ASSERT_THAT(port.said("paired"), HasSubstr("17: paired"));
  module.close();
  EXPECT_EQ(port.exit_code(), 6) << port.output();
}

TEST_F(Port, WithReconnectALostDeviceIsPairedAgainAtTheSamePort) {
  start();
  std::optional<TcpClient> module = this->module("17\n");
  wait_for_module();
  const std::string log = folder / "log";
  Process port(FIELDCAST_PORT, arguments({"--reconnect", "--log", log}));
  ASSERT_THAT(port.said("paired"), HasSubstr("17: paired"));
  const SerialSoftware software(link, B115200);
  EXPECT_THAT(port.said("115200 baud"), HasSubstr("115200 baud"));
  module->close();
  EXPECT_THAT(port.said("connects again in 1s"), HasSubstr("connects again in 1s"));
  module.emplace(this->module("17\n"));
  // The software does not set its baud rate again.
  ASSERT_TRUE(becomes_twice(log, "the program sets 115200 baud"));
  software.send("@00x*\r");
  EXPECT_EQ(module->receive("\r"), "@00x*\r");
  port.signal(SIGINT);
  EXPECT_EQ(port.exit_code(), 0) << port.output();
  EXPECT_THAT(content_of(log), testing::ContainsRegex("[0-9]Z  17: paired"));
  EXPECT_THAT(content_of(log), HasSubstr("17: stopped"));
}

TEST_F(Port, TheEndOfTheBridgeEndsIt) {
  start();
  TcpClient module = this->module("17\n");
  wait_for_module();
  Process port(FIELDCAST_PORT, arguments({"--json"}));
  ASSERT_THAT(port.said("paired"), HasSubstr("\"state\":\"paired\""));
  server.stop();
  EXPECT_EQ(port.exit_code(), 6) << port.output();
  EXPECT_FALSE(std::filesystem::is_symlink(link));
}

TEST_F(Port, NobodyListeningIsSaid) {
  start();
  const auto without_device = arguments();
  server.stop();
  Process port(FIELDCAST_PORT, without_device);
  EXPECT_EQ(port.exit_code(), 5);
  EXPECT_THAT(port.output(), HasSubstr("Connection refused"));
}

TEST_F(Port, AFileOfOthersIsNeverReplaced) {
  start();
  std::ofstream(link) << "mine";
  Process port(FIELDCAST_PORT, arguments());
  EXPECT_EQ(port.exit_code(), 4);
  std::string content;
  std::ifstream(link) >> content;
  EXPECT_EQ(content, "mine");
}

// A module has no line, so this only checks that settings are detected; see LeaseTest.
TEST_F(Port, TheSpeedThatTheSoftwareSetsIsSeen) {
  start();
  TcpClient module = this->module("17\n");
  wait_for_module();
  Process port(FIELDCAST_PORT, arguments());
  ASSERT_THAT(port.said("paired"), HasSubstr("17: paired"));
  const SerialSoftware software(link, B115200, CSTOPB);
  EXPECT_THAT(port.said("115200 baud"), HasSubstr("the program sets 115200 baud, 2 stop bits"));
  software.send("still here");
  EXPECT_EQ(module.receive("here"), "still here");
}

// This is the default rate of a Linux terminal, but setting it must still be detected.
TEST_F(Port, TheSpeedOfANewTerminalIsSeenWhenItIsSet) {
  start();
  TcpClient module = this->module("17\n");
  wait_for_module();
  Process port(FIELDCAST_PORT, arguments({"--line", "7E2"}));
  ASSERT_THAT(port.said("paired"), HasSubstr("17: paired"));
  const SerialSoftware software(link, B38400);
  EXPECT_THAT(port.said("38400 baud"), HasSubstr("the program sets 38400 baud, 2 stop bits"));
}

TEST_F(Port, AFormatThatCannotBeCarriedIsAFaultOfTheCommandLine) {
  start();
  Process unknown(FIELDCAST_PORT, arguments({"--line", "7X3"}));
  EXPECT_EQ(unknown.exit_code(), 2);
  EXPECT_THAT(unknown.output(), HasSubstr("--line '7X3' is no format such as 8N1"));
  Process markers(FIELDCAST_PORT, arguments({"--line", "7E2", "--markers"}));
  EXPECT_EQ(markers.exit_code(), 2);
  EXPECT_THAT(markers.output(), HasSubstr("marker frames only"));
}

TEST_F(Port, APasswordThatOthersMayReadIsNotUsed) {
  start();
  std::ofstream(folder / "password") << "secret\n";
  std::filesystem::permissions(folder / "password", std::filesystem::perms::owner_read |
                                                        std::filesystem::perms::others_read);
  Process port(FIELDCAST_PORT,
               arguments({"--user", "anna", "--password-file", folder / "password"}));
  EXPECT_EQ(port.exit_code(), 2);
  EXPECT_THAT(port.output(), HasSubstr("chmod 600"));
}

}  // namespace
}  // namespace fieldcast::test
