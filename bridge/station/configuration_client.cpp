#include "bridge/station/configuration_client.hpp"

#include <chrono>
#include <thread>
#include <utility>

namespace fieldcast {

ConfigurationClient::ConfigurationClient(Domain& domain, std::string requester)
    : domain_(domain),
      requester_(std::move(requester)),
      // Numbers of an earlier process of the same name are smaller.
      next_id_(
          static_cast<std::uint64_t>(std::chrono::system_clock::now().time_since_epoch().count())),
      taker_([this](const idl::ConfigurationReply& part, const auto&) { take(part); }) {}

// An identity of another role has no right to these topics.
bool ConfigurationClient::begin() {
  try {
    if (writer_ == nullptr) writer_ = domain_.writer(kConfigurationRequestTopic, requester_);
    if (reader_ == nullptr)
      reader_ =
          domain_.reader(kConfigurationReplyTopic, &taker_, dds::StatusMask::data_available());
    return true;
  } catch (const DdsError&) { return false; }
}

void ConfigurationClient::end() {
  if (writer_ != nullptr) domain_.remove(std::exchange(writer_, nullptr));
  if (reader_ != nullptr) domain_.remove(std::exchange(reader_, nullptr));
}

bool ConfigurationClient::is_cancelled() {
  const std::lock_guard lock(mutex_);
  return is_cancelled_;
}

void ConfigurationClient::cancel() {
  {
    const std::lock_guard lock(mutex_);
    is_cancelled_ = true;
  }
  changed_.notify_one();
}

bool ConfigurationClient::is_matched() const {
  dds::PublicationMatchedStatus written;
  dds::SubscriptionMatchedStatus read;
  writer_->get_publication_matched_status(written);
  reader_->get_subscription_matched_status(read);
  return written.current_count > 0 && read.current_count > 0;
}

tl::expected<std::string, StationFault> ConfigurationClient::request(const std::string& bridge,
                                                                     std::string text,
                                                                     Duration wait) {
  const bool is_new = reader_ == nullptr;
  if (!begin()) return tl::unexpected(StationFault::kNoRight);
  const auto until = std::chrono::steady_clock::now() + wait;
  while (!is_matched()) {
    if (std::chrono::steady_clock::now() >= until || is_cancelled())
      return tl::unexpected(StationFault::kNoBridge);
    std::this_thread::sleep_for(kLook);
  }
  // The bridge may match this reader later than this side does; its reply would be lost until then.
  if (is_new) std::this_thread::sleep_for(kSettle);
  const ConfigurationMessage message{requester_, next_id_++, bridge, std::move(text)};
  {
    const std::lock_guard lock(mutex_);
    id_ = message.request_id;
    parts_ = {};
    reply_.reset();
  }
  to_parts<idl::ConfigurationRequest>(message, [this](idl::ConfigurationRequest& part) {
    writer_->write(&part);
    if (!part.last()) std::this_thread::sleep_for(kPace);
  });
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, until, [this] { return id_ == 0 || is_cancelled_; });
  id_ = 0;
  if (!reply_) return tl::unexpected(StationFault::kNoResult);
  return *std::exchange(reply_, std::nullopt);
}

void ConfigurationClient::take(const idl::ConfigurationReply& part) {
  if (part.requester() != requester_) return;
  const std::lock_guard lock(mutex_);
  if (id_ == 0 || part.request_id() != id_) return;
  const auto added = parts_.add(part);
  if (added == ConfigurationParts::Added::kMore) return;
  if (added == ConfigurationParts::Added::kWhole) reply_ = parts_.take();
  id_ = 0;
  changed_.notify_one();
}

}  // namespace fieldcast
