#include "bridge/station/history_client.hpp"

#include <chrono>
#include <utility>

namespace fieldcast {

HistoryClient::HistoryClient(Domain& domain, std::string requester)
    : domain_(domain),
      requester_(std::move(requester)),
      // Numbers of an earlier process of the same name are smaller.
      next_id_(
          static_cast<std::uint64_t>(std::chrono::system_clock::now().time_since_epoch().count())) {
}

// An identity of an earlier version has no right to these topics.
bool HistoryClient::begin() {
  if (reader_ != nullptr) return true;
  try {
    if (writer_ == nullptr)
      writer_ = domain_.writer(kHistoryRequestTopic, requester_, &writer_matches_,
                               dds::StatusMask::publication_matched());
    reader_ = domain_.reader(kHistoryBlockTopic, &reader_matches_,
                             dds::StatusMask::data_available()
                                 << dds::StatusMask::subscription_matched());
    return true;
  } catch (const DdsError&) { return false; }
}

void HistoryClient::end() {
  if (writer_ != nullptr) domain_.remove(std::exchange(writer_, nullptr));
  if (reader_ != nullptr) domain_.remove(std::exchange(reader_, nullptr));
  is_writer_matched_ = is_reader_matched_ = false;  // no listener is called any more
}

void HistoryClient::set(bool& is_matched, bool value) {
  {
    const std::lock_guard lock(mutex_);
    is_matched = value;
  }
  changed_.notify_one();
}

tl::expected<HistoryResponse, StationFault> HistoryClient::request(HistoryRequest request,
                                                                   Duration wait) {
  if (!begin()) return tl::unexpected(StationFault::kNoRight);
  const auto until = std::chrono::steady_clock::now() + wait;
  request.requester = requester_;
  request.request_id = next_id_++;
  {
    std::unique_lock lock(mutex_);
    const auto is_matched = [this] { return is_writer_matched_ && is_reader_matched_; };
    if (!changed_.wait_until(lock, until, is_matched))
      return tl::unexpected(StationFault::kNoBridge);
    id_ = request.request_id;
    parts_.emplace(request);
    response_.reset();
  }
  idl::HistoryRequest message;
  to_idl(request, message);
  writer_->write(&message);
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, until, [this] { return id_ == 0; });
  id_ = 0;
  if (!response_) return tl::unexpected(StationFault::kNoResult);
  return *std::exchange(response_, std::nullopt);
}

void HistoryClient::take(const idl::HistoryBlock& block) {
  if (block.requester() != requester_) return;
  const std::lock_guard lock(mutex_);
  if (id_ == 0 || block.request_id() != id_) return;
  const HistoryParts::Added added = parts_->add(block);
  if (added == HistoryParts::Added::kMore) return;
  if (added == HistoryParts::Added::kWhole) response_ = parts_->take();
  id_ = 0;
  changed_.notify_one();
}

}  // namespace fieldcast
