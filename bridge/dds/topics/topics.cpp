#include "bridge/dds/topics/topics.hpp"

namespace fieldcast {

namespace {

using rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
using rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;

// Settings of all endpoints. With the DYNAMIC memory policies, readers of Fast DDS 2.9.1 drop every
// dispose or unregister message ("Problem copying CacheChange, received data is: 0 bytes"). Topics
// without a key have no such messages, and their first allocation is never enlarged.
template <class Qos>
void set_common(Qos& qos, Durability durability, Keys keys = Keys::kKeyed) {
  qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = durability == Durability::kTransientLocal
                              ? dds::TRANSIENT_LOCAL_DURABILITY_QOS
                              : dds::VOLATILE_DURABILITY_QOS;
  qos.endpoint().history_memory_policy =
      keys == Keys::kKeyed ? PREALLOCATED_WITH_REALLOC_MEMORY_MODE : DYNAMIC_REUSABLE_MEMORY_MODE;
  qos.data_sharing().off();
}

template <class Qos>
void set_ownership(Qos& qos, Ownership ownership) {
  if (ownership == Ownership::kExclusive) qos.ownership().kind = dds::EXCLUSIVE_OWNERSHIP_QOS;
}

template <class Qos>
void set_holding(Qos& qos, const Holding& holding) {
  const bool all = holding.history == History::kKeepAll;
  qos.history().kind = all ? dds::KEEP_ALL_HISTORY_QOS : dds::KEEP_LAST_HISTORY_QOS;
  if (!all) qos.history().depth = holding.samples;
  auto& limits = qos.resource_limits();
  limits.max_instances = holding.instances;
  limits.max_samples_per_instance = holding.samples;
  // a smaller number is rejected as inconsistent
  limits.max_samples = holding.instances * holding.samples;
  limits.allocated_samples = 0;
}

// The loss of the last message before a pause is noticed only at the next heartbeat (default 3 s).
// With a suppression of 0 every message would start a timer that locks the writer.
void set_repair(dds::DataWriterQos& qos, Repair repair) {
  constexpr std::uint32_t kMs = 1'000'000;
  if (repair == Repair::kSoon)
    return set_repair_times(qos, {{0, 5 * kMs}, {0, 50 * kMs}, {0, 5 * kMs}});
  set_repair_times(qos, {{0, 5 * kMs}, {0, 400 * kMs}, {0, 400 * kMs}});
  qos.reliable_writer_qos().disable_heartbeat_piggyback = true;
}

template <class Qos>
void set_lease(Qos& qos) {
  qos.liveliness().kind = dds::AUTOMATIC_LIVELINESS_QOS;
  qos.liveliness().lease_duration = to_dds(kLease);
}

}  // namespace

DdsDuration to_dds(Duration duration) {
  if (duration == kInfinite) return c_TimeInfinite;
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(duration);
  return {static_cast<std::int32_t>(seconds.count()),
          static_cast<std::uint32_t>((duration - seconds).count())};
}

Duration from_dds(const DdsDuration& duration) {
  if (duration == c_TimeInfinite) return kInfinite;
  return std::chrono::seconds{duration.seconds} + std::chrono::nanoseconds{duration.nanosec};
}

std::string type_name(const TopicRow& topic) {
  const std::string name = topic.name;
  return "fieldcast::" + name.substr(name.find('/') + 1);
}

dds::DataWriterQos writer_qos(const TopicRow& topic) {
  dds::DataWriterQos qos;
  set_common(qos, topic.durability, topic.keys);
  set_holding(qos, topic.writer);
  set_repair(qos, topic.repair);
  qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  qos.reliability().max_blocking_time = to_dds(topic.longest_write);
  qos.writer_data_lifecycle().autodispose_unregistered_instances =
      topic.unregister == Unregister::kDisposes;
  // A ring discards by its depth only. One extra sample ensures that it never waits for a reader.
  if (topic.durability == Durability::kVolatile && topic.writer.history == History::kKeepLast)
    ++qos.resource_limits().max_samples;
  if (topic.lease == Lease::kStandby) {
    qos.liveliness().kind = dds::MANUAL_BY_TOPIC_LIVELINESS_QOS;
    qos.liveliness().lease_duration = to_dds(kStandbyLease);
  } else if (topic.lease != Lease::kNone) {
    set_lease(qos);
    qos.liveliness().announcement_period = to_dds(kLease / 3);
  }
  set_ownership(qos, topic.ownership);
  return qos;
}

dds::DataReaderQos reader_qos(const TopicRow& topic) {
  dds::DataReaderQos qos;
  set_common(qos, topic.durability, topic.keys);
  // Frees the payload of each sample that was taken: a burst of blocks is large, and rare.
  if (topic.keys != Keys::kKeyed)
    qos.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  set_holding(qos, topic.reader);
  if (topic.lease == Lease::kBoth) set_lease(qos);
  set_ownership(qos, topic.ownership);
  return qos;
}

dds::DataWriterQos sample_writer_qos(std::optional<Duration> refresh) {
  dds::DataWriterQos qos = writer_qos(kSampleTopic);
  if (refresh) qos.deadline().period = to_dds(*refresh);
  return qos;
}

dds::DataReaderQos sample_reader_qos(std::optional<Duration> deadline) {
  dds::DataReaderQos qos = reader_qos(kSampleTopic);
  if (deadline) qos.deadline().period = to_dds(*deadline);
  return qos;
}

dds::DataWriterQos command_writer_qos(Duration lifespan) {
  dds::DataWriterQos qos = writer_qos(kCommandTopic);
  qos.lifespan().duration = to_dds(lifespan);
  return qos;
}

dds::DataWriterQos alarm_action_writer_qos(Duration lifespan) {
  dds::DataWriterQos qos = writer_qos(kAlarmActionTopic);
  qos.lifespan().duration = to_dds(lifespan);
  return qos;
}

dds::DataReaderQos lease_reader_qos() {
  dds::DataReaderQos qos;
  set_common(qos, Durability::kVolatile);
  qos.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
  set_holding(qos, last_of(1));
  set_lease(qos);
  return qos;
}

dds::DataWriterQos standby_writer_qos(std::int32_t strength) {
  dds::DataWriterQos qos = writer_qos(kStandbyTopic);
  qos.ownership_strength().value = static_cast<std::uint32_t>(strength);
  return qos;
}

}  // namespace fieldcast
