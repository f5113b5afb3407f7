// The commands of one bus, one on the wire at a time, each completed with exactly one result.
// Requesters are served in turn; each requester's commands keep their order. Queue and shares are
// limited; a full queue rejects the requester with the most commands (kQueueFull). Reads in spare
// time are served after all other commands; those of the gateway also by each response of the
// device that contains their items. On the bus's thread.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/bus/command/channel_table.hpp"
#include "core/bus/command/command_job.hpp"
#include "core/bus/command/response_cache.hpp"
#include "core/bus/setup/bus_setup.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

class CommandQueue {
 public:
  static constexpr std::size_t kMaxWaiting = 1024;
  static constexpr std::size_t kMaxBytes = std::size_t{8} << 20;
  static constexpr std::size_t kMaxBytesOfRequester = kMaxBytes / 2;
  static constexpr std::size_t kMaxBatch = 64;

  struct Condition {
    BusState bus = BusState::kRunning;
    bool device_offline = false;
  };
  struct Next {
    DeviceIndex device = 0;
    Request request;
    std::size_t batch = 1;
  };
  using Gate = std::function<Instant(const CommandJob&)>;

  CommandQueue(const BusSetup& setup, ChannelTable& channels, TextCodec& codec);

  // Accepts the command, or completes it with the reason for the rejection. A permanent reason
  // precedes a temporary one. While the port is opening the command waits.
  void accept(const Command& command, const Condition& condition, Instant now, ActionSink& sink);

  // The first command whose device can be polled. A write stays first until it is finished; other
  // commands may come between two requests of a read.
  [[nodiscard]] std::optional<Next> next(Instant now, const Gate& gate, bool echo_unknown);
  // Result of the request of the last next(). `acquired`: arrival of the response.
  void responded(std::size_t batch, const Reply& reply, Instant acquired, Instant now,
                 ActionSink& sink);
  void failed(std::size_t batch, Cause cause, std::uint16_t code, Instant acquired, Instant now,
              ActionSink& sink, std::string_view seen = {});
  void not_sent(std::size_t batch);

  // The device responded to any read of the bus, which has a gateway. Stores the response, and
  // completes the gateway's reads that it contains.
  void read(DeviceIndex device, DeviceResponse response, Instant now, ActionSink& sink);
  // A write to the device was sent; stored responses may differ from its items now.
  void written(DeviceIndex device) { responses_.forget(device); }

  // Only commands that were not started can expire. `bus` is used in the reason.
  void expire(BusState bus, Instant now, ActionSink& sink);
  [[nodiscard]] Instant next_expiry() const;
  void refuse_all(Cause cause, const std::string& reason, Instant now, ActionSink& sink);

  [[nodiscard]] bool empty() const { return waiting_.empty(); }
  // Whether a waiting command is for this device.
  [[nodiscard]] bool uses(DeviceIndex device) const;
  // Whether any command is no read in spare time: no other request may be in flight with it.
  [[nodiscard]] bool alone() const { return alone_ > 0; }
  [[nodiscard]] const Command* first() const {
    return waiting_.empty() ? nullptr : &waiting_.front().job.command();
  }
  // A write was begun: its next request follows immediately. Reads may come between requests of a
  // read.
  [[nodiscard]] bool keeps_wire() const {
    return begun_ && first()->operation == Operation::kWrite;
  }
  [[nodiscard]] Instant sendable_from(const Gate& gate) const;
  [[nodiscard]] std::uint64_t done() const { return done_; }

 private:
  struct Owner {
    std::size_t commands = 0;
    std::size_t bytes = 0;
    std::uint64_t turn = 0;  // order of service; set on the first command and on each service
  };
  struct Waiting {
    CommandJob job;
    Instant received{};
    Owner* owner = nullptr;
  };
  [[nodiscard]] std::optional<CommandFault> make_room(const Command& command, Instant now,
                                                      ActionSink& sink);
  // A command that was not started; empty if no requester has more than `own`.
  [[nodiscard]] std::deque<Waiting>::iterator newest_of_most(bool by_bytes, const Owner& own);
  [[nodiscard]] std::deque<Waiting>::iterator next_in_turn(Instant now, const Gate& gate);
  void left(const Waiting& waiting);
  [[nodiscard]] tl::expected<CommandJob, CommandFault> check(const Command& command,
                                                             const Condition& condition,
                                                             Instant now) const;
  [[nodiscard]] std::optional<CommandFault> obstacle(const CommandJob& job,
                                                     const Condition& condition, Instant now) const;
  [[nodiscard]] std::size_t gather(WriteRequest& write);
  void finish(std::size_t batch, Instant acquired, Instant now, ActionSink& sink);
  [[nodiscard]] bool first_is_begun_write() const;
  // Completes a gateway's read, if the response contains its items and is fresh enough.
  [[nodiscard]] bool complete_from(const DeviceResponse& response, CommandJob& job,
                                   Instant received, Instant now, ActionSink& sink) const;

  const BusSetup& setup_;
  ChannelTable& channels_;
  TextCodec& codec_;
  ResponseCache responses_;
  std::deque<Waiting> waiting_;  // in order of arrival; the begun command is first
  std::map<std::string, Owner, std::less<>> owners_;
  std::size_t bytes_ = 0;
  std::size_t alone_ = 0;  // commands that are no reads in spare time
  std::uint64_t turn_ = 0;
  std::vector<Instant> last_write_;
  bool begun_ = false;  // the first command is in flight, or a write between two requests
  std::uint64_t done_ = 0;
};

}  // namespace fieldcast
