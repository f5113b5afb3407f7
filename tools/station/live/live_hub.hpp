// The clients of /live: made by it, woken by it when there is news. Pure; on the io thread. It
// outlives its clients, whom their sockets own.
#pragma once

#include <memory>
#include <set>

#include "tools/station/live/live_client.hpp"

namespace fieldcast::web {

class LiveHub {
 public:
  // The context outlives the hub.
  explicit LiveHub(LiveContext& context) : context_(context) {}
  LiveHub(const LiveHub&) = delete;
  LiveHub& operator=(const LiveHub&) = delete;

  [[nodiscard]] std::unique_ptr<LiveProtocol> make(const Caller& caller, LivePeer& peer);
  // The model has news.
  void on_news(Instant now);
  // A command that came by HTTP has ended: told to every client of its user.
  void on_outcome(const CommandOutcome& outcome);

  [[nodiscard]] std::size_t count() const { return clients_.size(); }
  // Of all clients since the start.
  [[nodiscard]] LiveClient::Counters counters() const;

 private:
  class Member;
  void leave(Member& member);

  LiveContext& context_;
  std::set<Member*> clients_;
  LiveClient::Counters before_;  // of clients that are gone
};

}  // namespace fieldcast::web
