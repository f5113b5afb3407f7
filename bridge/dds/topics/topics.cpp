#include "bridge/dds/topics/topics.hpp"

namespace fieldcast {

namespace {

using eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;

template <class Qos>
void limit(Qos& qos, std::int32_t instances, std::int32_t per_instance) {
  auto& limits = qos.resource_limits();
  limits.max_instances = instances;
  limits.max_samples_per_instance = per_instance;
  limits.max_samples = instances * per_instance;  // less is refused as inconsistent
  limits.allocated_samples = 0;
}

// What all endpoints share. The memory policy matters at readers: with the DYNAMIC ones Fast
// DDS 2.9.1 drops every note that an instance was disposed or unregistered ("Problem copying
// CacheChange, received data is: 0 bytes"). How large the first allocation is says TopicType.
template <class Qos>
void common(Qos& qos) {
  qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  qos.endpoint().history_memory_policy = PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();
}

// The last message before a rest, if lost, is missed only at the next heartbeat: the library's
// default is 3 s. Heartbeats cost nothing while everything is acknowledged.
void repair_soon(dds::DataWriterQos& qos) {
  auto& times = qos.reliable_writer_qos().times;
  times.initialHeartbeatDelay = {0, 5'000'000};
  times.heartbeatPeriod = {0, 50'000'000};
}

}  // namespace

DdsDuration to_dds(Duration duration) {
  if (duration == kInfinite) return eprosima::fastrtps::c_TimeInfinite;
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(duration);
  return {static_cast<std::int32_t>(seconds.count()),
          static_cast<std::uint32_t>((duration - seconds).count())};
}

Duration from_dds(const DdsDuration& duration) {
  if (duration == eprosima::fastrtps::c_TimeInfinite) return kInfinite;
  return std::chrono::seconds{duration.seconds} + std::chrono::nanoseconds{duration.nanosec};
}

dds::DataWriterQos state_writer_qos(std::int32_t max_instances) {
  dds::DataWriterQos qos;
  common(qos);
  repair_soon(qos);
  qos.durability().kind = dds::TRANSIENT_LOCAL_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = 1;
  limit(qos, max_instances, 1);
  qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  qos.reliability().max_blocking_time = {0, 10'000'000};
  return qos;
}

dds::DataReaderQos state_reader_qos(std::int32_t max_instances) {
  dds::DataReaderQos qos;
  common(qos);
  qos.durability().kind = dds::TRANSIENT_LOCAL_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = 1;
  limit(qos, max_instances, 1);
  return qos;
}

dds::DataWriterQos sample_writer_qos(std::optional<Duration> refresh) {
  dds::DataWriterQos qos = state_writer_qos(kChannelsPerWriter);
  // A channel that moves to another writer is unregistered here and lives on there.
  qos.writer_data_lifecycle().autodispose_unregistered_instances = false;
  if (refresh) qos.deadline().period = to_dds(*refresh);
  return qos;
}

dds::DataReaderQos sample_reader_qos(std::optional<Duration> deadline) {
  dds::DataReaderQos qos = state_reader_qos(kMaxChannels);
  if (deadline) qos.deadline().period = to_dds(*deadline);
  return qos;
}

dds::DataWriterQos result_writer_qos() {
  dds::DataWriterQos qos;
  common(qos);
  repair_soon(qos);
  qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
  // A ring of one instance for the library, see ResultType. It makes room by its depth alone.
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = kMaxResults;
  limit(qos, 1, kMaxResults);
  qos.resource_limits().max_samples = kMaxResults + 1;
  qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  qos.reliability().max_blocking_time = {0, 10'000'000};
  return qos;
}

dds::DataWriterQos command_writer_qos(Duration lifespan) {
  dds::DataWriterQos qos;
  common(qos);
  repair_soon(qos);
  qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_ALL_HISTORY_QOS;
  // Two per instance: the data, and the note that the instance is let go.
  limit(qos, kMaxPendingCommands, 2);
  qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  qos.writer_data_lifecycle().autodispose_unregistered_instances = false;
  qos.lifespan().duration = to_dds(lifespan);
  qos.reliability().max_blocking_time = {1, 0};
  return qos;
}

dds::DataReaderQos request_reader_qos() {
  dds::DataReaderQos qos;
  common(qos);
  qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_ALL_HISTORY_QOS;
  // With a bound on the instances the library reuses those that are empty, even when a foreign
  // writer never unregisters. Whatever came ahead of a lost message counts against its own instance
  // (Fast DDS 2.9.1, DataReaderHistory): a small bound there would reject it.
  limit(qos, kMaxPendingCommands, kMaxPendingCommands);
  return qos;
}

namespace {

void promise_to_be_alive(dds::DataWriterQos& qos) {
  qos.liveliness().kind = dds::AUTOMATIC_LIVELINESS_QOS;
  qos.liveliness().lease_duration = to_dds(kLease);
  qos.liveliness().announcement_period = to_dds(kLease / 3);
}

}  // namespace

dds::DataWriterQos interest_writer_qos() {
  dds::DataWriterQos qos = state_writer_qos(kMaxInterests);
  promise_to_be_alive(qos);
  return qos;
}

dds::DataReaderQos interest_reader_qos() { return state_reader_qos(kMaxInterests); }

dds::DataReaderQos lease_reader_qos() {
  dds::DataReaderQos qos;
  common(qos);
  qos.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = 1;
  limit(qos, 1, 1);
  qos.liveliness().kind = dds::AUTOMATIC_LIVELINESS_QOS;
  qos.liveliness().lease_duration = to_dds(kLease);
  return qos;
}

dds::DataWriterQos bridge_writer_qos() {
  dds::DataWriterQos qos = state_writer_qos(1);
  promise_to_be_alive(qos);
  return qos;
}

dds::DataReaderQos bridge_reader_qos() {
  dds::DataReaderQos qos = state_reader_qos(kMaxBridges);
  // Two bridges of one name are one instance, and both must be heard.
  qos.history().depth = 16;
  limit(qos, kMaxBridges, 16);
  qos.liveliness().kind = dds::AUTOMATIC_LIVELINESS_QOS;
  qos.liveliness().lease_duration = to_dds(kLease);
  return qos;
}

}  // namespace fieldcast
