// Everything that is checked before a command reaches the wire: target, access, type, range, address.
#include <algorithm>

#include "core/bus/command_job.hpp"

namespace fieldcast {
namespace {

tl::unexpected<CommandFault> fault(Cause cause, std::string reason = {}) {
  if (reason.empty()) reason = to_text(cause);
  return tl::make_unexpected(CommandFault{cause, std::move(reason)});
}

// A register's bit travels as its whole item.
bool is_item_bit(const Encoding& encoding, const Area& area) {
  return encoding.type == ValueType::kBool && encoding.bit && area.item_bits > 1;
}

tl::expected<void, CommandFault> check_limits(const ChannelSpec& channel, const Value& value) {
  const auto number = as_number(value);
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

}  // namespace fieldcast
