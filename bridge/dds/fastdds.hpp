// What Fast DDS 2.9 and 3.x call differently. All code takes the library's names that differ from
// here; headers of fastdds/dds/ are the same in both and are included where they are needed.
//
// Built and tested with 2.9.1. No package of 3.x exists for Debian 12: a compiler has read this
// branch with the headers of 3.6.2 (g++ -fsyntax-only: this header, fastdds.cpp, library.cpp,
// note_transport.cpp, unregister_note.cpp); it has NOT been linked and NOT been run.
//
// | what                     | 2.9                                 | 3.x                        |
// | ------------------------ | ----------------------------------- | -------------------------- |
// | headers                  | fastrtps/, fastdds/rtps/**/*.h      | fastdds/, *.hpp            |
// | types of RTPS            | eprosima::fastrtps::rtps            | eprosima::fastdds::rtps    |
// | Duration_t, Time_t       | eprosima::fastrtps                  | eprosima::fastdds::dds     |
// | ReturnCode_t             | a class that holds its values       | an integer, values beside  |
// | DataWriter::write        | true: taken                         | RETCODE_OK, which is 0     |
// | times of a writer        | heartbeatPeriod                     | heartbeat_period           |
// | discovery, listener      | on_publisher_discovery(info)        | on_data_writer_discovery   |
// | discovery, servers       | RemoteServerAttributes              | locators alone             |
// | settings of the process  | XMLProfileManager                   | DomainParticipantFactory   |
// | ChainingTransport::send  | one piece of bytes                  | a list of pieces           |
//
// What is not here, and waits for a 3.x that can be built: the signatures of TopicDataType and of
// Fast CDR (topics/topic_type.hpp, result_type.hpp, sample_type.*: getKey is compute_key, payloads
// are references, serialize() is told the representation; m_typeSize is max_serialized_type_size),
// the names of generated files (*.hpp of fastddsgen 4, whose enums are scoped), and CMake's package
// (fastdds instead of fastrtps).
//
// Functions without state, any thread; those that need more of the library are in fastdds.cpp.
#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>

#if __has_include(<fastdds/config.hpp>)
#include <fastdds/config.hpp>
#else
#define FASTDDS_VERSION_MAJOR 2
#endif

#if FASTDDS_VERSION_MAJOR >= 3
#include <fastdds/dds/core/ReturnCode.hpp>
#include <fastdds/dds/core/Time_t.hpp>
#include <fastdds/rtps/attributes/RTPSParticipantAttributes.hpp>
#include <fastdds/rtps/builtin/data/ParticipantBuiltinTopicData.hpp>
#include <fastdds/rtps/builtin/data/PublicationBuiltinTopicData.hpp>
#include <fastdds/rtps/common/InstanceHandle.hpp>
#include <fastdds/rtps/common/SampleIdentity.hpp>
#include <fastdds/rtps/common/SerializedPayload.hpp>
#include <fastdds/rtps/common/WriteParams.hpp>
#include <fastdds/rtps/transport/ChainingTransport.hpp>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.hpp>
#include <fastdds/rtps/transport/NetworkBuffer.hpp>
#include <fastdds/rtps/transport/SenderResource.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/utils/IPLocator.hpp>
#else
#include <fastdds/rtps/common/InstanceHandle.h>
#include <fastdds/rtps/common/SampleIdentity.h>
#include <fastdds/rtps/common/SerializedPayload.h>
#include <fastdds/rtps/common/WriteParams.h>
#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>
#include <fastrtps/utils/IPLocator.h>

#include <fastdds/rtps/common/LocatorList.hpp>
#endif

#include <chrono>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace fieldcast {

namespace dds = eprosima::fastdds::dds;
namespace rtps_transport = eprosima::fastdds::rtps;  // in 2.9 apart from the other types of RTPS

#if FASTDDS_VERSION_MAJOR >= 3

namespace rtps = eprosima::fastdds::rtps;
using DdsDuration = dds::Duration_t;
using DdsTime = dds::Time_t;
using dds::c_TimeInfinite;
using DiscoveryProtocol = rtps::DiscoveryProtocol;

// As in 2.9: a class that holds its values.
class ReturnCode_t {
 public:
  static constexpr dds::ReturnCode_t RETCODE_OK = dds::RETCODE_OK;
  static constexpr dds::ReturnCode_t RETCODE_OUT_OF_RESOURCES = dds::RETCODE_OUT_OF_RESOURCES;
  static constexpr dds::ReturnCode_t RETCODE_TIMEOUT = dds::RETCODE_TIMEOUT;
  ReturnCode_t(dds::ReturnCode_t code) : code_(code) {}
  bool operator==(const ReturnCode_t&) const = default;

 private:
  dds::ReturnCode_t code_;
};

// Whether a write was taken.
[[nodiscard]] inline bool is_taken(dds::ReturnCode_t written) { return written == dds::RETCODE_OK; }

#else

namespace rtps = eprosima::fastrtps::rtps;
using DdsDuration = eprosima::fastrtps::Duration_t;
using DdsTime = eprosima::fastrtps::Time_t;
using eprosima::fastrtps::c_TimeInfinite;
using DiscoveryProtocol = rtps::DiscoveryProtocol_t;

// Whether a write was taken.
[[nodiscard]] inline bool is_taken(bool written) { return written; }

#endif

// ---- settings

// Participants of one process talk through their transports like all others. Before the first one.
void turn_off_intraprocess_delivery();

// How a reliable writer repairs what was lost.
struct RepairTimes {
  DdsDuration first_heartbeat;   // how long it waits
  DdsDuration heartbeat_period;  // while something is not acknowledged
  DdsDuration suppression;       // for so long after a message was sent nobody gets it again
};
void set_repair_times(dds::DataWriterQos& qos, const RepairTimes& times);

// The participant becomes a client of the server with identity 0 (`fast-discovery-server -i 0`).
void join_discovery_server(dds::DomainParticipantQos& qos, const rtps::Locator_t& server);

// ---- discovery

struct FoundWriter {
  bool gone = false;  // it was there, and is no more
  rtps::GUID_t guid;
  std::string topic;
  DdsDuration lifespan;
};

struct FoundParticipant {
  std::string name;
  DdsDuration lease;
  std::string user_data;
};

// Told of others in the domain, on a thread of the library.
class DiscoveryListener : public dds::DomainParticipantListener {
 protected:
  virtual void on_writer(const FoundWriter&) {}
  virtual void on_participant(const FoundParticipant&) {}

 private:
#if FASTDDS_VERSION_MAJOR >= 3
  void on_data_writer_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryStatus reason,
                                const dds::PublicationBuiltinTopicData& writer,
                                bool& should_be_ignored) final {
    should_be_ignored = false;
    on_writer({reason == rtps::WriterDiscoveryStatus::REMOVED_WRITER, writer.guid,
               writer.topic_name.to_string(), writer.lifespan.duration});
  }
  void on_participant_discovery(dds::DomainParticipant*, rtps::ParticipantDiscoveryStatus,
                                const dds::ParticipantBuiltinTopicData& found,
                                bool& should_be_ignored) final {
    should_be_ignored = false;
    on_participant({found.participant_name.to_string(), found.lease_duration,
                    std::string(found.user_data.begin(), found.user_data.end())});
  }
#else
  void on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& found) final {
    on_writer({found.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER, found.info.guid(),
               found.info.topicName().to_string(), found.info.m_qos.m_lifespan.duration});
  }
  void on_participant_discovery(dds::DomainParticipant*,
                                rtps::ParticipantDiscoveryInfo&& found) final {
    on_participant({found.info.m_participantName.to_string(), found.info.m_leaseDuration,
                    std::string(found.info.m_userData.begin(), found.info.m_userData.end())});
  }
#endif
};

// ---- transport

// One message on its way out.
struct OutgoingMessage {
  using Deadline = std::chrono::steady_clock::time_point;
  using Locators = rtps_transport::LocatorsIterator;

  rtps::SenderResource* below;  // of the transport below
  std::span<const std::uint8_t> bytes;
  Locators *begin, *end;  // its receivers; who walks them moves `begin`
  Deadline deadline;
};

// A transport over another one that sees every message before it is sent.
class OutgoingTransport : public rtps_transport::ChainingTransport {
 public:
  using ChainingTransport::ChainingTransport;

  // Hands it to the transport below. Any thread.
  bool send_whole(const OutgoingMessage& message) {
    const std::lock_guard lock(mutex_);
    const auto length = static_cast<std::uint32_t>(message.bytes.size());
#if FASTDDS_VERSION_MAJOR >= 3
    return message.below->send({{ message.bytes.data(),
                                  length }},
                               length, message.begin, message.end, message.deadline, 0);
#else
    return message.below->send(message.bytes.data(), length, message.begin, message.end,
                               message.deadline);
#endif
  }

 protected:
  // Sends it, as it is or changed, now or soon.
  virtual bool on_message(const OutgoingMessage& message) = 0;

 private:
  using Deadline = OutgoingMessage::Deadline;
  using Locators = OutgoingMessage::Locators;

#if FASTDDS_VERSION_MAJOR >= 3
  bool send(rtps::SenderResource* below, const std::vector<rtps::NetworkBuffer>& pieces,
            std::uint32_t size, Locators* begin, Locators* end, const Deadline& deadline) final {
    return send_w_priority(below, pieces, size, begin, end, deadline, 0);
  }
  bool send_w_priority(rtps::SenderResource* below, const std::vector<rtps::NetworkBuffer>& pieces,
                       std::uint32_t size, Locators* begin, Locators* end, const Deadline& deadline,
                       std::int32_t) final {
    thread_local std::vector<std::uint8_t> whole;  // at most one message of the transport
    whole.clear();
    for (const rtps::NetworkBuffer& piece : pieces) {
      const auto* bytes = static_cast<const std::uint8_t*>(piece.buffer);
      whole.insert(whole.end(), bytes, bytes + piece.size);
    }
    whole.resize(size);
    return on_message({below, whole, begin, end, deadline});
  }
#else
  bool send(rtps::SenderResource* below, const rtps::octet* bytes, std::uint32_t size,
            Locators* begin, Locators* end, const Deadline& deadline) final {
    return on_message({below, {bytes, size}, begin, end, deadline});
  }
#endif
  void receive(rtps_transport::TransportReceiverInterface* above, const rtps::octet* bytes,
               std::uint32_t size, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) final {
    above->OnDataReceived(bytes, size, local, remote);
  }

  std::mutex mutex_;  // of sending: the library's own lock is not held by who sends later
};

}  // namespace fieldcast
