// The commands of one bus: checked when they arrive, one on the wire at a time, each ended by
// exactly one result. Requesters are served in turn; the commands of one requester keep their
// order.
//
// Owns the waiting commands and the instant of each channel's last write. Owned by the bus engine,
// on the bus's thread. What can fail: a command is refused with its cause. What a requester and
// the whole queue may hold is limited; the requester that has the most is refused with kQueueFull.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/bus/action_sink.hpp"
#include "core/bus/bus_setup.hpp"
#include "core/bus/channel_table.hpp"
#include "core/bus/command_job.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

class CommandQueue {
 public:
  static constexpr std::size_t kMaxWaiting = 1024;
  static constexpr std::size_t kMaxBytes = std::size_t{8} << 20;  // of all that wait
  static constexpr std::size_t kMaxBytesOfRequester = kMaxBytes / 2;
  static constexpr std::size_t kMaxBatch = 64;  // commands in one request

  // What keeps a command from the wire at this moment, whatever it asks.
  struct Condition {
    BusState bus = BusState::kRunning;
    bool device_offline = false;
  };
  // One request, for the first `batch` commands of the queue.
  struct Next {
    DeviceIndex device = 0;
    Request request;
    std::size_t batch = 1;
  };
  // From when on the next request of a job may be sent.
  using Gate = std::function<Instant(const CommandJob&)>;

  // setup, channels and codec outlive the queue.
  CommandQueue(const BusSetup& setup, ChannelTable& channels, TextCodec& codec);

  // Takes the command, or completes it with the reason against it. A reason that will never change
  // (read-only, out of range) goes before one that may pass (port closed, device offline). While
  // the port is being opened, a command waits: it is sent then, or refused when that failed.
  void accept(const Command& command, const Condition& condition, Instant now, ActionSink& sink);

  // The request of the first command whose device may be asked now. That command stays the first
  // until it is finished. `echo_unknown`: whether the line echoes is not known yet.
  [[nodiscard]] std::optional<Next> next(Instant now, const Gate& gate, bool echo_unknown);
  // The request of the last next() was answered, or failed. `acquired`: arrival of the answer.
  void answered(std::size_t batch, const Reply& reply, Instant acquired, Instant now,
                ActionSink& sink);
  void failed(std::size_t batch, Cause cause, std::uint16_t code, Instant acquired, Instant now,
              ActionSink& sink, std::string_view seen = {});
  // It did not leave: its commands wait as before, and may expire.
  void not_sent(std::size_t batch);

  // Completes what may no longer begin. What has begun is never called back. `bus`: for the reason.
  void expire(BusState bus, Instant now, ActionSink& sink);
  [[nodiscard]] Instant next_expiry() const;
  // Completes every command with this reason.
  void refuse_all(Cause cause, const std::string& reason, Instant now, ActionSink& sink);

  [[nodiscard]] bool empty() const { return waiting_.empty(); }
  [[nodiscard]] const Command* first() const {
    return waiting_.empty() ? nullptr : &waiting_.front().job.command();
  }
  // The first command has begun and is not finished.
  [[nodiscard]] bool begun() const { return begun_; }
  // When a command may be sent: the one that has begun, or else the first that may.
  [[nodiscard]] Instant sendable_from(const Gate& gate) const;
  // Commands that came to their end on the wire.
  [[nodiscard]] std::uint64_t done() const { return done_; }

 private:
  // What one requester has in the queue.
  struct Owner {
    std::size_t commands = 0;
    std::size_t bytes = 0;
    std::uint64_t turn = 0;  // when it was served, or its first command arrived
  };
  struct Waiting {
    CommandJob job;
    Instant received{};
    Owner* owner = nullptr;  // in owners_
  };
  [[nodiscard]] std::optional<CommandFault> make_room(const Command& command, Instant now,
                                                      ActionSink& sink);
  // The newest command, not begun, of the requester with the most, if that has more than `own`.
  [[nodiscard]] std::deque<Waiting>::iterator newest_of_most(bool by_bytes, const Owner& own);
  [[nodiscard]] std::deque<Waiting>::iterator next_in_turn(Instant now, const Gate& gate);
  void left(const Waiting& waiting);  // before it is removed
  [[nodiscard]] tl::expected<CommandJob, CommandFault> check(const Command& command,
                                                             const Condition& condition,
                                                             Instant now) const;
  [[nodiscard]] std::optional<CommandFault> obstacle(const CommandJob& job,
                                                     const Condition& condition, Instant now) const;
  [[nodiscard]] std::size_t gather(WriteRequest& write);
  void finish(std::size_t batch, Instant acquired, Instant now, ActionSink& sink);
  void complete(const Waiting& finished, Instant acquired, Instant now, ActionSink& sink);

  const BusSetup& setup_;
  ChannelTable& channels_;
  TextCodec& codec_;
  std::deque<Waiting> waiting_;                       // as they arrived; what has begun is first
  std::map<std::string, Owner, std::less<>> owners_;  // by requester, as long as it has commands
  std::size_t bytes_ = 0;
  std::uint64_t turn_ = 0;
  std::vector<Instant> last_write_;  // of each channel
  bool begun_ = false;
  std::uint64_t done_ = 0;
};

}  // namespace fieldcast
