// Compares the QoS profiles for stations on Fast DDS with those of the bridge's own stations.
#include <gtest/gtest.h>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <map>
#include <set>

#include "bridge/dds/library/library.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/topics.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast::testing {
namespace {

using namespace std::chrono_literals;

template <class Qos>
void expect_same(const Qos& profile, const Qos& ours) {
  EXPECT_EQ(profile.durability(), ours.durability());
  EXPECT_EQ(profile.reliability().kind, ours.reliability().kind);
  EXPECT_EQ(profile.history(), ours.history());
  EXPECT_EQ(profile.resource_limits(), ours.resource_limits());
  EXPECT_EQ(profile.deadline(), ours.deadline());
  EXPECT_EQ(profile.liveliness(), ours.liveliness());
  EXPECT_EQ(profile.lifespan(), ours.lifespan());
  EXPECT_EQ(profile.endpoint().history_memory_policy, ours.endpoint().history_memory_policy);
  EXPECT_EQ(profile.data_sharing().kind(), ours.data_sharing().kind());
}

class Profiles : public ::testing::Test {
 protected:
  void SetUp() override {
    prepare_library();
    ASSERT_EQ(factory_->load_XML_profiles_file(FIELDCAST_PROFILES "/fieldcast-station.xml"),
              ReturnCode_t::RETCODE_OK);
    participant_ =
        factory_->create_participant_with_profile(loopback().domain, "fieldcast-station");
    ASSERT_NE(participant_, nullptr);
    subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
    publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  }
  void TearDown() override {
    if (participant_ == nullptr) return;
    participant_->delete_contained_entities();
    factory_->delete_participant(participant_);
  }
  template <class Generated>
  dds::Topic* topic(const char* name, const char* type) {
    dds::TypeSupport(new Generated()).register_type(participant_, type);
    return participant_->create_topic(name, type, dds::TOPIC_QOS_DEFAULT);
  }
  dds::DataReader* reader(dds::Topic* topic) {
    return subscriber_->create_datareader_with_profile(
        topic, topic->get_name());  // profiles are named after their topics
  }

  dds::DomainParticipantFactory* factory_ = dds::DomainParticipantFactory::get_instance();
  dds::DomainParticipant* participant_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;
  dds::Publisher* publisher_ = nullptr;
};

TEST_F(Profiles, SayWhatTheBridgesOwnStationsUse) {
  const std::map<std::string, dds::DataWriterQos> written = {
      {kCommandTopic.name, command_writer_qos(5s)},
      {kAlarmActionTopic.name, alarm_action_writer_qos(5s)},
      {kInterestTopic.name, writer_qos(kInterestTopic)},
      {kSnapshotRequestTopic.name, writer_qos(kSnapshotRequestTopic)},
      {kHistoryRequestTopic.name, writer_qos(kHistoryRequestTopic)},
      {kConfigurationRequestTopic.name, writer_qos(kConfigurationRequestTopic)}};
  for (const TopicRow* topic : kTopics) {
    SCOPED_TRACE(topic->name);
    if (topic == &kBridgeTopic || topic == &kStandbyTopic || topic == &kStandbyNoteTopic ||
        topic == &kStandbyRequestTopic)
      continue;  // used between bridges only
    if (const auto ours = written.find(topic->name); ours != written.end()) {
      dds::DataWriterQos profile;
      ASSERT_EQ(publisher_->get_datawriter_qos_from_profile(topic->name, profile),
                ReturnCode_t::RETCODE_OK);
      expect_same(profile, ours->second);
      EXPECT_EQ(profile.publish_mode().kind, ours->second.publish_mode().kind);
    } else {
      dds::DataReaderQos profile;
      ASSERT_EQ(subscriber_->get_datareader_qos_from_profile(topic->name, profile),
                ReturnCode_t::RETCODE_OK);
      expect_same(profile, reader_qos(*topic));
    }
  }
}

TEST_F(Profiles, EveryChannelOf300Arrives) {
  const std::string bus = bus_name("profile");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus, 300));
  std::vector<Sample> samples;
  for (ChannelIndex i = 0; i < 300; ++i) samples.push_back(good(i, static_cast<double>(i)));
  link.publish(bus, samples, both_clocks());

  dds::DataReader* values =
      reader(topic<idl::SamplePubSubType>("fieldcast/Sample", "fieldcast::Sample"));
  dds::DataReader* catalogue =
      reader(topic<idl::ChannelPubSubType>("fieldcast/Channel", "fieldcast::Channel"));
  ASSERT_NE(values, nullptr);
  ASSERT_NE(catalogue, nullptr);
  std::set<std::string> seen, listed;
  const bool all = eventually([&] {
    idl::Sample sample;
    idl::Channel entry;
    dds::SampleInfo info;
    while (values->take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data && bus == sample.bus().c_str()) seen.insert(sample.channel().c_str());
    }
    while (catalogue->take_next_sample(&entry, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data && bus == entry.bus().c_str()) listed.insert(entry.channel().c_str());
    }
    return seen.size() == 300 && listed.size() == 300;
  });
  EXPECT_TRUE(all) << seen.size() << " values and " << listed.size() << " catalogue entries of 300";
}

TEST_F(Profiles, ACommandGetsItsResult) {
  const std::string bus = bus_name("profile-command");
  Obedient bridge(bus);

  dds::DataReader* results = reader(
      topic<idl::CommandResultPubSubType>("fieldcast/CommandResult", "fieldcast::CommandResult"));
  dds::Topic* commands = topic<idl::CommandPubSubType>("fieldcast/Command", "fieldcast::Command");
  dds::DataWriter* writer =
      publisher_->create_datawriter_with_profile(commands, commands->get_name());
  ASSERT_NE(results, nullptr);
  ASSERT_NE(writer, nullptr);
  ASSERT_TRUE(eventually([&] {
    dds::PublicationMatchedStatus writer_status;
    dds::SubscriptionMatchedStatus reader_status;
    writer->get_publication_matched_status(writer_status);
    results->get_subscription_matched_status(reader_status);
    return writer_status.current_count > 0 && reader_status.current_count > 0;
  })) << "no bridge was found";
  idl::Command command;
  command.requester() = bus;  // unique for each process
  command.request_id(7);
  command.bus() = bus;
  command.device() = "d";
  command.target() = "c0";
  idl::Value value;
  value.int64_value(1);
  command.values().push_back(value);
  ASSERT_TRUE(is_taken(writer->write(&command)));
  writer->unregister_instance(&command, dds::HANDLE_NIL);

  idl::CommandResult result;
  EXPECT_TRUE(eventually([&] {
    dds::SampleInfo info;
    while (results->take_next_sample(&result, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data && bus == result.requester().c_str() && result.request_id() == 7)
        return true;
    }
    return false;
  })) << "no result";
  EXPECT_EQ(result.state(), idl::CommandState::DONE);
}

}  // namespace
}  // namespace fieldcast::testing
