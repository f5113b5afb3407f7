#include "bridge/dds/result_sender.hpp"

#include <utility>

namespace fieldcast {

ResultSender::ResultSender(Domain& domain, const std::string& label, std::function<UtcMapping()> clock,
                           std::function<void(std::string)> on_problem)
    : domain_(domain), clock_(std::move(clock)), on_problem_(std::move(on_problem)) {
  writer_ = domain.writer<idl::CommandResultPubSubType>(kCommandResultTopic, result_writer_qos(), label, this,
                                                        dds::StatusMask::publication_matched());
}

void ResultSender::remember(const std::string& requester, const GuidPrefix& participant) {
  const std::lock_guard lock(mutex_);
  if (requesters_.size() >= kMaxRequesters && !requesters_.contains(requester)) requesters_.clear();
  requesters_[requester] = participant;
}

void ResultSender::send(const idl::CommandResult& result) {
  std::unique_lock lock(mutex_);
  const auto requester = requesters_.find(result.requester().c_str());
  const bool wait = requester != requesters_.end() && !matched_.contains(requester->second);
  Held next{wait ? requester->second : GuidPrefix{}, wait ? clock_().instant + kHold : Instant{}, result};
  if (wait) {
    held_.push_back(std::move(next));
    if (held_.size() <= kMaxHeld) return;
    next = std::move(held_.front());
    held_.pop_front();
  }
  lock.unlock();
  write(next.result);
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
  std::deque<Held> ready;
  {
    const std::lock_guard lock(mutex_);
    if (status.current_count_change < 0) {
      if (const auto found = matched_.find(participant); found != matched_.end()) matched_.erase(found);
      return;
    }
    matched_.insert(participant);
    for (auto held = held_.begin(); held != held_.end();) {
      if (held->participant != participant) {
        ++held;
        continue;
      }
      ready.push_back(std::move(*held));
      held = held_.erase(held);
    }
  }
  for (Held& held : ready) write(held.result);
}

void ResultSender::flush_overdue() {
  std::deque<Held> ready;
  {
    const std::lock_guard lock(mutex_);
    if (held_.empty()) return;
    const Instant now = clock_().instant;
    while (!held_.empty() && held_.front().until <= now) {
      ready.push_back(std::move(held_.front()));
      held_.pop_front();
    }
  }
  for (Held& held : ready) write(held.result);
}

void ResultSender::close(Duration linger) {
  std::deque<Held> ready;
  {
    const std::lock_guard lock(mutex_);
    ready = std::exchange(held_, {});
  }
  for (Held& held : ready) write(held.result);
  writer_->wait_for_acknowledgments(to_dds(linger));
  domain_.remove(writer_);
}

}  // namespace fieldcast
