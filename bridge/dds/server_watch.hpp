// Which of the discovery servers that a configuration names have answered: without one nobody is
// found, and Fast DDS says nothing. Stands before another listener of the participant, which
// it tells everything, and tells ServerRestarts which servers the library knows. Called by threads
// of the library; missing() on any thread.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "bridge/dds/fastdds.hpp"
#include "bridge/dds/server_restarts.hpp"

namespace fieldcast {

class ServerWatch : public DiscoveryListener {
 public:
  // `servers` as in DdsSpec. The other listener outlives it; may be null.
  ServerWatch(std::vector<std::string> servers, DiscoveryListener* other)
      : servers_(std::move(servers)),
        here_(servers_.size()),
        restarts_(servers_.empty() ? nullptr : std::make_shared<ServerRestarts>()),
        other_(other) {}

  // What the transport asks about what comes; null without servers.
  [[nodiscard]] const std::shared_ptr<ServerRestarts>& restarts() const { return restarts_; }

  // Those that are not there: never found, or given up after their lease.
  [[nodiscard]] std::vector<std::string> missing() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> missing;
    for (std::size_t i = 0; i < servers_.size(); ++i) {
      if (!here_[i]) missing.push_back(servers_[i]);
    }
    return missing;
  }

 private:
  void on_writer(const FoundWriter& writer) override {
    if (other_ != nullptr) other_->on_writer(writer);
  }
  void on_participant(const FoundParticipant& participant) override {
    if (const auto identity = server_identity(participant.prefix);
        identity && *identity < servers_.size()) {
      restarts_->on_server(*identity, !participant.gone);
      const std::lock_guard lock(mutex_);
      here_[*identity] = !participant.gone;
    }
    if (other_ != nullptr) other_->on_participant(participant);
  }

  const std::vector<std::string> servers_;
  mutable std::mutex mutex_;
  std::vector<bool> here_;
  const std::shared_ptr<ServerRestarts> restarts_;
  DiscoveryListener* const other_;
};

}  // namespace fieldcast
