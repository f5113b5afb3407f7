#include "bridge/dds/library/fastdds.hpp"

#if FASTDDS_VERSION_MAJOR >= 3
#include <fastdds/LibrarySettings.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#else
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
                           [[maybe_unused]] std::uint8_t identity) {
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.discoveryProtocol = DiscoveryProtocol::CLIENT;
#if FASTDDS_VERSION_MAJOR >= 3
  discovery.m_DiscoveryServers.push_back(server);
#else
  rtps::RemoteServerAttributes attributes;
  attributes.guidPrefix = server_prefix(identity);
  attributes.metatrafficUnicastLocatorList.push_back(server);
  discovery.m_DiscoveryServers.push_back(attributes);
#endif
}

void remove_member([[maybe_unused]] dds::DomainParticipant& from,
                   [[maybe_unused]] std::span<const std::uint8_t, 12> prefix) {
#if FASTDDS_VERSION_MAJOR >= 3
  rtps::InstanceHandle_t handle;
  std::copy_n(prefix.begin(), prefix.size(), &handle.value[0]);
  std::ranges::copy(rtps::c_EntityId_RTPSParticipant.value, &handle.value[prefix.size()]);
  (void)from.ignore_participant(handle);
#endif
}

namespace {

constexpr std::string_view kBeforeIdentity = "DS", kAfterIdentity = "_EPROSIMA";

}  // namespace

rtps::GuidPrefix_t server_prefix(std::uint8_t identity) {
  rtps::GuidPrefix_t prefix;
  auto* const at = std::ranges::copy(kBeforeIdentity, prefix.value).out;
  *at = identity;
  std::ranges::copy(kAfterIdentity, at + 1);
  return prefix;
}

std::optional<unsigned> server_identity(const rtps::GuidPrefix_t& participant) {
  const std::uint8_t identity = participant.value[kBeforeIdentity.size()];
  return participant == server_prefix(identity) ? std::optional<unsigned>(identity) : std::nullopt;
}

}  // namespace fieldcast
