// Protocol of /live with one client. Pure; runs on the io thread.
//
// A batch is some texts and a binary frame. The next batch is made from the newest values when the
// kernel has accepted that frame, and not before kPeriod: a slow client gets fewer frames, without
// a queue. Texts alone are followed by an empty frame, whose acceptance shows that they were sent.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "tools/station/live/client_message.hpp"
#include "tools/station/live/frames.hpp"
#include "tools/station/live/live_peer.hpp"
#include "tools/station/model/live_model.hpp"

namespace fieldcast::web {

// Shared by all clients; must outlive them.
struct LiveContext {
  const LiveModel& model;
  FrameCache& frames;
  ClientInterests& interests;
  CommandSink& commands;
  std::function<UtcTime()> utc_now;
  std::string version;
};

class LiveClient : public LiveProtocol {
 public:
  static constexpr Duration kPeriod = std::chrono::milliseconds{20};
  // After a pause, collects samples that arrive together, for example of one exchange.
  static constexpr Duration kGathering = std::chrono::milliseconds{3};
  static constexpr Duration kCataloguePeriod = std::chrono::milliseconds{250};
  static constexpr std::size_t kMaxTexts = 256;
  // Limit of client messages: burst, and messages a second.
  static constexpr int kMaxMessages = 20;
  // Consecutive refused messages; a further one closes the connection.
  static constexpr int kMaxRefused = 40;

  LiveClient(LiveContext& context, Caller caller, LivePeer& peer);
  ~LiveClient() override;
  LiveClient(const LiveClient&) = delete;
  LiveClient& operator=(const LiveClient&) = delete;

  void on_open(Instant now) override;
  void on_text(std::string_view message, Instant now) override;
  void on_taken(Instant now) override;
  void on_wake(Instant now) override;
  void on_closed() override;

  void on_news(Instant now);
  // Reports the outcome of a command that this user sent by other means.
  void on_outcome(const CommandOutcome& outcome);

  [[nodiscard]] const Caller& caller() const { return caller_; }

  struct Counters {
    std::uint64_t frames = 0;   // binary
    std::uint64_t dropped = 0;  // skipped because the client was slow
    std::uint64_t refused = 0;  // client messages
  };
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  void send_news(Instant now);
  [[nodiscard]] bool add_texts();
  [[nodiscard]] bool add_catalogue(Instant now);
  void wake_at(Instant when);
  void refuse(std::optional<std::uint64_t> id, const Refusal& refusal);
  [[nodiscard]] bool within_rate(Instant now);

  void handle(const ClientMessage& message, Instant now);
  [[nodiscard]] std::optional<Refusal> subscribe(const Subscribe& wanted, Instant now);
  [[nodiscard]] std::optional<Refusal> unsubscribe(const Unsubscribe& wanted);
  [[nodiscard]] std::optional<Refusal> submit(std::optional<std::uint64_t> id,
                                              StationCommand command);
  [[nodiscard]] std::optional<Refusal> write(std::optional<std::uint64_t> id,
                                             const WriteChannel& wanted);
  [[nodiscard]] tl::expected<const LiveChannel*, Refusal> commanded(const ChannelPath& path) const;
  void withdraw_all();

  LiveContext& context_;
  const Caller caller_;
  LivePeer& peer_;
  bool open_ = false;
  LiveSubscription subscription_;
  std::map<std::string, Duration> interests_;  // declared for this client, by pattern

  bool under_way_ = false;       // the last binary frame was not accepted yet
  Instant sent_{};               // when it was sent
  Instant next_{};               // no batch before this time
  Instant wake_ = kNever;        // requested wake time
  std::uint64_t seen_ = 0;       // version of the model that the client has
  std::uint64_t objects_ = 0;    // version of the objects that the client has
  std::uint64_t catalogue_ = 0;  // version of the last catalogue notice
  Instant next_catalogue_{};     // no catalogue notice before this time
  std::uint64_t dropped_ = 0;    // skipped frames since the last report to the client
  Instant counted_{};            // time of the last skipped frame

  double allowance_ = kMaxMessages;  // messages that the client may send now
  Instant allowance_at_{};
  int refused_ = 0;  // consecutive refused messages

  Counters counters_;
  // Weakly held by callbacks of commands, which can outlive the client.
  std::shared_ptr<LiveClient*> self_ = std::make_shared<LiveClient*>(this);
};

// Creates and notifies the clients of /live, which their sockets own. Must outlive them. Pure; on
// the io thread.
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
