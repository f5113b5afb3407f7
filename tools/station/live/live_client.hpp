// What /live speaks with one client: its subscriptions, the newest values at the pace at which it
// takes them, its commands and their results. Pure: no socket, no clock. On the io thread.
//
// A batch is some texts and one binary frame behind them; the next one is made when that frame was
// taken, from what is newest then, and not before kPeriod. So a slow client gets fewer frames and
// never a queue. A frame of no channel follows texts alone: that it is taken tells that they are.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "tools/station/live/client_message.hpp"
#include "tools/station/live/command_sink.hpp"
#include "tools/station/live/frame_book.hpp"
#include "tools/station/live/interest_book.hpp"
#include "tools/station/live/live_model.hpp"
#include "tools/station/live/live_peer.hpp"
#include "tools/station/live/subscription.hpp"

namespace fieldcast::web {

// What all clients share; it outlives them.
struct LiveContext {
  const LiveModel& model;
  FrameBook& frames;
  InterestBook& interests;
  CommandSink& commands;
  std::function<UtcTime()> utc_now;
  std::string version;  // of the program
};

class LiveClient : public LiveProtocol {
 public:
  static constexpr Duration kPeriod = std::chrono::milliseconds{20};
  // After a pause, for what comes together: the samples of one exchange, of several buses.
  static constexpr Duration kGathering = std::chrono::milliseconds{3};
  // Between two notes that the catalogue changed.
  static constexpr Duration kCataloguePeriod = std::chrono::milliseconds{250};
  // Texts of one batch.
  static constexpr std::size_t kMaxTexts = 256;
  // Messages of the client: so many at once, and so many a second.
  static constexpr int kMaxMessages = 20;
  // Refused ones without a pause; one more ends the connection.
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

  // The model has news.
  void on_news(Instant now);
  // A command that this user sent by other means has ended.
  void on_outcome(const CommandOutcome& outcome);

  [[nodiscard]] const Caller& caller() const { return caller_; }

  struct Counters {
    std::uint64_t frames = 0;   // binary ones
    std::uint64_t dropped = 0;  // that were not made, since the client was slow
    std::uint64_t refused = 0;  // messages of the client
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
  std::map<std::string, Duration> interests_;  // by pattern: declared for this client

  bool under_way_ = false;       // a binary frame that was not taken yet
  Instant sent_{};               // when it was sent
  Instant next_{};               // no batch before
  Instant wake_ = kNever;        // what the peer was asked for
  std::uint64_t seen_ = 0;       // version of the model up to which the client has everything
  std::uint64_t objects_ = 0;    // of the objects
  std::uint64_t catalogue_ = 0;  // of the catalogue, that the client was told
  Instant next_catalogue_{};     // no note of the catalogue before
  std::uint64_t dropped_ = 0;    // frames since the client was told
  Instant counted_{};            // when one was counted last

  double allowance_ = kMaxMessages;  // messages that the client may send now
  Instant allowance_at_{};
  int refused_ = 0;  // messages since one was in time

  Counters counters_;
  // For results that come when the client is gone.
  std::shared_ptr<LiveClient*> self_ = std::make_shared<LiveClient*>(this);
};

}  // namespace fieldcast::web
