#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tools/cli/command/plan.hpp"
#include "tools/cli/doctor/findings.hpp"
#include "tools/cli/doctor/gather.hpp"
#include "tools/cli/view/check_view.hpp"

namespace fieldcast::cli {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Finding only(const MachineFacts& facts) {
  const auto findings = findings_of(facts);
  EXPECT_EQ(findings.size(), 1u);
  return findings.empty() ? Finding{} : findings.front();
}

TEST(DoctorFindings, OfWhatIsNotKnownNothingIsSaid) { EXPECT_THAT(findings_of({}), IsEmpty()); }

TEST(DoctorFindings, ASmallReceiveBufferIsReportedWithItsRemedy) {
  MachineFacts facts;
  facts.receive_buffer_asked = 1 << 20;
  facts.receive_buffer_limit = 212'992;
  const Finding small = only(facts);
  EXPECT_EQ(small.severity, Severity::kAdvice);
  EXPECT_EQ(small.where, "net.core.rmem_max");
  EXPECT_THAT(small.what, HasSubstr("208 KiB for a socket, 1024 KiB are asked for"));
  EXPECT_THAT(small.remedy, HasSubstr("sysctl -w net.core.rmem_max=1048576"));
  facts.receive_buffer_limit = 1 << 20;
  EXPECT_EQ(only(facts).severity, Severity::kOk);
}

TEST(DoctorFindings, AnAdapterThatHoldsResponsesBackIsReportedWithItsFile) {
  MachineFacts facts;
  facts.adapters = {{"ttyUSB0", "ftdi_sio", 16, "/sys/x/latency_timer"}};
  const Finding slow = only(facts);
  EXPECT_EQ(slow.severity, Severity::kAdvice);
  EXPECT_THAT(slow.what, HasSubstr("ftdi_sio, 16 ms"));
  EXPECT_EQ(slow.remedy, "echo 1 > /sys/x/latency_timer");
  facts.adapters = {{"ttyUSB0", "ftdi_sio", 1, "/sys/x/latency_timer"}};
  EXPECT_EQ(only(facts).severity, Severity::kOk);
  facts.adapters = {{"ttyUSB1", "ch341-uart", std::nullopt, ""}};
  EXPECT_EQ(only(facts),
            (Finding{Severity::kOk, "latency timer", "ttyUSB1", "ch341-uart, which has none", ""}));
}

TEST(DoctorFindings, AClockThatDiffersFromTheClockOfABridgeIsNamedWithBoth) {
  MachineFacts facts;
  const UtcTime here{1'763'833'200'000'000'000};
  facts.clocks = {{"line-7", std::chrono::milliseconds{3}, here}};
  EXPECT_EQ(only(facts),
            (Finding{Severity::kOk, "clock", "bridge line-7",
                     "this machine's clock and that of bridge line-7 differ by 0.003 s", ""}));
  facts.clocks = {{"line-7", -std::chrono::milliseconds{10'250}, here}};
  const Finding behind = only(facts);
  EXPECT_EQ(behind.severity, Severity::kAdvice);
  EXPECT_EQ(behind.what,
            "this machine's clock is 10.2 s behind the clock of bridge line-7: ages of samples are "
            "too small, and commands expire early; synchronize both with NTP (here "
            "2025-11-22T17:40:00.000Z, there 2025-11-22T17:40:10.250Z)");
  EXPECT_THAT(behind.remedy, HasSubstr("timedatectl set-ntp true on both machines"));
  facts.clocks = {{"line-7", std::chrono::seconds{5}, here}};
  EXPECT_THAT(only(facts).what, HasSubstr("5.0 s ahead of the clock of bridge line-7"));
}

TEST(DoctorFindings, APortThatIsMissingOrForbiddenPreventsItsBus) {
  MachineFacts facts;
  facts.ports = {{"press-shop", "/dev/ttyUSB0", false, false, ""}};
  EXPECT_EQ(only(facts).severity, Severity::kPrevents);
  EXPECT_THAT(only(facts).what, HasSubstr("bus press-shop has no such port"));
  facts.ports = {{"press-shop", "/dev/ttyUSB0", true, false, "uucp"}};
  EXPECT_EQ(only(facts).severity, Severity::kPrevents);
  EXPECT_THAT(only(facts).remedy, HasSubstr("usermod -aG uucp"));
  facts.ports = {{"press-shop", "/dev/ttyUSB0", true, true, "dialout"}};
  EXPECT_EQ(only(facts).severity, Severity::kOk);
}

TEST(DoctorFindings, AClockThatNobodySetsIsAdvice) {
  MachineFacts facts;
  facts.clock_synchronised = false;
  EXPECT_EQ(only(facts).severity, Severity::kAdvice);
  facts.clock_synchronised = true;
  EXPECT_EQ(only(facts).severity, Severity::kOk);
}

TEST(DoctorFindings, DiscoveryNeedsMulticastOrAServer) {
  MachineFacts facts;
  facts.interfaces = {{"10.0.0.7", "wg0", false, false}};
  EXPECT_EQ(only(facts).severity, Severity::kPrevents);
  EXPECT_THAT(only(facts).remedy, HasSubstr("discovery-server"));
  facts.discovery_server = true;
  EXPECT_EQ(only(facts).severity, Severity::kOk);
  facts.discovery_server = false;
  facts.interfaces = {{"127.0.0.1", "lo", true, true}};
  EXPECT_EQ(only(facts).severity, Severity::kOk);
  facts.interfaces = {{"127.0.0.1", "lo", false, true}};
  EXPECT_EQ(only(facts).severity, Severity::kPrevents);
  EXPECT_EQ(only(facts).remedy, "dds: discovery-server: HOST:PORT");
  facts.interfaces = {{"10.0.0.8", "", false, false}};
  EXPECT_THAT(only(facts).what, HasSubstr("no interface of this machine"));
}

TEST(DoctorFindings, ADiskThatIsNearlyFullIsAdviceAndAFullOnePrevents) {
  MachineFacts facts;
  facts.disk = DiskFacts{"line-7.db", "/data", true, 5'000'000'000};
  EXPECT_EQ(only(facts).severity, Severity::kOk);
  facts.disk->free_bytes = 900'000'000;
  EXPECT_EQ(only(facts).severity, Severity::kAdvice);
  facts.disk->free_bytes = 1'000'000;
  EXPECT_EQ(only(facts).severity, Severity::kPrevents);
}

TEST(DoctorFindings, AStoreWithoutItsFolderPrevents) {
  MachineFacts facts;
  facts.disk = DiskFacts{"/data/line-7.db", "/data", false, 0};
  const Finding missing = only(facts);
  EXPECT_EQ(missing.severity, Severity::kPrevents);
  EXPECT_THAT(missing.remedy, HasSubstr("mkdir -p /data"));
}

TEST(DoctorFindings, AProfileWithFewerInstancesThanChannelsPrevents) {
  MachineFacts facts;
  facts.channels = 100;
  facts.profile_limits = {{"fieldcast/Sample", 10}, {"fieldcast/SampleBlock", 1}};
  const Finding few = only(facts);
  EXPECT_EQ(few.severity, Severity::kPrevents);
  EXPECT_THAT(few.what, HasSubstr("max_instances 10 for 100 channels"));
  facts.profile_limits = {{"fieldcast/Channel", 100}};
  EXPECT_EQ(only(facts).severity, Severity::kOk);
  facts.profile_limits = {{"fieldcast/Channel", 0}};
  EXPECT_EQ(only(facts).severity, Severity::kOk) << "no limit";
}

TEST(DoctorView, ARemedyStandsBelowItsFinding) {
  EXPECT_THAT(doctor_lines({{Severity::kOk, "clock", "", "synchronised", ""},
                            {Severity::kPrevents, "serial port", "/dev/a", "forbidden", "do it"}},
                           {}),
              ElementsAre("ok        clock: synchronised",
                          "prevents  serial port (/dev/a): forbidden", "          -> do it"));
}

class Machine {
 public:
  Machine() { fs::create_directories(root_); }
  ~Machine() { fs::remove_all(root_); }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  [[nodiscard]] std::string root() const { return root_; }
  std::string write(const std::string& path, const std::string& text) {
    const fs::path file = root_ / path;
    fs::create_directories(file.parent_path());
    std::ofstream(file) << text;
    return file;
  }
  void adapter(const std::string& name, const std::string& driver) {
    const fs::path folder = root_ / "sys/bus/usb-serial/devices" / name;
    fs::create_directories(folder);
    fs::create_symlink("../../drivers/" + driver, folder / "driver");
  }

 private:
  const fs::path root_ =
      fs::temp_directory_path() / ("fieldcast-doctor-" + std::to_string(getpid()));
};

struct Said {
  ExitCode code;
  std::string out, err;
};
Said doctor(const DoctorOptions& options) {
  std::istringstream in;
  std::ostringstream out, err;
  const ExitCode code = cli::doctor(options, Streams{in, out, err});
  return {code, out.str(), err.str()};
}

std::string plant_text(const std::string& port, const std::string& dds = "domain: 0") {
  return "bridge: b\ndds: { " + dds + " }\nbuses:\n  - name: line\n    port: { serial: " + port +
         ", baud: 9600 }\n    protocol: modbus-rtu\n    devices:\n      - name: plc\n"
         "        address: 1\n        channels:\n          - { name: a, at: \"holding:1\", type: "
         "int16 }\n"
         "          - { name: b, at: \"holding:2\", type: int16 }\n";
}

TEST(Doctor, ReadsTheMachineBelowItsRoot) {
  Machine machine;
  machine.write("proc/sys/net/core/rmem_max", "212992\n");
  machine.adapter("ttyUSB0", "ftdi_sio");
  machine.write("sys/bus/usb-serial/devices/ttyUSB0/latency_timer", "16\n");
  machine.adapter("ttyUSB1", "ch341-uart");
  machine.write("run/systemd/timesync/synchronized", "");
  const Said said = doctor({.root = machine.root()});
  EXPECT_EQ(said.code, ExitCode::kOk) << "advice prevents nothing";
  EXPECT_THAT(said.out, HasSubstr("advice    receive buffer (net.core.rmem_max): 208 KiB"));
  EXPECT_THAT(said.out, HasSubstr("advice    latency timer (ttyUSB0): ftdi_sio, 16 ms"));
  EXPECT_THAT(said.out, HasSubstr("ok        latency timer (ttyUSB1): ch341-uart"));
  EXPECT_THAT(said.out, HasSubstr("ok        clock: synchronised"));
}

TEST(Doctor, LooksAtThePortsOfTheConfiguration) {
  Machine machine;
  const std::string config = machine.write("plant.yaml", plant_text("/dev/ttyUSB0"));
  const Said missing = doctor({.config = config, .root = machine.root()});
  EXPECT_EQ(missing.code, ExitCode::kFound);
  EXPECT_THAT(missing.out, HasSubstr("prevents  serial port (/dev/ttyUSB0): bus line"));
  machine.write("dev/ttyUSB0", "");
  EXPECT_EQ(doctor({.config = config, .root = machine.root()}).code, ExitCode::kOk);
}

// As with sudo, where the rights of the current user are those of root.
TEST(Doctor, ChecksTheRightsOfTheServicesUser) {
  Machine machine;
  const std::string port = machine.write("dev/ttyUSB0", "");
  const std::string config = machine.write("plant.yaml", plant_text("/dev/ttyUSB0"));
  machine.write("etc/passwd",
                "other:x:64998:64998::/:/bin/sh\nfieldcast:x:64999:64999::/:/bin/sh\n");
  const auto rights = [&](const char* permissions, const std::string& members) {
    fs::permissions(port, static_cast<fs::perms>(std::stoi(permissions, nullptr, 8)));
    machine.write("etc/group", "line:x:" + std::to_string(::getgid()) + ":" + members + "\n");
    return doctor({.config = config, .root = machine.root()});
  };
  const Said refused = rights("660", "other");
  EXPECT_EQ(refused.code, ExitCode::kFound);
  EXPECT_THAT(refused.out, HasSubstr("bus line needs it, and the user fieldcast may not open it"));
  EXPECT_THAT(refused.out, HasSubstr(" fieldcast, the user that runs the bridge"));
  EXPECT_EQ(rights("660", "other,fieldcast").code, ExitCode::kOk);
  EXPECT_EQ(rights("600", "fieldcast").code, ExitCode::kFound);
  EXPECT_EQ(rights("666", "").code, ExitCode::kOk);
}

TEST(Doctor, LooksAtTheProfileOfTheConfiguration) {
  Machine machine;
  machine.write("dev/ttyUSB0", "");
  const auto profile = machine.write("dds.xml",
                                     R"(<?xml version="1.0"?><dds><profiles>
    <participant profile_name="fieldcast"/>
    <data_reader profile_name="fieldcast/Sample"><topic><resourceLimitsQos>
      <max_instances>1</max_instances></resourceLimitsQos></topic></data_reader>
    <data_writer profile_name="fieldcast/Channel"/>
    </profiles></dds>)");
  const std::string config =
      machine.write("plant.yaml", plant_text("/dev/ttyUSB0", "profile: " + profile));
  const Said said = doctor({.config = config, .root = machine.root()});
  EXPECT_EQ(said.code, ExitCode::kFound);
  EXPECT_THAT(said.out, HasSubstr("fieldcast/Sample: max_instances 1 for 2 channels"));
  EXPECT_THAT(said.out, HasSubstr("fieldcast/Channel: max_instances 10 for 2 channels"))
      << "the library's own limit";
}

TEST(Doctor, SaysTheSameAsJsonLines) {
  Machine machine;
  machine.write("proc/sys/net/core/rmem_max", "4194304\n");
  const Said said = doctor({.root = machine.root(), .json = true});
  EXPECT_EQ(said.out,
            "{\"severity\":\"ok\",\"check\":\"receive buffer\",\"where\":\"net.core.rmem_max\","
            "\"what\":\"4096 KiB for a socket, 1024 KiB are asked for\",\"remedy\":\"\"}\n");
}

TEST(Doctor, AFileWithFaultsIsAFaultOfUsage) {
  Machine machine;
  const Said said = doctor({.config = machine.write("plant.yaml", "bridge: 7\n")});
  EXPECT_EQ(said.code, ExitCode::kUsage);
  EXPECT_THAT(said.err, HasSubstr("plant.yaml"));
}

TEST(Doctor, OfThisMachineItKnowsLoopbackAndDisk) {
  BridgeSpec spec;
  spec.store = StoreSpec{.address = fs::temp_directory_path() / "line-7.db"};
  const MachineFacts facts = gather_facts("/", &spec);
  ASSERT_EQ(facts.interfaces.size(), 1u);
  EXPECT_EQ(facts.interfaces[0].address, "127.0.0.1");
  EXPECT_TRUE(facts.interfaces[0].loopback);
  ASSERT_TRUE(facts.disk);
  EXPECT_GT(facts.disk->free_bytes, 0u);
}

TEST(Doctor, SeesThatTheFolderOfTheStoreIsMissing) {
  BridgeSpec spec;
  spec.store = StoreSpec{.address = fs::temp_directory_path() / "no-such-folder" / "line-7.db"};
  const MachineFacts facts = gather_facts("/", &spec);
  ASSERT_TRUE(facts.disk);
  EXPECT_FALSE(facts.disk->folder_there);
}

TEST(Doctor, SeesThatTheFolderOfACaptureIsMissing) {
  BridgeSpec spec;
  spec.buses.emplace_back().name = "line";
  spec.buses.front().capture = CaptureSpec{fs::temp_directory_path() / "no-such-folder"};
  const Finding missing = only({.captures = gather_facts("/", &spec).captures});
  EXPECT_EQ(missing.severity, Severity::kAdvice);
  EXPECT_THAT(missing.what, HasSubstr("bus line: No such file or directory"));
  EXPECT_THAT(missing.remedy, HasSubstr("mkdir"));
}

}  // namespace
}  // namespace fieldcast::cli
