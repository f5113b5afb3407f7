// The table of topics: one row for each, which both ends use (bridge/dds/README.md) and from which
// the QoS follows. Values; any thread. Every keyed endpoint has its own resource limits: the
// library's default is 10 instances, and 90 of 100 channels would be lost without a message.
#pragma once

#include <array>
#include <cstdint>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <optional>
#include <string>
#include <tuple>

#include "bridge/dds/library/fastdds.hpp"
#include "core/base/time.hpp"
#include "idl/topicsPubSubTypes.h"

namespace fieldcast {

namespace idl = ::fieldcast_idl;

// ---- limits

// DEADLINE scans a writer's instances at nearly every write.
inline constexpr std::int32_t kChannelsPerWriter = 256;
// In the domain, at one reader; and in the catalogue of one bridge.
inline constexpr std::int32_t kMaxChannels = 100'000;
// The time to process a new reader grows with the square of their number (bus_catalogue.hpp).
inline constexpr std::int32_t kChannelsPerCatalogueWriter = 1024;
inline constexpr std::int32_t kMaxDevices = 10'000;  // also the limit for status
// limits that ever raised an alarm; also the limit for status
inline constexpr std::int32_t kMaxAlarms = 100'000;
// Commands not yet acknowledged; commands and results not yet taken.
inline constexpr std::int32_t kMaxPendingCommands = 4096;
// Results and unregister messages that a reader has not yet acknowledged.
inline constexpr std::int32_t kMaxResults = 2 * kMaxPendingCommands;
inline constexpr std::int32_t kMaxInterests = 4096;
inline constexpr std::int32_t kMaxBridges = 1024;
inline constexpr std::int32_t kMaxBuses = 1024;       // of one bridge
inline constexpr std::int32_t kBlocksKept = 256;      // of a bus, for readers that lost some
inline constexpr std::int32_t kBlocksTaken = 1024;    // of all buses, not yet taken by a station
inline constexpr std::int32_t kAuditKept = 256;       // entries of a bridge
inline constexpr std::int32_t kEntriesPerBlock = 64;  // of the catalogue: IDL sequence<.., 64>

inline constexpr std::int32_t kHistoryRequestsKept = 16;  // not yet taken by a bridge
inline constexpr std::int32_t kHistoryBlocksKept = 256;   // a response has at most 128
// Parts of requests or replies. One request or reply has at most half as many.
inline constexpr std::int32_t kConfigurationPartsKept = 1024;
inline constexpr std::int32_t kMaxStandbyMembers = 256;  // in the domain
inline constexpr std::int32_t kStandbyNotesKept = 4096;

// Lease of writers that show that their process is alive.
inline constexpr Duration kLease = std::chrono::seconds{6};
// Lease among bridges that stand by for each other.
inline constexpr Duration kStandbyLease = std::chrono::milliseconds{300};

// ---- columns of a row

enum class Keys : std::uint8_t { kKeyed, kNone };
enum class Durability : std::uint8_t { kVolatile, kTransientLocal };
enum class History : std::uint8_t { kKeepLast, kKeepAll };

// Samples that an endpoint holds.
struct Holding {
  History history = History::kKeepLast;
  std::int32_t instances = 1;
  std::int32_t samples = 1;  // of one instance; with kKeepLast the depth
};
constexpr Holding last_of(std::int32_t instances, std::int32_t depth = 1) {
  return {History::kKeepLast, instances, depth};
}
constexpr Holding all_of(std::int32_t instances, std::int32_t samples) {
  return {History::kKeepAll, instances, samples};
}

// Use of automatic liveliness.
enum class Lease : std::uint8_t {
  kNone,
  // writers offer the lease; a reader that requests none matches the default of any vendor
  kWriters,
  kBoth,     // readers request it too
  kStandby,  // writers offer kStandbyLease, asserted by writing, not by a running process
};
enum class Ownership : std::uint8_t { kShared, kExclusive };
// Effect of unregistering an instance at readers.
enum class Unregister : std::uint8_t {
  kDisposes,  // the instance is disposed
  kLetsGo,    // the writer no longer writes it
};

// How the loss of a message is detected.
enum class Repair : std::uint8_t {
  kSoon,  // a heartbeat with every message, and each 50 ms: within some 10 ms
  // A heartbeat each 400 ms while a message is not acknowledged: a loss delays the later messages
  // by at most some 0.8 s. Heartbeats, their responses and their timers wake threads on both sides,
  // which is more work than a block.
  kSaving,
};

struct TopicRow {
  const char* name;  // the name of its type is fieldcast:: and the part after the slash
  Durability durability;
  Holding writer, reader;
  Lease lease = Lease::kNone;
  Unregister unregister = Unregister::kDisposes;
  // Longest wait of a write, with readers that lag. Fast DDS 2.9.1 waits at most this long for its
  // timers too, and sends no heartbeat any more after that (TimedEvent::restart_timer): not too
  // short.
  Duration longest_write = std::chrono::milliseconds{100};
  Keys keys = Keys::kKeyed;
  Repair repair = Repair::kSoon;
  Ownership ownership = Ownership::kShared;
  // Identities from before this topic have no right to it. They work without it.
  bool is_optional = false;
};
template <class GeneratedType>
struct Topic : TopicRow {
  using Generated = GeneratedType;  // by fastddsgen
  using Message = typename Generated::type;
  static constexpr bool kIsReport = false;
};
// The last state of each instance, for late joiners too. DdsLink creates one writer for all buses,
// and Station::subscribe() receives the values to which from_idl() converts the messages.
template <class GeneratedType>
struct Report : Topic<GeneratedType> {
  static constexpr bool kIsReport = true;
};

// ---- the table

inline constexpr auto kStays = Durability::kTransientLocal;  // late joiners get it
inline constexpr auto kPasses = Durability::kVolatile;

template <class Generated>
constexpr Report<Generated> report(const char* name, std::int32_t instances) {
  return {{{name, kStays, last_of(instances), last_of(instances)}}};
}

template <class Row>
constexpr Row optional(Row row) {
  row.is_optional = true;
  return row;
}

// With a DEADLINE for each refresh. A channel that moves to another writer is unregistered at the
// old one, and its instance remains.
inline constexpr Topic<idl::SamplePubSubType> kSampleTopic{
    {"fieldcast/Sample", kStays, last_of(kChannelsPerWriter), last_of(kMaxChannels), Lease::kNone,
     Unregister::kLetsGo}};
inline constexpr Topic<idl::ChannelPubSubType> kChannelTopic{
    {"fieldcast/Channel", kStays, last_of(kChannelsPerCatalogueWriter), last_of(kMaxChannels)}};
inline constexpr auto kBusStatusTopic =
    report<idl::BusStatusPubSubType>("fieldcast/BusStatus", kMaxDevices);
inline constexpr auto kDeviceStatusTopic =
    report<idl::DeviceStatusPubSubType>("fieldcast/DeviceStatus", kMaxDevices);
inline constexpr auto kProgramSessionTopic =
    report<idl::ProgramSessionPubSubType>("fieldcast/ProgramSession", kMaxDevices);
inline constexpr auto kProgramRequestTopic =
    optional(report<idl::ProgramRequestPubSubType>("fieldcast/ProgramRequest", kMaxDevices));
inline constexpr auto kAuditTopic = optional(Report<idl::AuditPubSubType>{
    {{"fieldcast/Audit", kStays, last_of(1, kAuditKept), last_of(kMaxBridges, kAuditKept)}}});
inline constexpr auto kDeviceDescriptionTopic =
    optional(report<idl::DeviceDescriptionPubSubType>("fieldcast/DeviceDescription", kMaxDevices));
inline constexpr auto kReadPlanTopic =
    report<idl::ReadPlanPubSubType>("fieldcast/ReadPlan", kMaxChannels / 16);
inline constexpr auto kAlarmTopic = report<idl::AlarmPubSubType>("fieldcast/Alarm", kMaxAlarms);
inline constexpr auto kAlarmStatusTopic =
    report<idl::AlarmStatusPubSubType>("fieldcast/AlarmStatus", kMaxAlarms);
// One writer for each bus. A slow reader loses the oldest blocks, and delays no other.
inline constexpr Topic<idl::SampleBlockPubSubType> kSampleBlockTopic{
    {"fieldcast/SampleBlock", kPasses, last_of(1, kBlocksKept), last_of(1, kBlocksTaken),
     Lease::kNone, Unregister::kDisposes, std::chrono::milliseconds{10}, Keys::kNone,
     Repair::kSaving}};
inline constexpr Topic<idl::SnapshotRequestPubSubType> kSnapshotRequestTopic{
    {"fieldcast/SnapshotRequest", kPasses, last_of(kMaxBuses), last_of(kMaxBuses)}};
inline constexpr auto kHistoryRequestTopic = optional(Topic<idl::HistoryRequestPubSubType>{
    {"fieldcast/HistoryRequest", kPasses, last_of(1, kHistoryRequestsKept),
     last_of(1, kHistoryRequestsKept), Lease::kNone, Unregister::kDisposes,
     std::chrono::milliseconds{100}, Keys::kNone}});
inline constexpr auto kHistoryBlockTopic = optional(Topic<idl::HistoryBlockPubSubType>{
    {"fieldcast/HistoryBlock", kPasses, last_of(1, kHistoryBlocksKept),
     last_of(1, kHistoryBlocksKept), Lease::kNone, Unregister::kDisposes,
     std::chrono::milliseconds{100}, Keys::kNone}});
template <class Generated>
constexpr auto configuration_topic(const char* name) {
  return optional(Topic<Generated>{
      {name, kPasses, last_of(1, kConfigurationPartsKept), last_of(1, kConfigurationPartsKept),
       Lease::kNone, Unregister::kDisposes, std::chrono::milliseconds{100}, Keys::kNone}});
}
inline constexpr auto kConfigurationRequestTopic =
    configuration_topic<idl::ConfigurationRequestPubSubType>("fieldcast/ConfigurationRequest");
inline constexpr auto kConfigurationReplyTopic =
    configuration_topic<idl::ConfigurationReplyPubSubType>("fieldcast/ConfigurationReply");
inline constexpr Topic<idl::CatalogueBlockPubSubType> kCatalogueBlockTopic{
    {"fieldcast/CatalogueBlock", kStays, last_of(kMaxChannels / 16), last_of(kMaxChannels / 16)}};
// With the LIFESPAN of its writer. Two samples of an instance: the command, and its unregister
// message. At a reader, messages before a lost one count against their instance
// (DataReaderHistory): a small limit would reject the lost one. With a bound on the instances the
// library reuses empty ones.
inline constexpr Topic<idl::CommandPubSubType> kCommandTopic{
    {"fieldcast/Command", kPasses, all_of(kMaxPendingCommands, 2),
     all_of(kMaxPendingCommands, kMaxPendingCommands), Lease::kNone, Unregister::kLetsGo,
     std::chrono::seconds{1}}};
inline constexpr Topic<idl::AlarmActionPubSubType> kAlarmActionTopic{
    {"fieldcast/AlarmAction", kPasses, all_of(kMaxPendingCommands, 2),
     all_of(kMaxPendingCommands, kMaxPendingCommands), Lease::kNone, Unregister::kLetsGo,
     std::chrono::seconds{1}}};
// For the library a ring of one instance (ResultType): a slow reader loses the oldest.
inline constexpr Topic<idl::CommandResultPubSubType> kCommandResultTopic{
    {"fieldcast/CommandResult", kPasses, last_of(1, kMaxResults),
     all_of(kMaxPendingCommands, kMaxPendingCommands)}};
inline constexpr Topic<idl::InterestPubSubType> kInterestTopic{
    {"fieldcast/Interest", kStays, last_of(kMaxInterests), last_of(kMaxInterests),
     Lease::kWriters}};
// Two bridges of one name share one instance, and both must be received: hence the depth.
inline constexpr Topic<idl::BridgePubSubType> kBridgeTopic{
    {"fieldcast/Bridge", kStays, last_of(1), last_of(kMaxBridges, 16), Lease::kBoth}};
// Each bridge has its own instance; of two with the same name, readers accept the stronger one.
inline constexpr Topic<idl::StandbyPubSubType> kStandbyTopic{
    {"fieldcast/Standby", kStays, last_of(1), last_of(kMaxStandbyMembers), Lease::kStandby,
     Unregister::kDisposes, std::chrono::milliseconds{10}, Keys::kKeyed, Repair::kSoon,
     Ownership::kExclusive}};
inline constexpr Topic<idl::StandbyNotePubSubType> kStandbyNoteTopic{
    {"fieldcast/StandbyNote", kPasses, last_of(1, kStandbyNotesKept), last_of(1, kStandbyNotesKept),
     Lease::kNone, Unregister::kDisposes, std::chrono::milliseconds{10}, Keys::kNone}};
inline constexpr Topic<idl::StandbyRequestPubSubType> kStandbyRequestTopic{
    {"fieldcast/StandbyRequest", kPasses, last_of(1), last_of(kMaxStandbyMembers)}};

inline constexpr std::tuple kTopicTable{&kSampleBlockTopic,
                                        &kSnapshotRequestTopic,
                                        &kCatalogueBlockTopic,
                                        &kSampleTopic,
                                        &kChannelTopic,
                                        &kBusStatusTopic,
                                        &kDeviceStatusTopic,
                                        &kProgramSessionTopic,
                                        &kProgramRequestTopic,
                                        &kDeviceDescriptionTopic,
                                        &kReadPlanTopic,
                                        &kAlarmTopic,
                                        &kAlarmStatusTopic,
                                        &kAlarmActionTopic,
                                        &kCommandTopic,
                                        &kCommandResultTopic,
                                        &kInterestTopic,
                                        &kBridgeTopic,
                                        &kStandbyTopic,
                                        &kStandbyNoteTopic,
                                        &kStandbyRequestTopic,
                                        &kHistoryRequestTopic,
                                        &kHistoryBlockTopic,
                                        &kAuditTopic,
                                        &kConfigurationRequestTopic,
                                        &kConfigurationReplyTopic};

inline constexpr auto kTopics = std::apply(
    [](const auto*... row) { return std::array<const TopicRow*, sizeof...(row)>{row...}; },
    kTopicTable);

// Calls `visit` with the row of each Report.
template <class Visit>
void for_each_report(Visit visit) {
  const auto visit_report = [&]<class Row>(const Row& row) {
    if constexpr (Row::kIsReport) visit(row);
  };
  std::apply([&](const auto*... row) { (visit_report(*row), ...); }, kTopicTable);
}

// "fieldcast::Sample" for "fieldcast/Sample".
[[nodiscard]] std::string type_name(const TopicRow& topic);

// ---- QoS

[[nodiscard]] dds::DataWriterQos writer_qos(const TopicRow& topic);
[[nodiscard]] dds::DataReaderQos reader_qos(const TopicRow& topic);

// For samples of one refresh; `std::nullopt`: no promise, or none requested.
[[nodiscard]] dds::DataWriterQos sample_writer_qos(std::optional<Duration> refresh);
[[nodiscard]] dds::DataReaderQos sample_reader_qos(std::optional<Duration> deadline);
[[nodiscard]] dds::DataWriterQos command_writer_qos(Duration lifespan);
[[nodiscard]] dds::DataWriterQos alarm_action_writer_qos(Duration lifespan);
// For a reader that takes no samples and only learns which writers with a lease are alive.
[[nodiscard]] dds::DataReaderQos lease_reader_qos();
[[nodiscard]] dds::DataWriterQos standby_writer_qos(std::int32_t strength);

[[nodiscard]] DdsDuration to_dds(Duration duration);
[[nodiscard]] Duration from_dds(const DdsDuration& duration);  // kInfinite for an infinite one
inline constexpr Duration kInfinite = Duration::max();

}  // namespace fieldcast
