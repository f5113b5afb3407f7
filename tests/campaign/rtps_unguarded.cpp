// Runs one known attack (known_attacks.hpp) against a participant of the packaged DDS library
// without the guard, to show which attacks do harm. The harm is limited to this process, which may
// use 2 GB of memory and 10 s of processor time.
//
// usage: rtps_unguarded NUMBER    the attack with this number; without one, lists them
//
// Exits with 0 if the participant still receives samples, else with 1. If the attack kills the
// process, a signal ends it.
#include <sys/resource.h>

#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>

#include "bridge/dds/library/library.hpp"
#include "tests/bridge/dds/transport/known_attacks.hpp"
#include "tests/campaign/attacked_domain.hpp"

namespace fieldcast {
namespace {

using testing::Datagram;

constexpr std::uint32_t kDomain = 98;

struct Unguarded {
  Unguarded() {
    dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
    qos.transport().use_builtin_transports = false;
    auto udp = std::make_shared<rtps_transport::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList = {"127.0.0.1"};
    qos.transport().user_transports.push_back(udp);
    participant = dds::DomainParticipantFactory::get_instance()->create_participant(kDomain, qos);
    const dds::TypeSupport type(new TopicType<idl::SamplePubSubType>());
    type.register_type(participant, type_name(kSampleTopic));
    topic = participant->create_topic(kSampleTopic.name, type_name(kSampleTopic),
                                      dds::TOPIC_QOS_DEFAULT);
  }
  dds::DomainParticipant* participant = nullptr;
  dds::Topic* topic = nullptr;
};

int attack(const testing::Attack& by) {
  Unguarded victim, forged;
  dds::DataReader* reader = victim.participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT)
                                ->create_datareader(victim.topic, reader_qos(kSampleTopic));
  dds::DataWriter* writer = forged.participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT)
                                ->create_datawriter(forged.topic, writer_qos(kSampleTopic));
  std::uint64_t written = 0;
  const auto arrives = [&] {
    idl::Sample sample;
    const std::string name = "c" + std::to_string(++written);
    sample.channel(name);
    writer->write(&sample);
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds{10};
    while (std::chrono::steady_clock::now() < end) {
      idl::Sample received;
      dds::SampleInfo info;
      while (reader->take_next_sample(&received, &info) == ReturnCode_t::RETCODE_OK)
        if (info.valid_data && std::string(received.channel()) == name) return true;
      reader->wait_for_unread_message({0, 20'000'000});
    }
    return false;
  };
  if (!arrives()) return std::fprintf(stderr, "no discovery within 10 s\n"), 2;
  const double before = testing::resident_megabytes();
  ParticipantPrefix sender{};
  std::copy_n(writer->guid().guidPrefix.value, sender.size(), sender.begin());
  const Datagram one =
      testing::in_name_of(sender, testing::AttackedDomain::entity(writer->guid()),
                          testing::AttackedDomain::entity(reader->guid()), by.datagram);
  const FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  for (const bool to_discovery : {true, false})
    testing::send_to(*reader, socket.get(), one, to_discovery);
  const bool receives = arrives();
  std::printf("%s, %.0f MB more\n", receives ? "receives" : "receives no more",
              testing::resident_megabytes() - before);
  std::fflush(stdout);
  std::_Exit(receives ? 0 : 1);  // the library may not be able to leave the domain
}

int run(int argc, char** argv) {
  const auto all = testing::known_attacks();
  if (argc != 2) {
    for (std::size_t i = 0; i < all.size(); ++i) std::printf("%zu %s\n", i, all[i].name);
    return 0;
  }
  const std::size_t number = std::strtoul(argv[1], nullptr, 10);
  if (number >= all.size()) return 2;
  const rlimit memory{rlim_t{2} << 30, rlim_t{2} << 30}, seconds{10, 10}, none{0, 0};
  ::setrlimit(RLIMIT_AS, &memory);
  ::setrlimit(RLIMIT_CPU, &seconds);
  ::setrlimit(RLIMIT_CORE, &none);
  prepare_library();
  return attack(all[number]);
}

}  // namespace
}  // namespace fieldcast

int main(int argc, char** argv) { return fieldcast::run(argc, argv); }
