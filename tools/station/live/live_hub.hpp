// Creates and notifies the clients of /live, which their sockets own. Must outlive them. Pure; on
// the io thread.
#pragma once

#include <memory>
#include <set>

#include "tools/station/live/live_client.hpp"

namespace fieldcast::web {

class LiveHub {
 public:
  // The context must outlive the hub.
  explicit LiveHub(LiveContext& context) : context_(context) {}
  LiveHub(const LiveHub&) = delete;
  LiveHub& operator=(const LiveHub&) = delete;

  [[nodiscard]] std::unique_ptr<LiveProtocol> make(const Caller& caller, LivePeer& peer);
  void on_news(Instant now);
  // Sends the outcome of a command sent by HTTP to every client of its user.
  void on_outcome(const CommandOutcome& outcome);

  [[nodiscard]] std::size_t count() const { return clients_.size(); }
  [[nodiscard]] LiveClient::Counters counters() const;

 private:
  class Member;
  void leave(Member& member);

  LiveContext& context_;
  std::set<Member*> clients_;
  LiveClient::Counters before_;  // totals of disconnected clients
};

}  // namespace fieldcast::web
