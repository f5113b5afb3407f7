#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>

#include "bridge/dds/library/library.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/topic_type.hpp"
#include "bridge/dds/topics/topics.hpp"
#include "tests/bridge/dds/dds_support.hpp"
#include "tests/bridge/support/role.hpp"

namespace fieldcast::testing {
namespace {

using namespace std::chrono_literals;

constexpr const char* kDomainOfStation = "FIELDCAST_TEST_STATION_DOMAIN";
constexpr const char* kPattern = "patient/*/*";
constexpr int kRounds = 30;

// A foreign station with an interest. The next test stops its process; its lease is a minute.
void play_patient_station() {
  prepare_library();
  auto* factory = dds::DomainParticipantFactory::get_instance();
  dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
  qos.wire_protocol().builtin.discovery_config.leaseDuration = {60, 0};
  qos.transport().use_builtin_transports = false;
  auto udp = std::make_shared<rtps_transport::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = {"127.0.0.1"};
  qos.transport().user_transports.push_back(udp);
  auto* participant = factory->create_participant(
      static_cast<std::uint32_t>(std::atoi(std::getenv(kDomainOfStation))), qos);
  ASSERT_NE(participant, nullptr);
  dds::TypeSupport type(new TopicType<idl::InterestPubSubType>());
  type.register_type(participant, "fieldcast::Interest");
  auto* topic =
      participant->create_topic(kInterestTopic.name, "fieldcast::Interest", dds::TOPIC_QOS_DEFAULT);
  auto* writer = participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT)
                     ->create_datawriter(topic, writer_qos(kInterestTopic));
  idl::Interest interest;
  interest.station() = "patient";
  interest.pattern() = kPattern;
  for (int seconds = 1; seconds <= kRounds; ++seconds) {
    interest.refresh(1'000'000'000LL * seconds);
    ASSERT_TRUE(is_taken(writer->write(&interest)));
    std::this_thread::sleep_for(100ms);
  }
  ::pause();
}
const auto* const kPatientStation = test::Role::add("patient-station", play_patient_station);

TEST(DdsLease, AnInterestEndsWithItsWritersLeaseAndStandsAgainWithIt) {
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  const auto stands = [&] {
    std::optional<Duration> last;
    for (const Interest& interest : received.interests.all()) {
      if (interest.pattern == kPattern) last = interest.refresh;
    }
    return last == std::chrono::seconds{kRounds};
  };
  ASSERT_EQ(::setenv(kDomainOfStation, std::to_string(loopback().domain).c_str(), 1), 0);
  const test::Process station = test::play("patient-station");
  ASSERT_TRUE(eventually(stands));
  station.signal(SIGSTOP);
  EXPECT_TRUE(eventually([&] { return !stands(); }))
      << "10 s are more than its lease of 6, and less than the minute of its participant";
  station.signal(SIGCONT);
  EXPECT_TRUE(eventually(stands));
}

// Each `fieldcast watch --refresh` is a station of one name.
TEST(DdsLease, AnInterestStandsWhenAnotherStationOfItsNameEnds) {
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  const auto shortest = [&] {
    std::map<std::string, Duration> by_station;
    for (const Interest& interest : received.interests.all()) {
      if (interest.pattern != "wall/*/*") continue;
      by_station.erase(interest.station);
      if (interest.refresh) by_station.emplace(interest.station, *interest.refresh);
    }
    Duration least{};
    for (const auto& [station, refresh] : by_station)
      least = least == Duration{} ? refresh : std::min(least, refresh);
    return least;
  };
  Station first(loopback(), "panel");
  first.declare_interest("wall/*/*", 5s);
  ASSERT_TRUE(eventually([&] { return shortest() == 5s; }));
  {
    Station second(loopback(), "panel");
    second.declare_interest("wall/*/*", 1s);
    ASSERT_TRUE(eventually([&] { return shortest() == 1s; }));
    second.declare_interest("wall/*/*", 8s);
    EXPECT_TRUE(eventually([&] { return shortest() == 5s; })) << "that of the first one";
  }
  ASSERT_TRUE(eventually([&] { return !received.interests.all().back().refresh; }));
  EXPECT_EQ(shortest(), 5s);
}

// Nothing is published on the bus: it is on demand now, and only its status continues.
TEST(DdsLease, AStationThatAsksForADeadlineMissesNothingOnceNobodyIsInterestedInTheChannel) {
  const std::string bus = bus_name("interesting");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus, 2, [](std::size_t) { return 60s; }));
  std::atomic<int> misses{0};
  Collected<StationSample> samples;
  Collected<std::string> gone;
  Station demanding(loopback(), "demanding");
  demanding.subscribe_samples(
      [&](const StationSample& sample) { samples.add(sample); },
      [&](const std::string&, const std::string&, const std::string& name) { gone.add(name); },
      {.deadline = 100ms, .on_deadline_missed = [&](auto&&...) { ++misses; }});
  link.set_refresh(bus, 0, 50ms);
  std::uint64_t sequence = 0;
  ASSERT_TRUE(eventually([&] {
    link.publish(bus, std::vector{good(0, 1.0, ++sequence)}, both_clocks());
    return samples.size() >= 3;
  }));
  link.set_refresh(bus, 0, 60s);
  const auto reports_for = [&](Duration time) {
    const Instant end = both_clocks().instant + time;
    while (both_clocks().instant < end) {
      link.report(bus, BusReport{}, both_clocks().utc);
      std::this_thread::sleep_for(10ms);
    }
  };
  ASSERT_TRUE(eventually([&] {
    link.report(bus, BusReport{}, both_clocks().utc);
    return gone.size() == 1;
  })) << "the writer of the interest is still there";
  const int then = misses;
  reports_for(1s);
  EXPECT_EQ(misses, then);
}

}  // namespace
}  // namespace fieldcast::testing
