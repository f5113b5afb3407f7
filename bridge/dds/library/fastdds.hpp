// Hides the differences between Fast DDS 2.9 and 3.x. All code uses the names of this file for
// them; headers of fastdds/dds/ are the same in both and are included where they are needed.
//
// Built and tested with 2.9.1 of Debian 12 and 3.1.2 of Debian 13 (docs/platforms.md).
//
// | subject                  | 2.9                                 | 3.x                        |
// | ------------------------ | ----------------------------------- | -------------------------- |
// | headers                  | fastrtps/, fastdds/rtps/**/*.h      | fastdds/, *.hpp            |
// | types of RTPS            | eprosima::fastrtps::rtps            | eprosima::fastdds::rtps    |
// | Duration_t, Time_t       | eprosima::fastrtps                  | eprosima::fastdds::dds     |
// | ReturnCode_t             | a class that holds its values       | an integer, values beside  |
// | DataWriter::write        | true: success                       | RETCODE_OK, which is 0     |
// | times of a writer        | heartbeatPeriod                     | heartbeat_period           |
// | discovery, listener      | on_publisher_discovery(info)        | on_data_writer_discovery   |
// | discovery, servers       | RemoteServerAttributes              | locators alone             |
// | settings of the process  | XMLProfileManager                   | DomainParticipantFactory   |
// | ChainingTransport::send  | one buffer                          | a list of buffers          |
// | TopicDataType            | getKey, serialize(data, payload)    | compute_key, references,   |
// |                          |                                     | representation as argument |
// |                          | createData, deleteData              | create_data, delete_data   |
// | Fast CDR (cdr.hpp)       | 1: getSerializedDataLength          | 2: get_.., CDR versions    |
// | keys of a message        | message.serializeKey(cdr)           | serialize_key(cdr, ..)     |
//
// Names of generated files and CMake's package: idl/CMakeLists.txt and tools/folders.cmake.
//
// Small classes, and functions without state, for any thread; longer functions are in fastdds.cpp.
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

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fieldcast {

namespace dds = eprosima::fastdds::dds;
namespace rtps_transport = eprosima::fastdds::rtps;  // in 2.9 separate from the other types of RTPS

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

[[nodiscard]] inline bool is_taken(dds::ReturnCode_t written) { return written == dds::RETCODE_OK; }

#else

namespace rtps = eprosima::fastrtps::rtps;
using DdsDuration = eprosima::fastrtps::Duration_t;
using DdsTime = eprosima::fastrtps::Time_t;
using eprosima::fastrtps::c_TimeInfinite;
using DiscoveryProtocol = rtps::DiscoveryProtocol_t;

[[nodiscard]] inline bool is_taken(bool written) { return written; }

#endif

// ---- settings

// Makes participants of one process use their transports. Call it before the first participant.
void turn_off_intraprocess_delivery();

// Times of a reliable writer for repeating lost messages.
struct RepairTimes {
  DdsDuration first_heartbeat;   // delay of the first heartbeat
  DdsDuration heartbeat_period;  // while a message is not acknowledged
  DdsDuration suppression;       // time after a message in which it is not sent again
};
void set_repair_times(dds::DataWriterQos& qos, const RepairTimes& times);

// Adds the discovery server with this identity, 0..255 (`fast-discovery-server -i IDENTITY`).
void join_discovery_server(dds::DomainParticipantQos& qos, const rtps::Locator_t& server,
                           std::uint8_t identity);

// ---- discovery

// Removes a participant that is in the domain, and ignores it permanently. Does nothing in 2.9.1,
// whose function is empty (eProsima/Fast-DDS #3412).
void remove_member(dds::DomainParticipant& from, std::span<const std::uint8_t, 12> prefix);

// The participant of the server with this identity: 44.53.IDENTITY.5f.45.50.52.4f.53.49.4d.41,
// which is "DS", the identity, "_EPROSIMA".
[[nodiscard]] rtps::GuidPrefix_t server_prefix(std::uint8_t identity);
// The identity of a discovery server; `std::nullopt` for other participants.
[[nodiscard]] std::optional<unsigned> server_identity(const rtps::GuidPrefix_t& participant);

struct FoundWriter {
  bool gone = false;  // the writer was removed
  rtps::GUID_t guid;
  std::string topic;
  DdsDuration lifespan;
};

struct FoundParticipant {
  std::string name;
  DdsDuration lease;
  std::string user_data;
  bool gone = false;
  rtps::GuidPrefix_t prefix;
  std::string subject = {};  // of its certificate, see IncomingFilter; the library leaves it empty
};

// Receives discovery of other participants and writers, on a thread of the library.
class DiscoveryListener : public dds::DomainParticipantListener {
 public:
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
  void on_participant_discovery(dds::DomainParticipant*, rtps::ParticipantDiscoveryStatus reason,
                                const dds::ParticipantBuiltinTopicData& found,
                                bool& should_be_ignored) final {
    using Status = rtps::ParticipantDiscoveryStatus;
    should_be_ignored = false;
    on_participant({found.participant_name.to_string(), found.lease_duration,
                    std::string(found.user_data.begin(), found.user_data.end()),
                    reason == Status::REMOVED_PARTICIPANT || reason == Status::DROPPED_PARTICIPANT,
                    found.guid.guidPrefix});
  }
#else
  void on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& found) final {
    on_writer({found.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER, found.info.guid(),
               found.info.topicName().to_string(), found.info.m_qos.m_lifespan.duration});
  }
  void on_participant_discovery(dds::DomainParticipant*,
                                rtps::ParticipantDiscoveryInfo&& found) final {
    using Found = rtps::ParticipantDiscoveryInfo;
    on_participant(
        {found.info.m_participantName.to_string(), found.info.m_leaseDuration,
         std::string(found.info.m_userData.begin(), found.info.m_userData.end()),
         found.status == Found::REMOVED_PARTICIPANT || found.status == Found::DROPPED_PARTICIPANT,
         found.info.m_guid.guidPrefix});
  }
#endif
};

// ---- types

inline constexpr std::size_t kEncapsulationBytes = 4;

// Returns true for the representations of DDS-XTypes 1.3, 7.6.3.1.2, that Fast CDR 1 reads.
[[nodiscard]] inline bool is_first_representation(const void* bytes, std::size_t size) {
  constexpr unsigned char kLastOfFirst = 3;
  return size >= kEncapsulationBytes && static_cast<const unsigned char*>(bytes)[1] <= kLastOfFirst;
}

// A generated type with one form of the functions that our classes override. Any thread.
template <class Generated>
class AdaptedType : public Generated {
 public:
  using Payload = rtps::SerializedPayload_t;
  using Handle = rtps::InstanceHandle_t;
  using Message = typename Generated::type;

  // Messages that the library makes for itself, for example to find the keys in a reader.
  virtual void* new_message() { return new Message(); }
  virtual void delete_message(void* message) { delete static_cast<Message*>(message); }

  // The key of a message that came without its hash, as those of 2.9.1 do. Bytes that are not a
  // message have a key too: 3.1.2 ends the process if there is none (DataReaderHistory). Reads into
  // a message of this type, unlike the generated function, which uses its own.
  bool key_of_bytes(Payload& payload, Handle& key, bool force_md5) {
    const auto discard = [this](void* message) { delete_message(message); };
    const std::unique_ptr<void, decltype(discard)> message(new_message(), discard);
    (void)from_bytes(payload, message.get());
    return key_of(message.get(), key, force_md5);
  }

  // Bytes that the library first allocates for a message: by default the largest possible size.
  [[nodiscard]] std::uint32_t first_allocation() const {
    return const_cast<AdaptedType*>(this)->allocation();
  }
  void set_first_allocation(std::uint32_t bytes) { allocation() = bytes; }

#if FASTDDS_VERSION_MAJOR >= 3
  [[nodiscard]] bool is_keyed() const { return this->is_compute_key_provided; }

  virtual bool to_bytes(const void* data, Payload& payload) {
    return Generated::serialize(data, payload, dds::XCDR_DATA_REPRESENTATION);
  }
  // Fast CDR 2 accepts a message that ends between two members, so the size is compared.
  virtual bool from_bytes(Payload& payload, void* data) {
    return is_first_representation(payload.data, payload.length) &&
           Generated::deserialize(payload, data) &&
           Generated::calculate_serialized_size(data, dds::XCDR_DATA_REPRESENTATION) <=
               payload.length;
  }
  virtual std::uint32_t size_of(const void* data) {
    return Generated::calculate_serialized_size(data, dds::XCDR_DATA_REPRESENTATION);
  }
  virtual bool key_of(const void* data, Handle& key, bool force_md5) {
    Generated clean;  // the buffer of a used object holds bytes of an earlier key
    return clean.compute_key(data, key, force_md5);
  }

  bool serialize(const void* const data, Payload& payload, dds::DataRepresentationId_t) final {
    return to_bytes(data, payload);
  }
  bool deserialize(Payload& payload, void* data) final { return from_bytes(payload, data); }
  std::uint32_t calculate_serialized_size(const void* const data,
                                          dds::DataRepresentationId_t) final {
    return size_of(data);
  }
  bool compute_key(const void* const data, Handle& key, bool force_md5) final {
    return key_of(data, key, force_md5);
  }
  bool compute_key(Payload& payload, Handle& key, bool force_md5) final {
    return key_of_bytes(payload, key, force_md5);
  }
  void* create_data() final { return new_message(); }
  void delete_data(void* message) final { delete_message(message); }

 private:
  std::uint32_t& allocation() { return this->max_serialized_type_size; }
#else
  [[nodiscard]] bool is_keyed() const { return this->m_isGetKeyDefined; }

  virtual bool to_bytes(const void* data, Payload& payload) {
    return Generated::serialize(const_cast<void*>(data), &payload);
  }
  virtual bool from_bytes(Payload& payload, void* data) {
    return Generated::deserialize(&payload, data);
  }
  virtual std::uint32_t size_of(const void* data) {
    return Generated::getSerializedSizeProvider(const_cast<void*>(data))();
  }
  // The generated function shares members between all endpoints of a participant and does not clear
  // its buffer: paddings would hold bytes of an earlier key.
  virtual bool key_of(const void* data, Handle& key, bool force_md5) {
    thread_local Generated worker;
    std::memset(worker.m_keyBuffer, 0,
                std::max<std::size_t>(Message::getKeyMaxCdrSerializedSize(), 16));
    return worker.getKey(const_cast<void*>(data), &key, force_md5);
  }

  bool serialize(void* data, Payload* payload) final { return to_bytes(data, *payload); }
  bool deserialize(Payload* payload, void* data) final { return from_bytes(*payload, data); }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) final {
    return [this, data] { return size_of(data); };
  }
  bool getKey(void* data, Handle* key, bool force_md5) final {
    return key_of(data, *key, force_md5);
  }
  void* createData() final { return new_message(); }
  void deleteData(void* message) final { delete_message(message); }

 private:
  std::uint32_t& allocation() { return this->m_typeSize; }
#endif
};

// ---- transport

struct OutgoingMessage {
  using Deadline = std::chrono::steady_clock::time_point;
  using Locators = rtps_transport::LocatorsIterator;

  rtps::SenderResource* below;  // of the transport below
  std::span<const std::uint8_t> bytes;
  Locators *begin, *end;  // its receivers; iteration moves `begin`
  Deadline deadline;
};

// A received message. `above` consumes it on this thread.
struct IncomingMessage {
  rtps_transport::TransportReceiverInterface* above;
  std::span<const std::uint8_t> bytes;
  const rtps::Locator_t &local, &remote;

  void deliver(std::span<const std::uint8_t> other_bytes) const {
    above->OnDataReceived(other_bytes.data(), static_cast<std::uint32_t>(other_bytes.size()), local,
                          remote);
  }
};

// A transport above another transport: it sees every message before it is sent or delivered.
class PassingTransport : public rtps_transport::ChainingTransport {
 public:
  using ChainingTransport::ChainingTransport;

  // Sends the message through the transport below. Any thread.
  bool send_whole(const OutgoingMessage& message) {
    const std::lock_guard lock(mutex_);
    const auto length = static_cast<std::uint32_t>(message.bytes.size());
#if FASTDDS_VERSION_MAJOR >= 3
    const std::vector<rtps::NetworkBuffer> pieces{{ message.bytes.data(), length }};
    return message.below->send(pieces, length, message.begin, message.end, message.deadline);
#else
    return message.below->send(message.bytes.data(), length, message.begin, message.end,
                               message.deadline);
#endif
  }

 protected:
  // Sends the message, unchanged or changed, now or soon.
  virtual bool on_message(const OutgoingMessage& message) = 0;
  // Delivers the message or drops it. Called on the thread of the transport below that received it.
  virtual void on_received(const IncomingMessage& message) { message.deliver(message.bytes); }

 private:
  using Deadline = OutgoingMessage::Deadline;
  using Locators = OutgoingMessage::Locators;

#if FASTDDS_VERSION_MAJOR >= 3
  bool send(rtps::SenderResource* below, const std::vector<rtps::NetworkBuffer>& pieces,
            std::uint32_t size, Locators* begin, Locators* end, const Deadline& deadline) final {
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
    on_received({above, {bytes, size}, local, remote});
  }

  std::mutex mutex_;  // for sending: a thread that sends later does not hold the library's lock
};

}  // namespace fieldcast
