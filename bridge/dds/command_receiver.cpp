#include "bridge/dds/command_receiver.hpp"

#include <fastdds/dds/subscriber/SampleInfo.hpp>

namespace fieldcast {

Duration CommandLifespans::of(const Guid& writer) const {
  const std::lock_guard lock(mutex_);
  const auto found = lifespans_.find(writer);
  return found == lifespans_.end() ? kDefault : found->second;
}

void CommandLifespans::on_publisher_discovery(dds::DomainParticipant*, eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) {
  if (info.info.topicName() != kCommandTopic) return;
  const std::lock_guard lock(mutex_);
  if (info.status == eprosima::fastrtps::rtps::WriterDiscoveryInfo::REMOVED_WRITER) {
    lifespans_.erase(info.info.guid());
    return;
  }
  const Duration lifespan = from_dds(info.info.m_qos.m_lifespan.duration);
  if (lifespan == kInfinite || lifespans_.size() >= kMaxWriters) return;
  lifespans_[info.info.guid()] = lifespan;
}

Instant expiry_of(UtcTime source, Duration lifespan, const UtcMapping& now) {
  std::int64_t age = 0;
  if (source.nanoseconds <= 0 || __builtin_sub_overflow(now.utc.nanoseconds, source.nanoseconds, &age)) age = 0;
  age = std::max<std::int64_t>(age, 0);
  // Long past or far ahead is all the same; this keeps the sum in range.
  constexpr std::int64_t kLimit = std::int64_t{1} << 60;
  return now.instant + Duration{std::min(lifespan.count(), kLimit)} - Duration{std::min(age, kLimit)};
}

CommandReceiver::CommandReceiver(Domain& domain, const CommandLifespans& lifespans, Handlers handlers)
    : domain_(domain), lifespans_(lifespans), handlers_(std::move(handlers)) {
  reader_ = domain.reader<idl::CommandPubSubType>(kCommandTopic, request_reader_qos(), this, dds::StatusMask::data_available());
}

void CommandReceiver::close() { domain_.remove(reader_); }

void CommandReceiver::on_data_available(dds::DataReader* reader) {
  idl::Command command;
  dds::SampleInfo info;
  // Also takes the notes that an instance was let go, which frees it here.
  while (reader->take_next_sample(&command, &info) == ReturnCode_t::RETCODE_OK) {
    if (info.valid_data) take(command, info);
  }
}

void CommandReceiver::take(const idl::Command& command, const dds::SampleInfo& info) {
  const std::string bus = command.bus().c_str();
  if (!handlers_.is_ours(bus)) return;
  const CommandLifespans::Guid writer = info.sample_identity.writer_guid();
  handlers_.heard(command.requester().c_str(), writer);
  auto converted = from_idl(command);
  if (!converted) {
    handlers_.malformed(bus, command, converted.error());
    return;
  }
  converted->expires = expiry_of({info.source_timestamp.to_ns()}, lifespans_.of(writer), handlers_.clock());
  handlers_.accepted(bus, std::move(*converted));
}

}  // namespace fieldcast
