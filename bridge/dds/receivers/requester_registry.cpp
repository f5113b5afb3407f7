#include "bridge/dds/receivers/requester_registry.hpp"

#include <algorithm>

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

}  // namespace fieldcast
