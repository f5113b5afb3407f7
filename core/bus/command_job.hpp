// One command on its way: which exchanges it still needs, and what it has come to. Checked before
// it exists, so a job is always legal. Pure; owned by the CommandQueue, on the bus's thread. What
// can fail: make() says why a command is refused; result() says what failed on the wire.
#pragma once

#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/model/command.hpp"
#include "core/model/sample.hpp"
#include "core/model/spec.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

// Why a command never reaches the wire.
struct CommandFault {
  Cause cause = Cause::kNone;
  std::string reason;
};

// Something that a command reads or writes: a channel, or a run of items by address.
struct CommandSubject {
  Range range;
  Encoding encoding;
  std::optional<ChannelIndex> channel;
  bool readable = true;
};

class CommandJob {
 public:
  // `first_channel` is the index of the device's first channel on the bus. `protocol` and `codec`
  // outlive the job.
  static tl::expected<CommandJob, CommandFault> make(const Command& command,
                                                     const DeviceSpec& device, DeviceIndex index,
                                                     ChannelIndex first_channel,
                                                     const Protocol& protocol,
                                                     TextCodec& codec = plain_text_codec());

  // The next request; nothing when the command is finished and result() is final.
  [[nodiscard]] std::optional<Request> next() const;
  // The next request, if it is a plain write that may travel with its neighbours.
  [[nodiscard]] std::optional<WriteRequest> batchable() const;
  // A request of several commands was refused. Each goes alone from now on: that shows which of
  // them the device refuses.
  void go_alone() { alone_ = true; }
  void answered(const Reply& reply);
  // Whether the device did not carry out the request that failed so. A momentary code may leave it
  // open whether a write took effect (may_have_written() in device_code.hpp).
  [[nodiscard]] bool refuses(Cause cause, std::uint16_t device_code) const;
  // `seen`: what came in place of an answer, for the reason.
  void failed(Cause cause, std::uint16_t device_code, std::string_view seen = {});
  // A line that may echo cannot confirm a write whose answer equals its request.
  void use_distinct_answers() { distinct_ = true; }
  // Nothing else can be written: a read before it shows whether the line echoes.
  void read_first();

  [[nodiscard]] DeviceIndex device() const { return device_; }
  [[nodiscard]] const Command& command() const { return command_; }
  [[nodiscard]] bool started() const { return started_.has_value(); }
  void start(Instant now) {
    if (!started_) started_ = now;
  }
  // The request of the last start() did not leave. Without one before it the command has not
  // started.
  void not_sent() {
    if (!asked_) started_.reset();
  }

  // Items that were read, with the channels they belong to: to be published as samples.
  struct Acquired {
    ChannelIndex channel;
    unsigned item_bits;
    ByteView items;
  };
  [[nodiscard]] std::vector<Acquired> acquired() const;
  // The channel that a write went to, when it went to one.
  [[nodiscard]] std::optional<ChannelIndex> written_channel() const;

  [[nodiscard]] CommandResult result(Instant received, Instant completed) const;

 private:
  enum class Phase { kReadBefore, kWrite, kReadBack, kAcquire, kFinished };

  CommandJob(const Command& command, DeviceIndex device, const Protocol& protocol, TextCodec& codec)
      : command_(command), device_(device), protocol_(&protocol), codec_(&codec) {}
  [[nodiscard]] CommandFault unfit(const CommandSubject& subject, const Value& value,
                                   Cause cause) const;

  [[nodiscard]] tl::expected<void, CommandFault> prepare_write(const ChannelSpec* channel);
  [[nodiscard]] tl::expected<void, CommandFault> prepare_acquire();
  [[nodiscard]] tl::expected<void, CommandFault> find_subjects(const DeviceSpec& device,
                                                               ChannelIndex first_channel);
  [[nodiscard]] tl::expected<void, CommandFault> find_channels(const DeviceSpec& device,
                                                               const std::string& name,
                                                               ChannelIndex first_channel);
  [[nodiscard]] tl::expected<void, CommandFault> find_address(const DeviceSpec& device,
                                                              const AddressTarget& target);
  [[nodiscard]] tl::expected<void, CommandFault> add_values(const AddressTarget& target,
                                                            const ParsedAddress& address,
                                                            const Encoding& encoding,
                                                            std::uint32_t count);
  [[nodiscard]] const Area& area(const Range& range) const {
    return protocol_->areas()[range.area];
  }
  [[nodiscard]] WriteRequest write_request() const;
  [[nodiscard]] bool reads_back_same(ByteView items) const;
  [[nodiscard]] ByteView items_of(const CommandSubject& subject) const;
  void finish(CommandState state, Cause cause = Cause::kNone, std::uint16_t device_code = 0,
              std::string reason = {});
  void merge_into(const Bytes& before);  // the items that a read before the write found
  void wrote();
  void verify(const Bytes& items);  // the items that were read back, with the answer or after it
  void resolve_doubt(const Bytes& items);
  [[nodiscard]] bool has_plainer_form() const;

  Command command_;
  DeviceIndex device_ = 0;
  const Protocol* protocol_ = nullptr;
  TextCodec* codec_ = nullptr;
  std::vector<CommandSubject> subjects_;
  Bytes image_;                      // what is to be written
  std::optional<std::uint8_t> bit_;  // only this bit of the one item, or the eight from it on
  unsigned part_bits_ = 1;           // with bit_: 1 or 8
  bool merge_needed_ = false;        // read, change the bit, write
  bool distinct_ = false;
  bool alone_ = false;
  // It is open whether a write took effect: reading back shows it. cause_ and device_code_ are of
  // the write.
  bool in_doubt_ = false;
  unsigned rewrites_ = 0;
  unsigned max_rewrites_ = 0;
  std::vector<Range> reads_;       // of an acquisition
  std::vector<Bytes> read_items_;  // what came of them, as far as read
  Bytes read_back_;                // empty until a write was read back
  Phase phase_ = Phase::kFinished;
  CommandState state_ = CommandState::kFailed;
  Cause cause_ = Cause::kNone;
  std::uint16_t device_code_ = 0;
  std::string reason_;
  std::optional<Instant> started_;
  bool asked_ = false;  // a request of it came to its end
};

}  // namespace fieldcast
