#include "bridge/dds/receivers/request_receiver.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>

#include "bridge/security/subject.hpp"

namespace fieldcast {

void RequesterRegistry::found(const Participant& participant, std::string_view slashed) {
  const auto subject = security::subject_from(slashed);
  if (!subject) return;
  const security::GuidStart start = security::guid_start(*subject);
  if (!std::equal(start.begin(), start.end(), participant.value)) return;
  const std::lock_guard lock(mutex_);
  if (subjects_.size() < kMaxParticipants || subjects_.contains(participant))
    subjects_[participant] = subject->text();
}

void RequesterRegistry::lost(const Participant& participant) {
  const std::lock_guard lock(mutex_);
  subjects_.erase(participant);
}

std::string RequesterRegistry::subject_of(const Participant& participant) const {
  const std::lock_guard lock(mutex_);
  const auto found = subjects_.find(participant);
  return found == subjects_.end() ? std::string(kUnknown) : found->second;
}

bool RequesterRegistry::bind(const std::string& requester, const std::string& subject) {
  const std::lock_guard lock(mutex_);
  const auto [owner, made] = owners_.try_emplace(requester, subject);
  if (!made) return owner->second == subject;
  oldest_.push_back(requester);
  if (oldest_.size() > kMaxRequesters) {
    owners_.erase(oldest_.front());
    oldest_.pop_front();
  }
  return true;
}

namespace {

constexpr std::int64_t kLongestAge = std::int64_t{1} << 60;  // nanoseconds, 36 years

// Age by the wall clocks of both machines, 0 to kLongestAge, so that sums do not overflow.
Duration age_of(UtcTime source, const UtcMapping& now) {
  std::int64_t age = 0;
  if (source.nanoseconds <= 0 ||
      __builtin_sub_overflow(now.utc.nanoseconds, source.nanoseconds, &age))
    age = 0;
  return Duration{std::clamp<std::int64_t>(age, 0, kLongestAge)};
}

// "2026-11-25 12:00:00.250 UTC". REQUIRES: after 1970.
std::string utc_text(UtcTime time) {
  const auto milliseconds = time.nanoseconds / 1'000'000;
  return fmt::format("{:%Y-%m-%d %H:%M:%S}.{:03} UTC",
                     fmt::gmtime(static_cast<std::time_t>(milliseconds / 1000)),
                     milliseconds % 1000);
}

}  // namespace

std::string RequestWriters::subject_of(const Domain& domain, const Guid& writer) const {
  return domain.member() ? requesters_.subject_of(writer.guidPrefix) : std::string();
}

std::optional<RequestTerms> RequestWriters::terms_of(const Domain& domain,
                                                     const std::string& requester,
                                                     const RequestOrigin& origin,
                                                     const UtcMapping& now) const {
  RequestTerms terms;
  terms.subject = subject_of(domain, origin.writer);
  if (!terms.subject.empty() && !requesters_.bind(requester, terms.subject)) return std::nullopt;
  if (const auto before = written_before(origin.listening, origin.source, now))
    terms.too_early =
        fmt::format("written {} before this bridge began to listen; send it again. It was {}",
                    to_text(std::chrono::ceil<std::chrono::milliseconds>(*before)),
                    clocks_text(origin.source, now));
  {
    const std::lock_guard lock(mutex_);
    const auto known = lifespans_.find(origin.writer);
    const Duration lifespan = known == lifespans_.end() ? kDefault : known->second;
    terms.expires = expiry_of(origin.source, lifespan, now);
  }
  if (terms.expires <= now.instant)
    terms.late = fmt::format("{}: {}", to_text(Cause::kExpired), clocks_text(origin.source, now));
  return terms;
}

void RequestWriters::on_writer(const FoundWriter& writer) {
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

void RequestWriters::on_participant(const FoundParticipant& participant) {
  if (participant.gone) {
    requesters_.lost(participant.prefix);
  } else if (!participant.subject.empty()) {
    requesters_.found(participant.prefix, participant.subject);
  }
}

Instant expiry_of(UtcTime source, Duration lifespan, const UtcMapping& now) {
  return now.instant + Duration{std::min(lifespan.count(), kLongestAge)} - age_of(source, now);
}

std::string clocks_text(UtcTime source, const UtcMapping& now) {
  if (source.nanoseconds <= 0) return {};
  const double seconds = std::chrono::duration<double>(age_of(source, now)).count();
  return fmt::format(
      "written at {}, received at {} by this bridge's clock: the requester's clock is {:.1f} s "
      "behind, or the request was late by that",
      utc_text(source), utc_text(now.utc), seconds);
}

std::optional<Duration> written_before(Instant listening, UtcTime source, const UtcMapping& now) {
  const Instant written = now.instant - age_of(source, now);
  return written < listening ? std::optional(listening - written) : std::nullopt;
}

}  // namespace fieldcast
