#include "core/bus/command_job.hpp"

#include <algorithm>
#include <cstdio>

namespace fieldcast {
namespace {

tl::unexpected<CommandFault> fault(Cause cause, std::string reason = {}) {
  if (reason.empty()) reason = to_text(cause);
  return tl::make_unexpected(CommandFault{cause, std::move(reason)});
}

std::string error_text(Cause cause, std::uint16_t code) {
  std::string text{to_text(cause)};
  if (cause == Cause::kDeviceError || cause == Cause::kDeviceBusy) {
    char number[16];
    std::snprintf(number, sizeof number, " (code %02X)", code);
    text += number;
  }
  return text;
}

// A register's bit travels as its whole item.
bool is_item_bit(const Encoding& encoding, const Area& area) {
  return encoding.type == ValueType::kBool && encoding.bit && area.item_bits > 1;
}

std::optional<double> number_of(const Value& value) {
  if (const auto* d = std::get_if<double>(&value)) return *d;
  if (const auto* i = std::get_if<std::int64_t>(&value)) return static_cast<double>(*i);
  if (const auto* u = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*u);
  return std::nullopt;
}

tl::expected<void, CommandFault> check_limits(const ChannelSpec& channel, const Value& value) {
  const auto number = number_of(value);
  if (!number) return {};
  if (channel.write_min && *number < *channel.write_min)
    return fault(Cause::kRange, to_text(value) + " is below the lowest value allowed, " + to_text(Value{*channel.write_min}));
  if (channel.write_max && *number > *channel.write_max)
    return fault(Cause::kRange, to_text(value) + " is above the highest value allowed, " + to_text(Value{*channel.write_max}));
  return {};
}

// Ranges that touch or overlap, joined as far as one read may reach. Gaps are never bridged: nobody asked for what lies there.
std::vector<Range> joined(std::vector<Range> ranges, const Protocol& protocol) {
  std::sort(ranges.begin(), ranges.end(),
            [](const Range& a, const Range& b) { return std::pair(a.area, a.first) < std::pair(b.area, b.first); });
  std::vector<Range> result;
  for (const Range& range : ranges) {
    if (!result.empty() && result.back().area == range.area && range.first <= result.back().end()) {
      Range wider = result.back();
      wider.count = std::max(wider.end(), range.end()) - wider.first;
      if (protocol.size(ReadRequest{{wider}})) {
        result.back() = wider;
        continue;
      }
    }
    result.push_back(range);
  }
  return result;
}

}  // namespace

tl::expected<CommandJob, CommandFault> CommandJob::make(const Command& command, const DeviceSpec& device, DeviceIndex index,
                                                        ChannelIndex first_channel, const Protocol& protocol) {
  CommandJob job(command, index, protocol);
  job.max_rewrites_ = device.retries;
  if (auto found = job.find_subjects(device, first_channel); !found) return tl::make_unexpected(found.error());
  const ChannelSpec* channel = nullptr;
  if (job.subjects_.size() == 1 && job.subjects_[0].channel)
    channel = &device.channels[*job.subjects_[0].channel - first_channel];
  const auto prepared = command.operation == Operation::kWrite ? job.prepare_write(channel) : job.prepare_acquire();
  if (!prepared) return tl::make_unexpected(prepared.error());
  return job;
}

tl::expected<void, CommandFault> CommandJob::find_subjects(const DeviceSpec& device, ChannelIndex first_channel) {
  if (const auto* channel = std::get_if<ChannelTarget>(&command_.target))
    return find_channels(device, channel->name, first_channel);
  return find_address(device, std::get<AddressTarget>(command_.target));
}

tl::expected<void, CommandFault> CommandJob::find_channels(const DeviceSpec& device, const std::string& name,
                                                           ChannelIndex first_channel) {
  const bool write = command_.operation == Operation::kWrite;
  ChannelIndex index = first_channel;
  for (const ChannelSpec& channel : device.channels) {
    const bool readable = channel.access != Access::kWriteOnly;
    if (name.empty() ? readable : channel.name == name) {
      if (write && channel.access == Access::kReadOnly)
        return fault(Cause::kReadOnly, "channel '" + channel.name + "' is read-only");
      if (!write && !readable) return fault(Cause::kUnsupported, "channel '" + channel.name + "' is write-only");
      subjects_.push_back({channel.range, channel.encoding, index, readable});
    }
    ++index;
  }
  if (write && name.empty()) return fault(Cause::kUnknownChannel, "a write needs a channel or an address");
  if (subjects_.empty()) return fault(Cause::kUnknownChannel, "device '" + device.name + "' has no channel '" + name + "'");
  return {};
}

tl::expected<void, CommandFault> CommandJob::find_address(const DeviceSpec& device, const AddressTarget& target) {
  const bool write = command_.operation == Operation::kWrite;
  if (write ? !device.allow_raw_write : !device.allow_raw_read)
    return fault(Cause::kRawNotAllowed, "device '" + device.name + "' does not allow " + (write ? "raw-write" : "raw-read"));
  const auto address = protocol_->parse_address(target.at);
  if (!address)
    return fault(Cause::kBadAddress, "'" + target.at + "': " + address.error().what + "; allowed: " + address.error().allowed);
  const std::size_t count = write ? command_.values.size() : command_.count;
  if (count == 0 || count > kMaxCount)
    return fault(Cause::kRange, "between 1 and " + std::to_string(kMaxCount) + " values in one command");
  Encoding encoding = target.encoding;
  if (address->bit) encoding.bit = address->bit;
  const Area& area = protocol_->areas()[address->area];
  if (encoding.type == ValueType::kBool && area.item_bits > 1 && !encoding.bit)
    return fault(Cause::kWrongType, "a bool in " + std::string(area.name) + " needs a bit, as in " + target.at + ".0");
  if (encoding.type != ValueType::kBool && area.item_bits == 1)
    return fault(Cause::kWrongType, std::string(area.name) + " holds only bool");
  const std::uint32_t width = item_count(encoding, area.item_bits);
  if (address->first + std::uint64_t{width} * count > area.items)
    return fault(Cause::kBadAddress, "'" + target.at + "' with " + std::to_string(count) + " values reaches beyond the area");
  if (write && !area.writable) return fault(Cause::kReadOnly, std::string(area.name) + " cannot be written");
  for (std::uint32_t i = 0; i < count; ++i)
    subjects_.push_back({{address->area, address->first + i * width, width}, encoding, {}, true});
  return {};
}

tl::expected<void, CommandFault> CommandJob::prepare_write(const ChannelSpec* channel) {
  if (command_.values.size() != subjects_.size())
    return fault(Cause::kRange, "one value expected, " + std::to_string(command_.values.size()) + " given");
  for (std::size_t i = 0; i < subjects_.size(); ++i) {
    const CommandSubject& subject = subjects_[i];
    auto items = encode_value(subject.encoding, area(subject.range).item_bits, command_.values[i]);
    if (!items)
      return fault(items.error(), to_text(command_.values[i]) +
                                      (items.error() == Cause::kRange ? " does not fit " : " is no value of type ") +
                                      std::string(to_text(subject.encoding.type)));
    if (channel) {
      if (auto ok = check_limits(*channel, command_.values[i]); !ok) return ok;
    }
    append(image_, *items);
  }
  const CommandSubject& first = subjects_.front();
  if (is_item_bit(first.encoding, area(first.range))) {
    if (subjects_.size() > 1) return fault(Cause::kUnsupported, "bits of a word are written one at a time");
    bit_ = *first.encoding.bit;
    merge_needed_ = !area(first.range).bit_write;
    if (merge_needed_ && !first.readable)
      return fault(Cause::kUnsupported, "a bit of a word that cannot be read cannot be written");
  }
  if (!protocol_->size(write_request())) return fault(Cause::kRange, "too many values for one request");
  phase_ = merge_needed_ ? Phase::kReadBefore : Phase::kWrite;
  return {};
}

tl::expected<void, CommandFault> CommandJob::prepare_acquire() {
  std::vector<Range> ranges;
  for (const CommandSubject& subject : subjects_) ranges.push_back(subject.range);
  reads_ = joined(std::move(ranges), *protocol_);
  phase_ = Phase::kAcquire;
  return {};
}

WriteRequest CommandJob::write_request() const {
  Range whole = subjects_.front().range;
  whole.count = subjects_.back().range.end() - whole.first;
  return {whole, image_, merge_needed_ ? std::nullopt : bit_, distinct_};
}

std::optional<Request> CommandJob::next() const {
  switch (phase_) {
    case Phase::kReadBefore: return ReadRequest{{subjects_.front().range}};
    case Phase::kWrite: {
      WriteRequest write = write_request();
      if (command_.verify && !bit_ && subjects_.front().readable && protocol_->traits().write_read) {
        // Not every write can be read back in one round: Modbus has it for registers, not for coils.
        Request both = WriteReadRequest{write, write.range};
        if (protocol_->size(both)) return both;
      }
      return write;
    }
    case Phase::kReadBack: return ReadRequest{{write_request().range}};
    case Phase::kAcquire: return ReadRequest{{reads_[read_items_.size()]}};
    case Phase::kFinished: break;
  }
  return std::nullopt;
}

bool CommandJob::reads_back_same(ByteView items) const {
  if (!bit_) return std::equal(items.begin(), items.end(), image_.begin(), image_.end());
  const std::size_t byte = image_.size() - 1 - *bit_ / 8;
  const auto mask = static_cast<std::uint8_t>(1u << *bit_ % 8);
  return items.size() == image_.size() && ((items[byte] ^ image_[byte]) & mask) == 0;
}

void CommandJob::wrote() {
  if (command_.verify && subjects_.front().readable)
    phase_ = Phase::kReadBack;
  else
    finish(CommandState::kDone);
}

void CommandJob::answered(const Reply& reply) {
  for (const RangeReply& range : reply) {
    if (range.cause != Cause::kNone) return failed(range.cause, range.device_code);
  }
  switch (phase_) {
    case Phase::kReadBefore: {
      // Only our bit changes: the word is written as it was just read.
      const std::size_t byte = image_.size() - 1 - *bit_ / 8;
      const bool on = (image_[byte] >> *bit_ % 8 & 1) != 0;
      image_ = reply.front().items;
      merge_bit(image_, *bit_, on);
      phase_ = Phase::kWrite;
      break;
    }
    case Phase::kWrite:
      if (reply.size() > 1) {  // written and read back in one round
        read_back_ = reply.back().items;
        if (reads_back_same(read_back_))
          finish(CommandState::kVerified);
        else
          finish(CommandState::kFailed, Cause::kNotVerified, 0, std::string(to_text(Cause::kNotVerified)));
      } else {
        wrote();
      }
      break;
    case Phase::kReadBack:
      read_back_ = reply.front().items;
      if (reads_back_same(read_back_)) {
        if (command_.verify)
          finish(CommandState::kVerified);
        else
          finish(CommandState::kDone, Cause::kNone, 0, "the answer was lost; reading back shows the value");
      } else if (in_doubt_ && rewrites_ < max_rewrites_) {
        ++rewrites_;
        in_doubt_ = false;
        read_back_.clear();  // it shows what was, not what will be
        phase_ = Phase::kWrite;
      } else {
        finish(CommandState::kFailed, in_doubt_ ? Cause::kNoAnswer : Cause::kNotVerified, 0,
               in_doubt_ ? "no answer, and reading back shows another value" : std::string(to_text(Cause::kNotVerified)));
      }
      break;
    case Phase::kAcquire:
      read_items_.push_back(reply.front().items);
      if (read_items_.size() == reads_.size()) finish(CommandState::kDone);
      break;
    case Phase::kFinished: break;
  }
}

void CommandJob::failed(Cause cause, std::uint16_t device_code) {
  const bool refused = cause == Cause::kDeviceError || cause == Cause::kDeviceBusy;
  if (phase_ == Phase::kWrite && !refused && cause != Cause::kPortClosed && subjects_.front().readable) {
    // Never written twice blindly: the first may have taken effect.
    in_doubt_ = true;
    phase_ = Phase::kReadBack;
    return;
  }
  std::string reason = error_text(cause, device_code);
  if (in_doubt_ || (phase_ == Phase::kWrite && !refused))
    reason += "; unknown whether the write took effect";
  else if (phase_ == Phase::kReadBack)
    reason = "written, but reading back failed: " + reason;
  finish(CommandState::kFailed, cause, device_code, std::move(reason));
}

void CommandJob::finish(CommandState state, Cause cause, std::uint16_t device_code, std::string reason) {
  phase_ = Phase::kFinished;
  state_ = state;
  cause_ = cause;
  device_code_ = device_code;
  reason_ = std::move(reason);
}

ByteView CommandJob::items_of(const CommandSubject& subject) const {
  const unsigned bits = area(subject.range).item_bits;
  const auto cut = [&](const Range& range, const Bytes& items) -> ByteView {
    if (range.area != subject.range.area || subject.range.first < range.first || subject.range.end() > range.end()) return {};
    return ByteView(items).subspan(image_bytes(bits, subject.range.first - range.first), image_bytes(bits, subject.range.count));
  };
  if (command_.operation == Operation::kWrite) return read_back_.empty() ? ByteView{} : cut(write_request().range, read_back_);
  for (std::size_t i = 0; i < read_items_.size(); ++i) {
    if (const ByteView found = cut(reads_[i], read_items_[i]); !found.empty()) return found;
  }
  return {};
}

std::vector<CommandJob::Acquired> CommandJob::acquired() const {
  std::vector<Acquired> result;
  for (const CommandSubject& subject : subjects_) {
    const ByteView items = items_of(subject);
    if (subject.channel && !items.empty()) result.push_back({*subject.channel, area(subject.range).item_bits, items});
  }
  return result;
}

std::optional<ChannelIndex> CommandJob::written_channel() const {
  return command_.operation == Operation::kWrite ? subjects_.front().channel : std::nullopt;
}

CommandResult CommandJob::result(Instant received, Instant completed) const {
  CommandResult result{command_.requester, command_.request_id,          state_,   cause_, device_code_, reason_, {},
                       received,           started_.value_or(completed), completed};
  for (const CommandSubject& subject : subjects_) {
    const ByteView items = items_of(subject);
    if (items.empty()) continue;
    if (auto value = decode_value(subject.encoding, area(subject.range).item_bits, items)) {
      result.values.push_back(std::move(*value));
    } else if (result.state == CommandState::kDone) {
      result.state = CommandState::kFailed;
      result.cause = value.error();
      result.reason = "what the device holds is no value of type " + std::string(to_text(subject.encoding.type));
    }
  }
  return result;
}

}  // namespace fieldcast
