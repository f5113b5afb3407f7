#include "bridge/dds/library/secured_announcement.hpp"

#include "bridge/dds/library/fastdds.hpp"

#if FASTDDS_VERSION_MAJOR >= 3

namespace fieldcast {
void offer_secured_announcements() {}  // 3.x has the endpoints
}  // namespace fieldcast

#else

#include <dlfcn.h>
#include <fastdds/rtps/attributes/HistoryAttributes.h>
#include <fastdds/rtps/attributes/WriterAttributes.h>
#include <fastdds/rtps/builtin/data/ParticipantProxyData.h>
#include <fastdds/rtps/builtin/data/ReaderProxyData.h>
#include <fastdds/rtps/builtin/discovery/participant/PDPSimple.h>
#include <fastdds/rtps/common/CDRMessage_t.h>
#include <fastdds/rtps/history/WriterHistory.h>
#include <fastdds/rtps/writer/RTPSWriter.h>

#include <map>
#include <memory>
#include <mutex>

// The installed headers declare these two classes without members. The declarations are those of
// the exported functions (nm -DC libfastrtps.so.2.9).
namespace eprosima::fastrtps::rtps {

class RTPSParticipantImpl {
 public:
  bool createWriter(RTPSWriter** writer, WriterAttributes& attributes, WriterHistory* history,
                    WriterListener* listener, const EntityId_t& entity, bool builtin);
  bool deleteUserEndpoint(const GUID_t& endpoint);
  [[gnu::visibility("default")]] bool pairing_remote_reader_with_local_writer_after_security(
      const GUID_t& local_writer, const ReaderProxyData& remote_reader);
};

namespace security {

class SecurityManager {
 public:
  [[gnu::visibility("default")]] bool register_local_builtin_writer(
      const GUID_t& writer, EndpointSecurityAttributes& protection);
  bool discovered_builtin_reader(const GUID_t& writer, const GUID_t& remote_participant,
                                 ReaderProxyData& remote_reader,
                                 const EndpointSecurityAttributes& protection);
  void remove_reader(const GUID_t& writer, const GUID_t& remote_participant,
                     const GUID_t& remote_reader);
};

}  // namespace security
}  // namespace eprosima::fastrtps::rtps

namespace fieldcast {
namespace {

namespace rtps = eprosima::fastrtps::rtps;
namespace security = rtps::security;
using rtps::GUID_t;
using rtps::PDPSimple;

// DDS Security 1.1, tables 10 and 11: the endpoints of DCPSParticipantsSecure and their bit.
const rtps::EntityId_t kSecuredWriter{0xff0101c2};
const rtps::EntityId_t kSecuredReader{0xff0101c7};
const rtps::EntityId_t kPublicationsWriter{0xff0003c2};  // protected in the same way
constexpr std::uint32_t kHasSecuredReader = 1U << 27;
constexpr std::size_t kMaxLocators = 16;

// The library's own function behind one that is defined here.
template <typename Function>
Function library_function(const char* symbol) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, symbol));
}

using Register = bool (*)(security::SecurityManager*, const GUID_t&,
                          security::EndpointSecurityAttributes&);
using Pair = bool (*)(rtps::RTPSParticipantImpl*, const GUID_t&, const rtps::ReaderProxyData&);
using Announce = void (*)(PDPSimple*, bool, bool, rtps::WriteParams&);
using Match = void (*)(PDPSimple*, const rtps::ParticipantProxyData&);
using Remove = void (*)(PDPSimple*, rtps::ParticipantProxyData*);

struct Library {
  Register register_writer = library_function<Register>(
      "_ZN8eprosima8fastrtps4rtps8security15SecurityManager29register_local_builtin_writerERKNS1_"
      "6GUID_tERNS2_26EndpointSecurityAttributesE");
  Pair pair = library_function<Pair>(
      "_ZN8eprosima8fastrtps4rtps19RTPSParticipantImpl54pairing_remote_reader_with_local_writer_"
      "after_securityERKNS1_6GUID_tERKNS1_15ReaderProxyDataE");
  Announce announce = library_function<Announce>(
      "_ZN8eprosima8fastrtps4rtps9PDPSimple24announceParticipantStateEbbRNS1_11WriteParamsE");
  Match match = library_function<Match>(
      "_ZN8eprosima8fastrtps4rtps9PDPSimple26notifyAboveRemoteEndpointsERKNS1_"
      "20ParticipantProxyDataE");
  Remove remove = library_function<Remove>(
      "_ZN8eprosima8fastrtps4rtps9PDPSimple21removeRemoteEndpointsEPNS1_20ParticipantProxyDataE");
};

const Library& library() {
  static const Library functions;
  return functions;
}

// The secured announcement of one local participant. The participant creates and ends it while no
// other thread of it runs.
struct Announcer {
  security::SecurityManager* manager = nullptr;
  security::EndpointSecurityAttributes protection;
  std::unique_ptr<rtps::WriterHistory> history;
  rtps::RTPSWriter* writer = nullptr;  // owned by the participant

  void create(PDPSimple& discovery);
  void announce(PDPSimple& discovery);
  void match(const rtps::ParticipantProxyData& remote);
  void remove(const GUID_t& remote);
  void end(PDPSimple& discovery);
};

// By GUID prefix of the local participant; the library calls from several threads.
class Announcers {
 public:
  Announcer& of(const rtps::GuidPrefix_t& prefix) {
    const std::scoped_lock lock(mutex_);
    return announcers_[prefix];
  }
  // Null if the participant is not secured.
  Announcer* find(const rtps::GuidPrefix_t& prefix) {
    const std::scoped_lock lock(mutex_);
    const auto found = announcers_.find(prefix);
    return found == announcers_.end() ? nullptr : &found->second;
  }
  void erase(const rtps::GuidPrefix_t& prefix) {
    const std::scoped_lock lock(mutex_);
    announcers_.erase(prefix);
  }

 private:
  std::mutex mutex_;
  std::map<rtps::GuidPrefix_t, Announcer> announcers_;
};

Announcers& announcers() {
  static Announcers all;
  return all;
}

void Announcer::create(PDPSimple& discovery) {
  rtps::HistoryAttributes keep;
  keep.memoryPolicy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  keep.initialReservedCaches = 1;
  history = std::make_unique<rtps::WriterHistory>(keep);
  rtps::WriterAttributes attributes;
  attributes.endpoint.reliabilityKind = rtps::RELIABLE;
  attributes.endpoint.durabilityKind = rtps::TRANSIENT_LOCAL;
  attributes.endpoint.topicKind = rtps::WITH_KEY;
  attributes.endpoint.security_attributes() = protection;
  {
    const std::scoped_lock lock(*discovery.getMutex());
    const auto& own = discovery.getLocalParticipantProxyData()->metatraffic_locators.unicast;
    for (const auto& locator : own) attributes.endpoint.unicastLocatorList.push_back(locator);
  }
  if (!discovery.getRTPSParticipant()->createWriter(&writer, attributes, history.get(), nullptr,
                                                    kSecuredWriter, true))
    writer = nullptr;
}

// Replaces the sample by the present data of the participant.
void Announcer::announce(PDPSimple& discovery) {
  if (history->getHistorySize() > 0) history->remove_min_change();
  std::unique_lock lock(*discovery.getMutex());
  rtps::ParticipantProxyData data(*discovery.getLocalParticipantProxyData());
  lock.unlock();
  const std::uint32_t size = data.get_serialized_size(true);
  auto* change = writer->new_change([size] { return size; }, rtps::ALIVE, data.m_key);
  if (change == nullptr) return;
  rtps::CDRMessage_t message(change->serializedPayload);
  message.msg_endian = rtps::DEFAULT_ENDIAN;
  change->serializedPayload.encapsulation = PL_DEFAULT_ENCAPSULATION;
  if (data.writeToCDRMessage(&message, true)) {
    change->serializedPayload.length = message.length;
    history->add_change(change);
  } else {
    writer->release_change(change);
  }
}

void Announcer::match(const rtps::ParticipantProxyData& remote) {
  if (writer == nullptr || (remote.m_availableBuiltinEndpoints & kHasSecuredReader) == 0) return;
  rtps::ReaderProxyData reader(kMaxLocators, kMaxLocators);
  reader.guid({remote.m_guid.guidPrefix, kSecuredReader});
  reader.m_expectsInlineQos = false;
  reader.topicKind(rtps::WITH_KEY);
  reader.m_qos.m_reliability.kind = eprosima::fastdds::dds::RELIABLE_RELIABILITY_QOS;
  reader.m_qos.m_durability.kind = eprosima::fastdds::dds::TRANSIENT_LOCAL_DURABILITY_QOS;
  for (const auto& locator : remote.metatraffic_locators.unicast)
    reader.add_unicast_locator(locator);
  // Sends the keys of the writer; pairing follows when those of the reader have arrived.
  (void)manager->discovered_builtin_reader(writer->getGuid(), remote.m_guid, reader, protection);
}

void Announcer::remove(const GUID_t& remote) {
  if (writer == nullptr) return;
  const GUID_t reader(remote.guidPrefix, kSecuredReader);
  if (writer->matched_reader_remove(reader))
    manager->remove_reader(writer->getGuid(), remote, reader);
}

void Announcer::end(PDPSimple& discovery) {
  if (writer != nullptr)
    (void)discovery.getRTPSParticipant()->deleteUserEndpoint(writer->getGuid());
}

}  // namespace

void offer_secured_announcements() { (void)library(); }

}  // namespace fieldcast

// The definitions that replace those of the library.
namespace eprosima::fastrtps::rtps {

using fieldcast::announcers;
using fieldcast::library;

bool security::SecurityManager::register_local_builtin_writer(
    const GUID_t& writer, EndpointSecurityAttributes& protection) {
  if (writer.entityId == fieldcast::kPublicationsWriter) {
    fieldcast::Announcer& announcer = announcers().of(writer.guidPrefix);
    announcer.manager = this;
    announcer.protection = protection;
  }
  return library().register_writer(this, writer, protection);
}

bool RTPSParticipantImpl::pairing_remote_reader_with_local_writer_after_security(
    const GUID_t& local_writer, const ReaderProxyData& remote_reader) {
  if (local_writer.entityId != fieldcast::kSecuredWriter)
    return library().pair(this, local_writer, remote_reader);
  const fieldcast::Announcer* announcer = announcers().find(local_writer.guidPrefix);
  return announcer != nullptr && announcer->writer->matched_reader_add(remote_reader);
}

[[gnu::visibility("default")]] void PDPSimple::announceParticipantState(bool changed, bool dispose,
                                                                        WriteParams& parameters) {
  // Not from getLocalParticipantProxyData(): that reads a list which a thread that discovers a
  // participant may extend at the same time.
  const auto& prefix = mp_PDPWriter->getGuid().guidPrefix;
  if (fieldcast::Announcer* announcer = announcers().find(prefix)) {
    if (dispose) {
      announcer->end(*this);
      announcers().erase(prefix);
    } else {
      const bool first = announcer->writer == nullptr;
      if (first) announcer->create(*this);
      if (announcer->writer != nullptr && (first || changed)) announcer->announce(*this);
    }
  }
  library().announce(this, changed, dispose, parameters);
}

[[gnu::visibility("default")]] void PDPSimple::notifyAboveRemoteEndpoints(
    const ParticipantProxyData& remote) {
  library().match(this, remote);
  if (fieldcast::Announcer* announcer = announcers().find(mp_PDPWriter->getGuid().guidPrefix))
    announcer->match(remote);
}

[[gnu::visibility("default")]] void PDPSimple::removeRemoteEndpoints(ParticipantProxyData* remote) {
  if (fieldcast::Announcer* announcer = announcers().find(mp_PDPWriter->getGuid().guidPrefix))
    announcer->remove(remote->m_guid);
  library().remove(this, remote);
}

}  // namespace eprosima::fastrtps::rtps

#endif
