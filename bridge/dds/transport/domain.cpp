#include "bridge/dds/transport/domain.hpp"

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <memory>
#include <utility>

#include "bridge/dds/library/fastdds.hpp"
#include "bridge/dds/library/library.hpp"
#include "bridge/dds/transport/guard_transport.hpp"
#include "bridge/dds/transport/join_check.hpp"
#include "bridge/dds/transport/network_check.hpp"
#include "bridge/security/file_access.hpp"
#include "bridge/security/member_folder.hpp"
#include "bridge/security/pki.hpp"
#include "bridge/security/subject.hpp"

namespace fieldcast {

namespace {

using rtps_transport::UDPv4TransportDescriptor;

constexpr const char* kProfile = "fieldcast";
constexpr const char* kLoopback = "127.0.0.1";
constexpr const char* kFlowController = "fieldcast";
constexpr std::uint32_t kHighestDomain = 232;  // the ports of RTPS end there (RTPS 2.2, 9.6.1)

// UDP only, although shared memory is the default: in Fast DDS 2.9, a participant that leaves early
// leaves a message in freed memory, which the others try to read forever, with a whole processor
// (fixed in 2023, eProsima/Fast-DDS #3759). Tools that join for a short time would do that to the
// bridge.
void set_transports(const DdsSpec& spec, dds::DomainParticipantQos& qos) {
  auto& transport = qos.transport();
  transport.use_builtin_transports = false;
  auto udp = std::make_shared<UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = used_interfaces(spec);
  udp->receiveBufferSize = kReceiveBuffer;
  transport.user_transports.push_back(udp);
}

// Checks of received messages. `filter`: with DDS Security; `restarts`: with discovery servers.
struct Incoming {
  std::shared_ptr<SharedGuard> guard;
  std::shared_ptr<IncomingFilter> filter;
  std::shared_ptr<ServerRestarts> restarts;
};

// Inserts our transport above each UDP transport, for unregister messages and checks. Built-in
// transports cannot be wrapped, so UDP of the user's profile or ours replaces them.
void pass_through_ours(dds::TransportConfigQos& transport, const Incoming& incoming) {
  if (std::exchange(transport.use_builtin_transports, false) &&
      std::none_of(transport.user_transports.begin(), transport.user_transports.end(),
                   [](const auto& one) {
                     return dynamic_cast<const UDPv4TransportDescriptor*>(one.get()) != nullptr;
                   })) {
    transport.user_transports.push_back(std::make_shared<UDPv4TransportDescriptor>());
  }
  for (auto& one : transport.user_transports)
    one = std::make_shared<GuardTransportDescriptor>(one, incoming.guard, incoming.filter,
                                                     incoming.restarts);
}

void set_discovery_servers(const std::vector<ServerAddress>& servers,
                           dds::DomainParticipantQos& qos) {
  for (std::size_t i = 0; i < servers.size(); ++i) {
    rtps::Locator_t locator(LOCATOR_KIND_UDPv4, servers[i].port);
    rtps::IPLocator::setIPv4(locator, servers[i].address);
    join_discovery_server(qos, locator, static_cast<std::uint8_t>(i));
  }
}

// Limits new samples, repeated samples and samples for late joiners. Heartbeats, acknowledgements
// and discovery are not limited. A message must fit into one period.
std::shared_ptr<rtps_transport::FlowControllerDescriptor> flow_controller(std::uint64_t rate) {
  constexpr std::uint64_t kLargest = 65'536, kShortest = 20;  // bytes of a datagram; milliseconds
  auto controller = std::make_shared<rtps_transport::FlowControllerDescriptor>();
  controller->name = kFlowController;
  controller->scheduler = rtps_transport::FlowControllerSchedulerPolicy::HIGH_PRIORITY;
  controller->period_ms = std::max(kShortest, (kLargest * 1000 + rate - 1) / rate);
  controller->max_bytes_per_period = static_cast<std::int32_t>(rate * controller->period_ms / 1000);
  return controller;
}

// Short messages that a user waits for are sent before samples, catalogues and repeated samples.
bool is_urgent(const std::string& topic) {
  return topic == kCommandTopic.name || topic == kAlarmActionTopic.name ||
         topic == kCommandResultTopic.name || topic == kBridgeTopic.name ||
         topic == kInterestTopic.name;
}

// Of the flow controller: the smallest is sent first.
const char* priority_of(const std::string& topic) {
  if (is_urgent(topic)) return "-10";
  return topic == kHistoryBlockTopic.name ? "10" : "0";
}

// Fast DDS 3 announces the types of topics, and requests those of other participants. Cyclone DDS
// would then request a type before it matches, and the guard refuses that service
// (RtpsFault::kService). Fast DDS 2.9 ignores the property. A profile of the user has precedence.
void turn_off_type_propagation(dds::DomainParticipantQos& qos) {
  constexpr const char* kProperty = "fastdds.type_propagation";
  auto& properties = qos.properties().properties();
  if (std::none_of(properties.begin(), properties.end(),
                   [](const auto& one) { return one.name() == kProperty; }))
    properties.emplace_back(kProperty, "disabled");
}

// Sets the built-in plugins of DDS Security 1.1 and the files of the member.
void set_security(const std::string& folder, dds::DomainParticipantQos& qos) {
  const auto set = [&qos](const char* name, std::string value) {
    auto& properties = qos.properties().properties();
    std::erase_if(properties, [name](const auto& one) { return one.name() == name; });
    properties.emplace_back(name, std::move(value));
  };
  const auto file = [&](const char* name, std::string_view file_name) {
    set(name, security::file_uri(folder, file_name));
  };
  set("dds.sec.auth.plugin", "builtin.PKI-DH");
  file("dds.sec.auth.builtin.PKI-DH.identity_ca", security::kIdentityCa);
  file("dds.sec.auth.builtin.PKI-DH.identity_certificate", security::kIdentity);
  file("dds.sec.auth.builtin.PKI-DH.private_key", security::kIdentityKey);
  file("dds.sec.auth.builtin.PKI-DH.identity_crl", security::kRevoked);
  set("dds.sec.access.plugin", "builtin.Access-Permissions");
  file("dds.sec.access.builtin.Access-Permissions.permissions_ca", security::kPermissionsCa);
  file("dds.sec.access.builtin.Access-Permissions.governance", security::kGovernance);
  file("dds.sec.access.builtin.Access-Permissions.permissions", security::kPermissions);
  set("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
  // Fast DDS 3.1 names its algorithms as DDS Security 1.1 does, and 2.9 refuses these names. Both
  // accept the names of 2.9, and 2.9 ignores these properties (eProsima/Fast-DDS #5450).
  set("dds.sec.auth.builtin.PKI-DH.transmit_algorithms_as_legacy", "true");
  set("dds.sec.access.builtin.Access-Permissions.transmit_algorithms_as_legacy", "true");
}

RtpsLimits limits_of(const DdsSpec& spec) {
  RtpsLimits limits;
  limits.secured = spec.security.has_value();
  limits.relayed = !spec.discovery_servers.empty() || spec.profile.has_value();
  limits.participants = spec.max_participants;
  limits.endpoints = spec.max_endpoints;
  limits.sample_bytes = spec.max_sample;
  return limits;
}

std::optional<security::Member> member_of(const DdsSpec& spec) {
  if (!spec.security) return std::nullopt;
  auto member = security::read_member(*spec.security);
  if (!member) throw DdsError("dds: security: " + member.error());
  return *std::move(member);
}

std::shared_ptr<IncomingFilter> filter_of(const DdsSpec& spec) {
  if (!spec.security) return nullptr;
  try {
    const std::string governance =
        security::read_file(*spec.security + '/' + std::string(security::kGovernance));
    return std::make_shared<IncomingFilter>(security::protects_messages(governance));
  } catch (const security::SecurityError& error) {
    throw DdsError(std::string("dds: security: ") + error.what());
  }
}

dds::DomainParticipantQos participant_qos(const DdsSpec& spec, const std::string& name,
                                          const Incoming& incoming) {
  auto* factory = dds::DomainParticipantFactory::get_instance();
  dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
  if (spec.profile) {
    if (factory->load_XML_profiles_file(*spec.profile) != ReturnCode_t::RETCODE_OK) {
      throw DdsError("dds: cannot read the profile file " + *spec.profile);
    }
    if (factory->get_participant_qos_from_profile(kProfile, qos) != ReturnCode_t::RETCODE_OK) {
      throw DdsError("dds: " + *spec.profile + " has no participant profile 'fieldcast'");
    }
  }
  // A silent peer is removed after 10 s instead of 20. Announcements every half second complete a
  // discovery whose first ones crossed (25 joins: at most 0.9 s instead of 3.1 s). Replaces the
  // values of a profile: other participants rely on these times.
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.leaseDuration = to_dds(kParticipantLease);
  discovery.leaseDuration_announcementperiod = {0, 500'000'000};
  qos.name() = name;
  turn_off_type_propagation(qos);
  std::vector<ServerAddress> servers;
  for (const std::string& text : spec.discovery_servers) servers.push_back(server_address(text));
  // Transports of the user's profile are used unchanged; without any, ours are used.
  if (!spec.profile || qos.transport().user_transports.empty()) {
    if (const auto fault = server_fault(
            servers, own_addresses().value_or(std::vector<std::string>()), spec.interfaces))
      throw DdsError("dds: " + *fault);
    set_transports(spec, qos);
  }
  pass_through_ours(qos.transport(), incoming);
  if (spec.max_rate != 0) qos.flow_controllers().push_back(flow_controller(spec.max_rate));
  set_discovery_servers(servers, qos);
  if (spec.security) set_security(*spec.security, qos);
  return qos;
}

}  // namespace

std::vector<std::string> used_interfaces(const DdsSpec& spec) {
  std::vector<std::string> used = spec.interfaces;
  if (!used.empty() && std::find(used.begin(), used.end(), kLoopback) == used.end())
    used.push_back(kLoopback);
  return used;  // an empty list means all interfaces
}

Domain::Domain(const DdsSpec& spec, const std::string& name, DiscoveryListener* listener)
    : member_(member_of(spec)),
      filter_(filter_of(spec)),
      servers_(spec.discovery_servers, filter_, listener),
      has_max_rate_(spec.max_rate != 0) {
  if (spec.domain > kHighestDomain)
    throw DdsError("dds: domain " + std::to_string(spec.domain) + " is not 0..232");
  if (spec.security && spec.domain > security::kHighestDomain) {
    throw DdsError("dds: security: domain " + std::to_string(spec.domain) + " is not 0.." +
                   std::to_string(security::kHighestDomain));
  }
  // Fast DDS encrypts a message to the server for zero receivers, and asserts that there is at
  // least one (SecurityManager::encode_rtps_message).
  if (spec.security && !spec.discovery_servers.empty())
    throw DdsError("dds: security: Fast DDS 2.9 ends the program with a discovery server");
  // Otherwise the library would open no socket, without a message.
  const auto own = own_addresses();
  for (const std::string& address : spec.interfaces) {
    if (own && std::find(own->begin(), own->end(), address) == own->end())
      throw DdsError("dds: no interface of this machine has the address " + address);
  }
  prepare_library();
  auto* factory = dds::DomainParticipantFactory::get_instance();
  const auto guard = std::make_shared<SharedGuard>(limits_of(spec));
  const dds::DomainParticipantQos qos =
      participant_qos(spec, name, {guard, filter_, servers_.restarts()});
  // Discovery callbacks reach the listener anyway: they have no bit in the mask.
  participant_.reset(
      factory->create_participant(spec.domain, qos, &servers_, dds::StatusMask::none()));
  if (participant_ == nullptr) {
    throw DdsError("dds: cannot join domain " + std::to_string(spec.domain) +
                   (spec.security ? "; fieldcast secure check " + *spec.security +
                                        " says what is wrong with its identity"
                                  : ""));
  }
  ParticipantPrefix prefix{};
  std::copy_n(participant_->guid().guidPrefix.value, prefix.size(), prefix.begin());
  guard->serve(prefix);
  dds::PublisherQos publisher = dds::PUBLISHER_QOS_DEFAULT;
  dds::SubscriberQos subscriber = dds::SUBSCRIBER_QOS_DEFAULT;
  if (spec.partition) {
    publisher.partition().push_back(spec.partition->c_str());
    subscriber.partition().push_back(spec.partition->c_str());
  }
  publisher_ = participant_->create_publisher(publisher);
  subscriber_ = participant_->create_subscriber(subscriber);
  held_publisher_ = publisher_;
  if (member_ && !member_->buses.empty()) {
    dds::PublisherQos held = dds::PUBLISHER_QOS_DEFAULT;
    for (const std::string& bus : member_->buses) held.partition().push_back(bus.c_str());
    held_publisher_ = participant_->create_publisher(held);
  }
  if (publisher_ == nullptr || subscriber_ == nullptr || held_publisher_ == nullptr)
    throw DdsError("dds: cannot make a publisher and a subscriber");
  if (filter_) watch_ = std::make_unique<MemberWatch>(*spec.security, filter_, *participant_);
}

namespace {

// Empties the history before a writer is deleted: Fast DDS 2.9.1 releases it without the writer's
// lock (RTPSWriter::deinit; fixed in 2023, eProsima/Fast-DDS #4076). A heartbeat made then searches
// forever for a gap (add_gaps_for_holes_in_history_), and the deletion waits for it.
void empty(dds::DataWriter* writer) {
  std::size_t removed = 0;
  writer->clear_history(&removed);
}

}  // namespace

Domain::~Domain() {
  for (const dds::Publisher* publisher : {publisher_, held_publisher_}) {
    std::vector<dds::DataWriter*> writers;
    publisher->get_datawriters(writers);
    for (dds::DataWriter* writer : writers) empty(writer);
  }
}

void Domain::Leave::operator()(dds::DomainParticipant* participant) const {
  participant->set_listener(nullptr);
  participant->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant);
}

dds::Topic* Domain::make_topic(const TopicRow& row, const dds::TypeSupport& type) {
  const std::lock_guard lock(mutex_);
  dds::Topic*& topic = topics_[row.name];
  if (topic != nullptr) return topic;
  const std::string registered = type_name(row);
  if (type.register_type(participant_.get(), registered) != ReturnCode_t::RETCODE_OK)
    throw DdsError("dds: type " + registered + " is taken");
  topic = participant_->create_topic(row.name, registered, dds::TOPIC_QOS_DEFAULT);
  if (topic == nullptr) throw DdsError(std::string("dds: cannot make topic ") + row.name);
  return topic;
}

// Checked here because the library reports only that it cannot create the endpoint.
void Domain::check_right(const dds::Topic& topic, bool writes) const {
  if (!member_) return;
  const security::TopicRight* right = security::right_of(topic.get_name());
  if (right != nullptr && (writes ? right->writers : right->readers).has(member_->role)) return;
  std::string may;
  for (const security::RoleRow& row : security::roles()) {
    if (right != nullptr && (writes ? right->writers : right->readers).has(row.role))
      may += (may.empty() ? "" : " or ") + std::string(row.word);
  }
  throw DdsError("dds: security: " + std::string(to_text(member_->role)) + ' ' + member_->name +
                 " may not " + (writes ? "write " : "read ") + topic.get_name() +
                 (may.empty() ? "" : "; that needs an identity of role " + may));
}

dds::DataWriter* Domain::make_writer(dds::Topic* topic, dds::DataWriterQos qos,
                                     const std::string& label, dds::DataWriterListener* listener,
                                     dds::StatusMask mask) {
  qos.user_data().setValue(std::vector<rtps::octet>(label.begin(), label.end()));
  if (has_max_rate_) {
    qos.publish_mode().kind = dds::ASYNCHRONOUS_PUBLISH_MODE;
    qos.publish_mode().flow_controller_name = kFlowController;
    qos.properties().properties().emplace_back("fastdds.sfc.priority",
                                               priority_of(topic->get_name()));
  }
  check_right(*topic, true);
  const security::TopicRight* right = security::right_of(topic->get_name());
  dds::Publisher* publisher = right != nullptr && right->by_bus ? held_publisher_ : publisher_;
  dds::DataWriter* writer = publisher->create_datawriter(topic, qos, listener, mask);
  if (writer == nullptr) throw DdsError("dds: cannot make a writer of " + topic->get_name());
  return writer;
}

dds::DataReader* Domain::make_reader(dds::Topic* topic, const dds::DataReaderQos& qos,
                                     dds::DataReaderListener* listener, dds::StatusMask mask) {
  check_right(*topic, false);
  dds::DataReader* reader = subscriber_->create_datareader(topic, qos, listener, mask);
  if (reader == nullptr) throw DdsError("dds: cannot make a reader of " + topic->get_name());
  return reader;
}

dds::DataReader* Domain::make_reader_of_bus(const std::string& bus, dds::Topic* topic,
                                            const dds::DataReaderQos& qos,
                                            dds::DataReaderListener* listener,
                                            dds::StatusMask mask) {
  check_right(*topic, false);
  dds::SubscriberQos own = dds::SUBSCRIBER_QOS_DEFAULT;
  own.partition().push_back(bus.c_str());
  dds::Subscriber* subscriber = participant_->create_subscriber(own);
  dds::DataReader* reader =
      subscriber == nullptr ? nullptr : subscriber->create_datareader(topic, qos, listener, mask);
  if (reader == nullptr)
    throw DdsError("dds: cannot make a reader of " + topic->get_name() + " for bus " + bus);
  const std::lock_guard lock(mutex_);
  of_buses_[reader] = subscriber;
  return reader;
}

void Domain::remove(dds::DataWriter* writer) {
  writer->set_listener(nullptr);
  empty(writer);
  if (publisher_->delete_datawriter(writer) != ReturnCode_t::RETCODE_OK)
    held_publisher_->delete_datawriter(writer);
}

void Domain::remove(dds::DataReader* reader) {
  reader->set_listener(nullptr);
  auto own = [&] {
    const std::lock_guard lock(mutex_);
    return of_buses_.extract(reader);
  }();
  if (own.empty()) {
    subscriber_->delete_datareader(reader);
    return;
  }
  own.mapped()->delete_datareader(reader);
  participant_->delete_subscriber(own.mapped());
}

}  // namespace fieldcast
