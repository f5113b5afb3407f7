// A writer and a reader of fieldcast/Sample on the bare library, with the QoS of Fieldcast and with
// shared memory, for shared_memory_trial.py. Does not use our Domain, because the library does not
// detect shared memory below a chaining transport.
//
//   shared-memory-trial write DOMAIN memory|udp   until it is ended
//   shared-memory-trial read DOMAIN memory|udp    prints "sample" once, and reads until it is ended
//   shared-memory-trial look DOMAIN memory|udp    prints "sample" once, and leaves the domain
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <string>
#include <thread>

#include "bridge/dds/library/fastdds.hpp"
#include "bridge/dds/library/library.hpp"
#include "bridge/dds/library/shared_memory.hpp"
#include "bridge/dds/topics/topic_type.hpp"
#include "bridge/dds/topics/topics.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

constexpr int kChannels = 100;
constexpr auto kPeriod = 20ms;  // of a burst of all channels

dds::DomainParticipantQos participant_qos(bool shared_memory) {
  dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
  qos.transport().use_builtin_transports = false;
  auto udp = std::make_shared<rtps_transport::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = {"127.0.0.1"};
  qos.transport().user_transports.push_back(udp);
  if (shared_memory)
    qos.transport().user_transports.push_back(
        std::make_shared<rtps_transport::SharedMemTransportDescriptor>());
  return qos;
}

struct Participant {
  Participant(std::uint32_t domain, bool shared_memory) {
    prepare_library();
    participant = factory->create_participant(domain, participant_qos(shared_memory));
    if (participant == nullptr) std::exit(2);
    dds::TypeSupport type(new TopicType<idl::SamplePubSubType>());
    type.register_type(participant, type_name(kSampleTopic));
    topic = participant->create_topic(kSampleTopic.name, type_name(kSampleTopic),
                                      dds::TOPIC_QOS_DEFAULT);
  }
  ~Participant() {
    participant->delete_contained_entities();
    factory->delete_participant(participant);
  }
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  dds::DomainParticipantFactory* const factory = dds::DomainParticipantFactory::get_instance();
  dds::DomainParticipant* participant = nullptr;
  dds::Topic* topic = nullptr;
};

void write_for_ever(Participant& in) {
  auto* publisher = in.participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  auto* writer = publisher->create_datawriter(in.topic, sample_writer_qos(1s));
  idl::Sample sample;
  sample.bus("trial");
  sample.device("plc");
  for (std::uint64_t number = 1;; ++number) {
    for (int i = 0; i < kChannels; ++i) {
      sample.channel("c" + std::to_string(i));
      sample.sequence(number);
      writer->write(&sample);
    }
    std::this_thread::sleep_for(kPeriod);
  }
}

void read(Participant& in, bool leave) {
  auto* subscriber = in.participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  auto* reader = subscriber->create_datareader(in.topic, sample_reader_qos(std::nullopt));
  idl::Sample sample;
  dds::SampleInfo info;
  for (bool told = false;;) {
    reader->wait_for_unread_message({1, 0});
    while (reader->take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK) {
      if (told || !info.valid_data) continue;
      told = true;
      std::puts("sample");
      std::fflush(stdout);
      if (leave) return;
    }
  }
}

}  // namespace
}  // namespace fieldcast

int main(int argc, char** argv) {
  using namespace fieldcast;
  if (argc != 4) return 2;
  const std::string role = argv[1];
  alarm(600);  // the parent process may have ended
  Participant participant(static_cast<std::uint32_t>(std::atoi(argv[2])),
                          std::string_view(argv[3]) == "memory");
  if (role == "write") write_for_ever(participant);
  read(participant, role == "look");
  return 0;
}
