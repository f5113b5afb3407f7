// Watches the folder of a member while its participant is in the domain, on a thread, "members",
// every kPeriod. A new list of revoked certificates takes effect immediately; a renewed certificate
// is only reported, because Fast DDS 2.9.1 reads it when a participant is created. A refused
// participant stays refused until the process ends. A list that the authority has not signed is
// ignored and reported. A pause of the process or the machine beyond the participant's lease is
// reported, also by report_removed().
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "bridge/dds/filter/incoming_filter.hpp"
#include "bridge/dds/library/fastdds.hpp"
#include "bridge/dds/topics/topics.hpp"
#include "bridge/dds/transport/server_restarts.hpp"

namespace fieldcast {

class MemberWatch {
 public:
  static constexpr auto kPeriod = std::chrono::milliseconds{500};

  // `participant` must outlive this object.
  MemberWatch(std::string folder, std::shared_ptr<IncomingFilter> filter,
              dds::DomainParticipant& participant);
  ~MemberWatch();
  MemberWatch(const MemberWatch&) = delete;
  MemberWatch& operator=(const MemberWatch&) = delete;

  // Returns true if the folder has another valid certificate than at construction. Any thread.
  [[nodiscard]] bool has_new_identity() const;

 private:
  void run();
  void read_list();
  void look_at_identity();
  void look_at_refused();
  void look_at_pause(Duration pause);

  const std::string folder_;
  const std::shared_ptr<IncomingFilter> filter_;
  dds::DomainParticipant& participant_;
  const std::string identity_;
  std::uint64_t say_refused_ = 1;  // next count of messages in clear to report
  std::uint32_t renewed_ = 0;      // successive checks that saw another certificate
  std::string list_;               // the last valid one
  std::uint32_t wrong_ = 0;        // successive checks that saw an invalid file
  std::set<std::string> refused_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ends_ = false;
  std::thread thread_;  // last member: it uses the members above
};

// Tracks which configured discovery servers respond, as Fast DDS does not report that, and bridges
// without a writer, which DDS Security may still authenticate. Forwards all discovery to another
// listener, with the subject that IncomingFilter has stored, and reports servers to ServerRestarts.
// missing() and unknown_bridges(): any thread.

// Prefix of a bridge's participant name, before the name of the bridge.
inline constexpr std::string_view kBridgeParticipant = "fieldcast-bridge ";

class ServerWatch : public DiscoveryListener {
 public:
  static constexpr std::size_t kMostBridges = 4096;  // further bridges are not tracked

  // `servers` as in DdsSpec. `other` must outlive this object; may be null. `filter` is null
  // without DDS Security.
  ServerWatch(std::vector<std::string> servers, std::shared_ptr<IncomingFilter> filter,
              DiscoveryListener* other)
      : servers_(std::move(servers)),
        here_(servers_.size()),
        restarts_(servers_.empty() ? nullptr : std::make_shared<ServerRestarts>()),
        filter_(std::move(filter)),
        other_(other) {}

  // Used by the transport for received messages; null without servers.
  [[nodiscard]] const std::shared_ptr<ServerRestarts>& restarts() const { return restarts_; }

  // Servers that were never found, or were removed after their lease.
  [[nodiscard]] std::vector<std::string> missing() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> missing;
    for (std::size_t i = 0; i < servers_.size(); ++i) {
      if (!here_[i]) missing.push_back(servers_[i]);
    }
    return missing;
  }

  [[nodiscard]] std::size_t unknown_bridges() const {
    const std::lock_guard lock(mutex_);
    return unknown_.size();
  }

 private:
  void on_writer(const FoundWriter& writer) override {
    {
      const std::lock_guard lock(mutex_);
      if (writer.topic == kBridgeTopic.name) unknown_.erase(writer.guid.guidPrefix);
    }
    if (other_ != nullptr) other_->on_writer(writer);
  }
  void on_participant(const FoundParticipant& participant) override {
    ParticipantPrefix prefix{};
    std::ranges::copy(participant.prefix.value, prefix.begin());
    if (const auto identity = server_identity(participant.prefix);
        identity && *identity < servers_.size()) {
      restarts_->on_server(*identity, !participant.gone);
      const std::lock_guard lock(mutex_);
      here_[*identity] = !participant.gone;
    } else if (restarts_ && !identity) {
      restarts_->on_other(prefix, !participant.gone);
    }
    if (participant.name.starts_with(kBridgeParticipant)) {
      const std::lock_guard lock(mutex_);
      if (participant.gone) {
        unknown_.erase(participant.prefix);
        known_.erase(participant.prefix);
      } else if (known_.size() < kMostBridges && known_.insert(participant.prefix).second) {
        unknown_.insert(participant.prefix);
      }
    }
    if (other_ == nullptr) return;
    FoundParticipant named = participant;
    if (filter_ != nullptr) named.subject = filter_->subject_of(prefix);
    other_->on_participant(named);
  }

  const std::vector<std::string> servers_;
  mutable std::mutex mutex_;
  std::vector<bool> here_;
  std::set<rtps::GuidPrefix_t> known_, unknown_;  // bridges that are there; of them the unknown
  const std::shared_ptr<ServerRestarts> restarts_;
  const std::shared_ptr<IncomingFilter> filter_;
  DiscoveryListener* const other_;
};

}  // namespace fieldcast
