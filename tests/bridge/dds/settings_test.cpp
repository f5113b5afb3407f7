#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <atomic>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "bridge/dds/library/fastdds.hpp"
#include "bridge/dds/library/library.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast::testing {
namespace {

class TextFile {
 public:
  explicit TextFile(const std::string& text) {
    static int count = 0;
    path_ =
        std::filesystem::temp_directory_path() /
        ("fieldcast-profile-" + std::to_string(getpid()) + "-" + std::to_string(++count) + ".xml");
    std::ofstream(path_) << text;
  }
  ~TextFile() { std::filesystem::remove(path_); }
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

std::string participant_profile(const std::string& name, const std::string& rtps_elements) {
  return R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles"><profiles>
<participant profile_name=")" +
         name + R"("><rtps>)" + rtps_elements + "</rtps></participant></profiles></dds>";
}

class Discoveries : public DiscoveryListener {
 public:
  explicit Discoveries(const DdsSpec& spec) : domain_(spec, "looker", this) {}
  [[nodiscard]] std::string user_data_of(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    const auto found = seen_.find(name);
    return found == seen_.end() ? "" : found->second;
  }

  [[nodiscard]] DdsDuration lease_of(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    const auto found = leases_.find(name);
    return found == leases_.end() ? DdsDuration() : found->second;
  }

  [[nodiscard]] bool is_written(const std::string& topic) const {
    const std::lock_guard lock(mutex_);
    return topics_.contains(topic);
  }

 private:
  void on_writer(const FoundWriter& writer) override {
    const std::lock_guard lock(mutex_);
    topics_.insert(writer.topic);
  }
  void on_participant(const FoundParticipant& participant) override {
    const std::lock_guard lock(mutex_);
    leases_[participant.name] = participant.lease;
    seen_[participant.name] = participant.user_data;
  }
  mutable std::mutex mutex_;
  std::map<std::string, std::string> seen_;
  std::map<std::string, DdsDuration> leases_;
  std::set<std::string> topics_;
  Domain domain_;
};

std::string error_of(const DdsSpec& spec) {
  Received received;
  try {
    DdsLink link(spec, "test", received.handlers());
  } catch (const DdsError& error) { return error.what(); }
  return "no error";
}

// Must run before the next test: the library keeps a profile until its process ends.
TEST(DdsSettings, ProfileThatCannotBeUsedIsAnErrorThatNamesIt) {
  DdsSpec spec = loopback();
  spec.profile = "/nonexistent/dds.xml";
  EXPECT_EQ(error_of(spec), "dds: cannot read the profile file /nonexistent/dds.xml");

  const TextFile garbage("<dds><profiles><participant");
  spec.profile = garbage.path();
  EXPECT_EQ(error_of(spec), "dds: cannot read the profile file " + garbage.path());

  const TextFile other(participant_profile("somebody-else", "<name>x</name>"));
  spec.profile = other.path();
  EXPECT_EQ(error_of(spec), "dds: " + other.path() + " has no participant profile 'fieldcast'");
}

TEST(DdsSettings, TheLoopbackIsAlwaysAmongTheInterfaces) {
  DdsSpec spec;
  using Addresses = std::vector<std::string>;
  EXPECT_EQ(used_interfaces(spec), Addresses{"127.0.0.1"});
  spec.interfaces = {"10.0.0.7"};
  EXPECT_EQ(used_interfaces(spec), (Addresses{"10.0.0.7", "127.0.0.1"}));
  spec.interfaces = {"127.0.0.1", "10.0.0.7"};
  EXPECT_EQ(used_interfaces(spec), spec.interfaces);
}

TEST(DdsSettings, ParticipantOfTheUsersProfileIsUsedWithLeaseAndNameOfOurs) {
  const TextFile file(participant_profile(
      "fieldcast",
      "<userData><value>0x68.0x69</value></userData><builtin><discovery_config><leaseDuration>"
      "<sec>77</sec></leaseDuration></discovery_config></builtin>"));
  const std::string name = bus_name("profiled");
  Discoveries discoveries(loopback());
  DdsSpec spec = loopback();
  spec.profile = file.path();
  Received received;
  DdsLink link(spec, name, received.handlers());
  EXPECT_TRUE(eventually([&] {
    return discoveries.user_data_of("fieldcast-bridge " + name) == "hi";
  })) << "its user data is '"
      << discoveries.user_data_of("fieldcast-bridge " + name) << "'";
  EXPECT_EQ(discoveries.lease_of("fieldcast-bridge " + name), DdsDuration(10, 0));
}

// A discovery server as started by `fast-discovery-server -i 0 -l 127.0.0.1 -p PORT`.
class Server {
 public:
  Server() {
    prepare_library();
    dds::DomainParticipantQos qos;
    qos.name() = "server";
    auto udp = std::make_shared<rtps_transport::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList = {"127.0.0.1"};
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(udp);
    qos.wire_protocol().builtin.discovery_config.discoveryProtocol = DiscoveryProtocol::SERVER;
    qos.wire_protocol().prefix = server_prefix(0);
    rtps::Locator_t locator(LOCATOR_KIND_UDPv4, port_);
    rtps::IPLocator::setIPv4(locator, "127.0.0.1");
    qos.wire_protocol().builtin.metatrafficUnicastLocatorList.push_back(locator);
    participant_ = factory_->create_participant(loopback().domain, qos);
  }
  ~Server() { factory_->delete_participant(participant_); }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] bool runs() const { return participant_ != nullptr; }
  [[nodiscard]] std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

 private:
  static std::uint16_t free_udp_port() {
    const int fd = socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(fd, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size), 0);
    close(fd);
    return ntohs(address.sin_port);
  }
  const std::uint16_t port_ = free_udp_port();
  dds::DomainParticipantFactory* const factory_ = dds::DomainParticipantFactory::get_instance();
  dds::DomainParticipant* participant_ = nullptr;
};

TEST(DdsSettings, DiscoveryServerBringsBridgeAndStationTogether) {
  const Server server;
  ASSERT_TRUE(server.runs());
  DdsSpec spec = loopback();
  spec.discovery_servers = {server.address()};
  const std::string bus = bus_name("served");
  Obedient bridge(bus, 20, spec);
  std::vector<Sample> samples;
  for (ChannelIndex i = 0; i < 20; ++i) samples.push_back(good(i, static_cast<double>(i)));
  bridge.link.publish(bus, samples, both_clocks());

  Collected<StationSample> seen;
  Station station(spec, "client");
  station.subscribe_samples([&](const StationSample& sample) {
    if (sample.bus == bus) seen.add(sample);
  });
  EXPECT_TRUE(eventually([&] { return seen.size() == 20; })) << seen.size() << " of 20 samples";
  const auto result = station.execute(write_running(bus), std::chrono::seconds{10});
  EXPECT_TRUE(result) << to_text(result.error());
}

TEST(DdsSettings, WithoutItsServerAClientFindsNobody) {
  DdsSpec spec = loopback();
  {
    const Server gone;
    spec.discovery_servers = {gone.address()};
  }
  const std::string bus = bus_name("unserved");
  Received received;
  DdsLink link(spec, "test", received.handlers());
  link.add_bus(bus_of(bus, 1));
  link.publish(bus, std::vector<Sample>{good(0, 1.0)}, both_clocks());
  // Serves as the clock: a pair without a server has discovered each other meanwhile.
  DdsLink open(loopback(), "open", received.handlers());
  open.add_bus(bus_of(bus + "-open", 1));
  open.publish(bus + "-open", std::vector<Sample>{good(0, 1.0)}, both_clocks());
  Collected<StationSample> unseen, seen;
  Station client(spec, "client"), plain(loopback(), "plain");
  client.subscribe_samples([&](const StationSample& sample) { unseen.add(sample); });
  plain.subscribe_samples([&](const StationSample& sample) { seen.add(sample); });
  EXPECT_TRUE(eventually([&] { return seen.size() >= 1; }));
  EXPECT_EQ(unseen.size(), 0u);
}

TEST(DdsSettings, DiscoveryServerThatIsNotAnAddressIsAnError) {
  DdsSpec spec = loopback();
  for (const char* server :
       {"somewhere", "127.0.0.1:", "127.0.0.1:0", "127.0.0.1:65536", "127.0.0.1:12x"}) {
    spec.discovery_servers = {server};
    EXPECT_EQ(error_of(spec),
              "dds: discovery server '" + std::string(server) + "' is not host:port");
  }
}

// The library's statistics, enabled by its environment variable.
TEST(DdsSettings, StatisticsOfTheLibraryArePublishedWhenAskedFor) {
  Discoveries discoveries(loopback());
  setenv("FASTDDS_STATISTICS", "HISTORY_LATENCY_TOPIC;PHYSICAL_DATA_TOPIC", 1);
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  unsetenv("FASTDDS_STATISTICS");
  for (const char* topic :
       {"_fastdds_statistics_history2history_latency", "_fastdds_statistics_physical_data"}) {
    EXPECT_TRUE(eventually([&] { return discoveries.is_written(topic); })) << topic;
  }
}

// 20 exchanges of 1 000 channels are 20 messages of 30 kB, which need over a second at 500 kB/s.
TEST(DdsSettings, MaxRateHoldsAndNoSampleIsLost) {
  constexpr std::size_t kChannels = 1000;
  constexpr std::uint64_t kRounds = 20;
  DdsSpec bounded = loopback();
  bounded.max_rate = 500'000;
  const std::string bus = bus_name("bounded");
  Obedient bridge(bus, kChannels, bounded);
  std::atomic<std::size_t> samples = 0, last = 0;
  Station station(loopback(), "reader");
  station.subscribe_samples([&](const StationSample& sample) {
    if (sample.bus != bus) return;
    ++samples;
    if (sample.sequence == kRounds) ++last;
  });
  const auto publish = [&](std::uint64_t round) {
    std::vector<Sample> all;
    for (ChannelIndex i = 0; i < kChannels; ++i) all.push_back(good(i, 0.5, round));
    bridge.link.publish(bus, all, both_clocks());
  };
  publish(1);
  ASSERT_TRUE(eventually([&] { return samples >= kChannels; }));
  const auto began = std::chrono::steady_clock::now();
  for (std::uint64_t round = 2; round <= kRounds; ++round) publish(round);
  // A command result does not wait for all samples.
  EXPECT_TRUE(station.execute(write_running(bus)));
  const auto answered = std::chrono::steady_clock::now();
  ASSERT_TRUE(eventually([&] { return last >= kChannels; }));
  const auto ended = std::chrono::steady_clock::now();
  EXPECT_GE(samples, kRounds * kChannels);
  EXPECT_GT(ended - began, std::chrono::milliseconds{800});
  EXPECT_LT(answered, ended);
}

TEST(DdsSettings, PartitionHoldsForCommandsToo) {
  const std::string bus = bus_name("walled");
  DdsSpec inside = loopback(), beside = loopback();
  inside.partition = "plant-a";
  beside.partition = "plant-b";
  Obedient bridge(bus, 1, inside);
  Station stranger(beside, "stranger"), member(inside, "member");
  EXPECT_TRUE(member.execute(write_running(bus)));
  const auto refused = stranger.execute(write_running(bus), std::chrono::milliseconds{300});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), StationFault::kNoBridge);
  EXPECT_EQ(bridge.received.commands.size(), 1u);
}

}  // namespace
}  // namespace fieldcast::testing
