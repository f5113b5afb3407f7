#include "bridge/dds/result_sender.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {

namespace {

// RTPS 2.2, 9.3.1.5: a participant's identity begins with its vendor. Readers of Fast DDS keep what comes before the first
// heartbeat.
bool is_fast_dds(const ResultSender::GuidPrefix& participant) {
  const auto& vendor = eprosima::fastrtps::rtps::c_VendorId_eProsima;
  return participant.value[0] == vendor[0] && participant.value[1] == vendor[1];
}

}  // namespace

ResultSender::ResultSender(Domain& domain, const std::string& label, std::function<UtcMapping()> clock,
                           std::function<void(std::string)> on_problem)
    : domain_(domain), clock_(std::move(clock)), on_problem_(std::move(on_problem)) {
  writer_ = domain.writer<idl::CommandResultPubSubType>(kCommandResultTopic, result_writer_qos(), label, this,
                                                        dds::StatusMask::publication_matched());
  thread_ = std::thread([this] { send_overdue(); });
}

ResultSender::~ResultSender() {
  if (writer_ != nullptr) close(Duration::zero());
}

void ResultSender::remember(const std::string& requester, const GuidPrefix& participant) {
  const std::lock_guard lock(mutex_);
  const auto known = requesters_.find(requester);
  if (known != requesters_.end() && known->second.participant == participant) return;
  if (requesters_.size() >= kMaxRequesters) requesters_.clear();
  requesters_[requester] = {participant, clock_().instant};
}

std::optional<Instant> ResultSender::hold_until(const Requester& requester, Instant now) const {
  const auto match = matched_.find(requester.participant);
  if (match == matched_.end()) return now + kHold;
  if (is_fast_dds(requester.participant)) return std::nullopt;
  const Instant settled = std::max(requester.heard, match->second.since) + kSettle;
  return settled > now ? std::optional(settled) : std::nullopt;
}

void ResultSender::send(const idl::CommandResult& result) {
  std::unique_lock lock(mutex_);
  idl::CommandResult next = result;
  if (const auto requester = requesters_.find(result.requester().c_str()); requester != requesters_.end()) {
    if (const auto until = hold_until(requester->second, clock_().instant)) {
      held_.push_back({requester->second.participant, *until, std::move(next)});
      changed_.notify_one();
      if (held_.size() <= kMaxHeld) return;
      next = std::move(held_.front().result);
      held_.pop_front();
    }
  }
  lock.unlock();
  write(next);
}

void ResultSender::write(idl::CommandResult& result) {
  bool written = writer_->write(&result);
  if (!written) {
    // Full of results that are not acknowledged yet. The library waits for room for samples, but not for instances.
    writer_->wait_for_acknowledgments(to_dds(kWaitForRoom));
    written = writer_->write(&result);
  }
  if (!written) {
    on_problem_("result " + std::to_string(result.request_id()) + " of " + result.requester().c_str() +
                " was not sent: readers do not acknowledge");
    return;
  }
  writer_->unregister_instance(&result, dds::HANDLE_NIL);
}

void ResultSender::on_publication_matched(dds::DataWriter*, const dds::PublicationMatchedStatus& status) {
  const GuidPrefix participant = eprosima::fastrtps::rtps::iHandle2GUID(status.last_subscription_handle).guidPrefix;
  const std::lock_guard lock(mutex_);
  if (status.current_count_change < 0) {
    const auto match = matched_.find(participant);
    if (match != matched_.end() && --match->second.readers == 0) matched_.erase(match);
    return;
  }
  const Instant now = clock_().instant;
  Match& match = matched_[participant];
  ++match.readers;
  match.since = now;
  for (Held& held : held_) {
    if (held.participant == participant) held.until = is_fast_dds(participant) ? now : now + kSettle;
  }
  changed_.notify_one();
}

void ResultSender::send_overdue() {
  std::unique_lock lock(mutex_);
  while (!closing_) {
    const Instant now = clock_().instant;
    const auto next =
        std::min_element(held_.begin(), held_.end(), [](const Held& a, const Held& b) { return a.until < b.until; });
    if (next == held_.end()) {
      changed_.wait(lock);
    } else if (next->until > now) {
      changed_.wait_for(lock, next->until - now);
    } else {
      idl::CommandResult result = std::move(next->result);
      held_.erase(next);
      lock.unlock();
      write(result);
      lock.lock();
    }
  }
}

void ResultSender::close(Duration linger) {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
    changed_.notify_one();
  }
  thread_.join();
  std::deque<Held> last;
  {
    const std::lock_guard lock(mutex_);
    last.swap(held_);
  }
  for (Held& held : last) write(held.result);
  writer_->wait_for_acknowledgments(to_dds(linger));
  domain_.remove(std::exchange(writer_, nullptr));
}

}  // namespace fieldcast
