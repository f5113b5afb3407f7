#include "bridge/dds/library/fastdds.hpp"

#if FASTDDS_VERSION_MAJOR >= 3
#include <fastdds/LibrarySettings.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#else
#include <fastdds/rtps/attributes/ServerAttributes.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#endif

namespace fieldcast {

void turn_off_intraprocess_delivery() {
#if FASTDDS_VERSION_MAJOR >= 3
  eprosima::fastdds::LibrarySettings settings;
  settings.intraprocess_delivery = eprosima::fastdds::INTRAPROCESS_OFF;
  dds::DomainParticipantFactory::get_instance()->set_library_settings(settings);
#else
  eprosima::fastrtps::LibrarySettingsAttributes settings;
  settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
#endif
}

void set_repair_times(dds::DataWriterQos& qos, const RepairTimes& times) {
  auto& set = qos.reliable_writer_qos().times;
#if FASTDDS_VERSION_MAJOR >= 3
  set.initial_heartbeat_delay = times.first_heartbeat;
  set.heartbeat_period = times.heartbeat_period;
  set.nack_supression_duration = times.suppression;
#else
  set.initialHeartbeatDelay = times.first_heartbeat;
  set.heartbeatPeriod = times.heartbeat_period;
  set.nackSupressionDuration = times.suppression;
#endif
}

void join_discovery_server(dds::DomainParticipantQos& qos, const rtps::Locator_t& server,
                           [[maybe_unused]] unsigned identity) {
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.discoveryProtocol = DiscoveryProtocol::CLIENT;
#if FASTDDS_VERSION_MAJOR >= 3
  discovery.m_DiscoveryServers.push_back(server);
#else
  rtps::RemoteServerAttributes attributes;
  rtps_transport::get_server_client_default_guidPrefix(static_cast<int>(identity),
                                                       attributes.guidPrefix);
  attributes.metatrafficUnicastLocatorList.push_back(server);
  discovery.m_DiscoveryServers.push_back(attributes);
#endif
}

// Bytes 44.53.IDENTITY.5f.45.50.52.4f.53.49.4d.41: "DS", the identity, "_EPROSIMA".
std::optional<unsigned> server_identity(const rtps::GuidPrefix_t& participant) {
  static constexpr std::string_view kBefore = "DS", kAfter = "_EPROSIMA";
  const std::string_view bytes(reinterpret_cast<const char*>(participant.value),
                               rtps::GuidPrefix_t::size);
  if (!bytes.starts_with(kBefore) || bytes.substr(kBefore.size() + 1) != kAfter)
    return std::nullopt;
  return participant.value[kBefore.size()];
}

}  // namespace fieldcast
