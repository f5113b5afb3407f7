#include "tools/station/live/live_hub.hpp"

namespace fieldcast::web {
namespace {

void add(LiveClient::Counters& to, const LiveClient::Counters& more) {
  to.frames += more.frames;
  to.dropped += more.dropped;
  to.refused += more.refused;
}

}  // namespace

class LiveHub::Member : public LiveClient {
 public:
  Member(LiveHub& hub, const Caller& caller, LivePeer& peer)
      : LiveClient(hub.context_, caller, peer), hub_(hub) {}
  ~Member() override { hub_.leave(*this); }
  Member(const Member&) = delete;
  Member& operator=(const Member&) = delete;

 private:
  LiveHub& hub_;
};

std::unique_ptr<LiveProtocol> LiveHub::make(const Caller& caller, LivePeer& peer) {
  auto client = std::make_unique<Member>(*this, caller, peer);
  clients_.insert(client.get());
  return client;
}

void LiveHub::leave(Member& member) {
  add(before_, member.counters());
  clients_.erase(&member);
}

void LiveHub::on_news(Instant now) {
  for (Member* client : clients_) client->on_news(now);
}

void LiveHub::on_outcome(const CommandOutcome& outcome) {
  for (Member* client : clients_) {
    if (client->caller().user == outcome.user) client->on_outcome(outcome);
  }
}

LiveClient::Counters LiveHub::counters() const {
  LiveClient::Counters all = before_;
  for (const Member* client : clients_) add(all, client->counters());
  return all;
}

}  // namespace fieldcast::web
