// A station's side of a topic of requests and a topic of replies in parts: one request at a time.
// Its endpoints exist only from a request until end(), because every reader receives the replies to
// all stations.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <type_traits>
#include <utility>

#include "bridge/dds/receivers/taker.hpp"
#include "bridge/dds/topics/configuration_message.hpp"
#include "bridge/dds/topics/history.hpp"
#include "bridge/dds/topics/topics.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "bridge/station/station.hpp"

namespace fieldcast {

// `Parts` collects the parts of a reply: add(part) and take().
template <const auto& requests, const auto& replies, class Parts>
class RequestClient {
 public:
  using RequestPart = typename std::remove_cvref_t<decltype(requests)>::Message;
  using ReplyPart = typename std::remove_cvref_t<decltype(replies)>::Message;
  using Replied = tl::expected<decltype(std::declval<Parts&>().take()), StationFault>;

  // `requester` must be unique in the domain.
  RequestClient(Domain& domain, std::string requester)
      : domain_(domain), requester_(std::move(requester)) {}
  ~RequestClient() { end(); }
  RequestClient(const RequestClient&) = delete;
  RequestClient& operator=(const RequestClient&) = delete;

  // Calls `send(requester, request_id, write)`, which calls `write(part)` for each part of the
  // request, and waits for the reply. One thread at a time.
  template <class Send>
  [[nodiscard]] Replied request(Parts parts, Duration wait, const Send& send);
  // Removes the endpoints. The thread of request().
  void end();
  // Ends a pending request and refuses later ones. Any thread.
  void cancel();

 private:
  // After new endpoints have found a bridge. It may find this reader later than this side does, and
  // its reply would be lost.
  static constexpr Duration kSettle = std::chrono::milliseconds{500};
  // After each part: sockets of readers on this machine hold only a few.
  static constexpr Duration kPace = std::chrono::microseconds{500};

  // Each reports whether a bridge has the other endpoint. Called on DDS threads.
  struct WriterMatches : dds::DataWriterListener {
    explicit WriterMatches(RequestClient& owner) : client(owner) {}
    void on_publication_matched(dds::DataWriter*,
                                const dds::PublicationMatchedStatus& status) override {
      client.set(client.is_writer_matched_, status.current_count > 0);
    }
    RequestClient& client;
  };
  struct ReaderMatches : Taker<ReplyPart> {
    explicit ReaderMatches(RequestClient& owner)
        : Taker<ReplyPart>([&owner](const ReplyPart& part, const auto&) { owner.take(part); }),
          client(owner) {}
    void on_subscription_matched(dds::DataReader*,
                                 const dds::SubscriptionMatchedStatus& status) override {
      client.set(client.is_reader_matched_, status.current_count > 0);
    }
    RequestClient& client;
  };

  [[nodiscard]] bool begin();
  void set(bool& flag, bool value);
  void take(const ReplyPart& part);

  Domain& domain_;
  const std::string requester_;
  // Numbers of an earlier process of the same name are smaller.
  std::uint64_t next_id_ =
      static_cast<std::uint64_t>(std::chrono::system_clock::now().time_since_epoch().count());
  dds::DataWriter* writer_ = nullptr;
  dds::DataReader* reader_ = nullptr;

  std::mutex mutex_;  // protects the members below
  std::condition_variable changed_;
  std::uint64_t id_ = 0;  // of the pending request; 0: none
  std::optional<Parts> parts_;
  bool is_whole_ = false;  // parts_ has the whole reply
  bool is_writer_matched_ = false, is_reader_matched_ = false, is_cancelled_ = false;

  WriterMatches writer_matches_{*this};
  ReaderMatches reader_matches_{*this};
};

using HistoryClient = RequestClient<kHistoryRequestTopic, kHistoryBlockTopic, HistoryParts>;
using ConfigurationClient =
    RequestClient<kConfigurationRequestTopic, kConfigurationReplyTopic, ConfigurationParts>;

// An identity of an earlier version, or of another role, has no right to these topics.
template <const auto& requests, const auto& replies, class Parts>
bool RequestClient<requests, replies, Parts>::begin() {
  if (reader_ != nullptr) return true;
  try {
    if (writer_ == nullptr)
      writer_ = domain_.writer(requests, requester_, &writer_matches_,
                               dds::StatusMask::publication_matched());
    reader_ = domain_.reader(replies, &reader_matches_,
                             dds::StatusMask::data_available()
                                 << dds::StatusMask::subscription_matched());
    return true;
  } catch (const DdsError&) { return false; }
}

template <const auto& requests, const auto& replies, class Parts>
void RequestClient<requests, replies, Parts>::end() {
  if (writer_ != nullptr) domain_.remove(std::exchange(writer_, nullptr));
  if (reader_ != nullptr) domain_.remove(std::exchange(reader_, nullptr));
  is_writer_matched_ = is_reader_matched_ = false;  // no listener is called any more
}

template <const auto& requests, const auto& replies, class Parts>
void RequestClient<requests, replies, Parts>::set(bool& flag, bool value) {
  {
    const std::lock_guard lock(mutex_);
    flag = value;
  }
  changed_.notify_one();
}

template <const auto& requests, const auto& replies, class Parts>
void RequestClient<requests, replies, Parts>::cancel() {
  set(is_cancelled_, true);
}

template <const auto& requests, const auto& replies, class Parts>
template <class Send>
auto RequestClient<requests, replies, Parts>::request(Parts parts, Duration wait, const Send& send)
    -> Replied {
  const bool is_new = reader_ == nullptr;
  if (!begin()) return tl::unexpected(StationFault::kNoRight);
  const auto until = std::chrono::steady_clock::now() + wait;
  const std::uint64_t id = next_id_++;
  const auto is_cancelled = [this] { return is_cancelled_; };
  std::unique_lock lock(mutex_);
  changed_.wait_until(
      lock, until, [this] { return is_cancelled_ || (is_writer_matched_ && is_reader_matched_); });
  if (is_cancelled_ || !is_writer_matched_ || !is_reader_matched_)
    return tl::unexpected(StationFault::kNoBridge);
  if (is_new) changed_.wait_for(lock, kSettle, is_cancelled);
  id_ = id;
  parts_.emplace(std::move(parts));
  is_whole_ = false;
  bool is_first = true;
  lock.unlock();
  send(requester_, id, [&](RequestPart& part) {
    if (!std::exchange(is_first, false)) {
      lock.lock();
      changed_.wait_for(lock, kPace, is_cancelled);
      lock.unlock();
    }
    writer_->write(&part);
  });
  lock.lock();
  changed_.wait_until(lock, until, [this] { return id_ == 0 || is_cancelled_; });
  id_ = 0;
  if (!is_whole_) return tl::unexpected(StationFault::kNoResult);
  return parts_->take();
}

template <const auto& requests, const auto& replies, class Parts>
void RequestClient<requests, replies, Parts>::take(const ReplyPart& part) {
  if (part.requester() != requester_) return;
  const std::lock_guard lock(mutex_);
  if (id_ == 0 || part.request_id() != id_) return;
  const auto added = parts_->add(part);
  if (added == Parts::Added::kMore) return;
  is_whole_ = added == Parts::Added::kWhole;
  id_ = 0;
  changed_.notify_one();
}

}  // namespace fieldcast
