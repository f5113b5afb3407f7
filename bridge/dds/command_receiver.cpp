#include "bridge/dds/command_receiver.hpp"

#include <algorithm>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

namespace fieldcast {

namespace {

constexpr std::int64_t kLongest = std::int64_t{1} << 60;  // nanoseconds, 36 years

}  // namespace

Duration CommandLifespans::of(const Guid& writer) const {
  const std::lock_guard lock(mutex_);
  const auto found = lifespans_.find(writer);
  return found == lifespans_.end() ? kDefault : found->second;
}

void CommandLifespans::on_writer(const FoundWriter& writer) {
  if (writer.topic != kCommandTopic.name && writer.topic != kAlarmActionTopic.name) return;
  const std::lock_guard lock(mutex_);
  if (writer.gone) {
    lifespans_.erase(writer.guid);
    return;
  }
  const Duration lifespan = from_dds(writer.lifespan);
  if (lifespan == kInfinite || lifespans_.size() >= kMaxWriters) return;
  lifespans_[writer.guid] = std::min(lifespan, kLongest);
}

void CommandLifespans::on_participant(const FoundParticipant& participant) {
  if (participant.gone) {
    requesters_.lost(participant.prefix);
  } else if (!participant.subject.empty()) {
    requesters_.found(participant.prefix, participant.subject);
  }
}

std::optional<std::string> subject_of_requester(const Domain& domain, RequesterBook& book,
                                                const std::string& requester,
                                                const CommandLifespans::Guid& writer) {
  if (!domain.member()) return std::string();
  std::string subject = book.subject_of(writer.guidPrefix);
  if (!book.bind(requester, subject)) return std::nullopt;
  return subject;
}

namespace {

// By the wall clocks of both machines, never negative. Ages beyond kLongest count as kLongest,
// which keeps sums in range.
Duration age_of(UtcTime source, const UtcMapping& now) {
  std::int64_t age = 0;
  if (source.nanoseconds <= 0 ||
      __builtin_sub_overflow(now.utc.nanoseconds, source.nanoseconds, &age))
    age = 0;
  return Duration{std::clamp<std::int64_t>(age, 0, kLongest)};
}

}  // namespace

Instant expiry_of(UtcTime source, Duration lifespan, const UtcMapping& now) {
  return now.instant + Duration{std::min(lifespan.count(), kLongest)} - age_of(source, now);
}

std::optional<Duration> written_before(Instant listening, UtcTime source, const UtcMapping& now) {
  const Instant written = now.instant - age_of(source, now);
  return written < listening ? std::optional(listening - written) : std::nullopt;
}

CommandReceiver::CommandReceiver(Domain& domain, const CommandLifespans& lifespans,
                                 Handlers handlers, HeldTo bus)
    : domain_(domain),
      lifespans_(lifespans),
      handlers_(std::move(handlers)),
      bus_(std::move(bus)),
      listening_(handlers_.clock().instant) {
  const auto mask = dds::StatusMask::data_available();
  reader_ = bus_ ? domain.reader_of_bus(*bus_, kCommandTopic, this, mask)
                 : domain.reader(kCommandTopic, this, mask);
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
  if (!handlers_.is_ours(bus) || (bus_ && bus != *bus_)) return;
  const CommandLifespans::Guid writer = info.sample_identity.writer_guid();
  auto subject =
      subject_of_requester(domain_, lifespans_.requesters(), command.requester().c_str(), writer);
  if (!subject)
    return handlers_.on_problem("a command under the name of another's requester was dropped");
  handlers_.received(command.requester().c_str(), writer);
  const UtcTime source{info.source_timestamp.to_ns()};
  const UtcMapping now = handlers_.clock();
  if (const auto before = written_before(listening_, source, now)) {
    return handlers_.refused(
        bus, command,
        {Cause::kExpired, "it was written " +
                              to_text(std::chrono::ceil<std::chrono::milliseconds>(*before)) +
                              " before this bridge began to listen, by the clocks of both; if it "
                              "is still wanted, send it anew"});
  }
  auto converted = from_idl(command);
  if (!converted) return handlers_.refused(bus, command, converted.error());
  converted->subject = *std::move(subject);
  converted->expires = expiry_of(source, lifespans_.of(writer), now);
  handlers_.accepted(bus, std::move(*converted));
}

}  // namespace fieldcast
