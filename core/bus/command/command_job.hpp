// One command in progress: its next request and its result. make() returns the reason of a
// rejection, result() that of a failure on the wire. Pure; owned by CommandQueue, on the bus's
// thread.
#pragma once

#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/model/bus_spec.hpp"
#include "core/model/command.hpp"
#include "core/model/sample.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

struct CommandFault {
  Cause cause = Cause::kNone;
  std::string reason;
};

struct CommandSubject {
  Range range;
  Encoding encoding;
  std::optional<ChannelIndex> channel;
  bool readable = true;
  std::string name{};  // of the channel, for reasons
};

class CommandJob {
 public:
  // `first_channel`: of the device. `protocol` and `codec` must outlive the job.
  static tl::expected<CommandJob, CommandFault> make(const Command& command,
                                                     const DeviceSpec& device, DeviceIndex index,
                                                     ChannelIndex first_channel,
                                                     const Protocol& protocol,
                                                     TextCodec& codec = plain_text_codec());

  // Empty when the command is finished and result() is final.
  [[nodiscard]] std::optional<Request> next() const;
  // Empty if the command cannot share a request with others.
  [[nodiscard]] std::optional<WriteRequest> batchable() const;
  // Sends the commands of a refused request one by one, to find the refused ones.
  void go_alone() { alone_ = true; }
  // A write whose effect was in doubt is not repeated after its expiry.
  void responded(const Reply& reply, Instant now);
  // Whether the device did not carry out the request that failed so. A momentary code may leave it
  // open whether a write took effect (may_have_written() in device_code.hpp).
  [[nodiscard]] bool refuses(Cause cause, std::uint16_t device_code) const;
  // `seen`: the failure in place of a response, for the reason.
  void failed(Cause cause, std::uint16_t device_code, std::string_view seen = {});
  // Requests a write response that differs from its request, as an echo would equal it.
  void use_distinct_responses() { distinct_ = true; }
  // For devices without such a form: a read before the write shows whether the line echoes.
  void read_first();

  [[nodiscard]] DeviceIndex device() const { return device_; }
  [[nodiscard]] const Command& command() const { return command_; }
  // The items of a gateway's read; empty for other commands.
  [[nodiscard]] std::optional<Range> gateway_range() const {
    if (!command_.is_gateway_read() || phase_ != Phase::kAcquire || reads_.size() != 1)
      return std::nullopt;
    return reads_.front();
  }
  [[nodiscard]] bool started() const { return started_.has_value(); }
  void start(Instant now) {
    if (!started_) started_ = now;
  }
  // The request of the last start() was not sent.
  void not_sent() {
    if (!asked_) started_.reset();
  }

  struct Acquired {
    ChannelIndex channel;
    unsigned item_bits;
    ByteView items;
  };
  // The values of channels that the last response contained; empty when called again.
  [[nodiscard]] std::vector<Acquired> take_acquired();
  [[nodiscard]] std::optional<ChannelIndex> written_channel() const;

  [[nodiscard]] CommandResult result(Instant received, Instant completed) const;

 private:
  enum class Phase { kReadBefore, kWrite, kReadBack, kAcquire, kFinished };

  CommandJob(const Command& command, DeviceIndex device, const Protocol& protocol, TextCodec& codec)
      : command_(command), device_(device), protocol_(&protocol), codec_(&codec) {}
  [[nodiscard]] CommandFault unfit(const CommandSubject& subject, const Value& value,
                                   Cause cause) const;

  [[nodiscard]] tl::expected<void, CommandFault> prepare_write(const ChannelSpec* channel);
  [[nodiscard]] tl::expected<void, CommandFault> prepare_acquire(std::uint32_t max_block);
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
  // Empty if no response from the read number `first` on contained the subject.
  [[nodiscard]] ByteView items_of(const CommandSubject& subject, std::size_t first = 0) const;
  void finish(CommandState state, Cause cause = Cause::kNone, std::uint16_t device_code = 0,
              std::string reason = {});
  void merge_into(const Bytes& before);  // `before`: items read before the write
  void wrote();
  void verify(const Bytes& items);  // `items`: read back with the response or after it
  void resolve_doubt(const Bytes& items, Instant now);
  [[nodiscard]] bool has_plainer_form() const;

  Command command_;
  DeviceIndex device_ = 0;
  const Protocol* protocol_ = nullptr;
  TextCodec* codec_ = nullptr;
  std::vector<CommandSubject> subjects_;
  Bytes image_;
  std::optional<std::uint8_t> bit_;  // only this bit of the item, or the eight bits that start here
  unsigned part_bits_ = 1;           // with bit_: 1 or 8
  bool merge_needed_ = false;
  bool distinct_ = false;
  bool alone_ = false;
  bool in_doubt_ = false;  // a write got no response: reading back shows its effect
  unsigned rewrites_ = 0;
  unsigned max_rewrites_ = 0;
  std::vector<Range> reads_;
  std::vector<Bytes> read_items_;
  std::size_t taken_ = 0;  // of read_items_
  Bytes read_back_;        // empty until read back
  Phase phase_ = Phase::kFinished;
  CommandState state_ = CommandState::kFailed;
  Cause cause_ = Cause::kNone;
  std::uint16_t device_code_ = 0;
  std::string reason_;
  std::optional<Instant> started_;
  bool asked_ = false;  // a request was completed
};

}  // namespace fieldcast
