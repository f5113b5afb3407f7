#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/message_text.hpp"
#include "core/bus/command/command_job.hpp"
#include "core/codec/raw_items.hpp"
#include "core/model/fit.hpp"

namespace fieldcast {
namespace {

tl::unexpected<CommandFault> fault(Cause cause, std::string reason) {
  return tl::make_unexpected(CommandFault{cause, std::move(reason)});
}

tl::unexpected<CommandFault> never_written(const std::string& at) {
  return fault(Cause::kReadOnly,
               "'" + at + "' is read-only: the protocol has no operation that writes it alone");
}

std::string type_text(const Encoding& encoding) {
  const std::string type(to_text(encoding.type));
  if (is_date_time(encoding.layout)) return "a date and time like 2026-11-28T10:15:00.000";
  if (encoding.type == ValueType::kString)
    return type + '(' + std::to_string(encoding.string_bytes) + ')';
  if (!encoding.text_number) return type;
  return "a " + type + " as text of " + std::to_string(encoding.string_bytes) + " characters";
}

// The family's order is the default.
tl::expected<Encoding, CommandFault> encoding_of(const AddressTarget& target,
                                                 const ParsedAddress& address, const Area& area) {
  Encoding encoding = target.encoding;
  if (address.bit && encoding.bit && *address.bit != *encoding.bit)
    return fault(Cause::kWrongType, "the bit is named twice: '" + target.at + "' has one already");
  encoding = with_form_of(address, encoding);
  if (encoding.word_order == WordOrder::kBigEndian) encoding.word_order = area.word_order;
  if (encoding.is_text() && encoding.byte_order == ByteOrder::kBigEndian)
    encoding.byte_order = area.text_order;
  if (const auto misfit = check_fit(target.at, address, area, encoding))
    return fault(Cause::kWrongType, misfit->what + "; allowed: " + misfit->allowed);
  return encoding;
}

static_assert(std::numeric_limits<long double>::digits >= 64, "holds each integer of 64 bits");

std::optional<long double> exact_number(const Value& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return *whole;
  if (const auto* whole = std::get_if<std::uint64_t>(&value)) return *whole;
  return as_number(value);
}

// `stored`: the value that the device gets for it, rounded to its resolution.
tl::expected<void, CommandFault> check_limits(const ChannelSpec& channel, const Value& value,
                                              const Value& stored) {
  const auto number = exact_number(value), rounded = exact_number(stored);
  if (!number || !rounded) return {};
  const auto refused = [&](const char* than, double limit, const char* key) {
    const std::string shown = *number == *rounded
                                  ? to_text(value)
                                  : to_text(stored) + " (rounded from " + to_text(value) + ')';
    return fault(Cause::kRange, shown + than + to_text(Value{limit}) + key);
  };
  // How much a stored value can differ from the limit that it means.
  const auto error_at = [&](double limit) {
    const Encoding& encoding = channel.encoding;
    const bool single = encoding.type == ValueType::kFloat32;
    const double raw = single ? std::abs((limit - encoding.offset) / encoding.scale) : 0;
    const double half_step = raw * std::numeric_limits<float>::epsilon() / 2;
    return std::max(std::abs(encoding.scale) * std::max(1e-6, half_step), std::abs(limit) * 1e-15);
  };
  if (const auto min = channel.write_min;
      min && (*number < *min || *rounded < *min - error_at(*min)))
    return refused(" is below the lowest value allowed, ", *min, " (write: min)");
  if (const auto max = channel.write_max;
      max && (*number > *max || *rounded > *max + error_at(*max)))
    return refused(" is above the highest value allowed, ", *max, " (write: max)");
  return {};
}

// Joins ranges that touch or overlap, up to the size of one read and to `most` items (0: no limit).
// Never bridges a gap.
std::vector<Range> joined(std::vector<Range> ranges, const Protocol& protocol, std::uint32_t most) {
  std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) {
    return std::pair(a.area, a.first) < std::pair(b.area, b.first);
  });
  std::vector<Range> result;
  for (const Range& range : ranges) {
    if (!result.empty() && result.back().area == range.area && range.first <= result.back().end()) {
      Range wider = result.back();
      wider.count = std::max(wider.end(), range.end()) - wider.first;
      const bool allowed = most == 0 || wider.count <= std::max(most, result.back().count);
      if (allowed && protocol.size(ReadRequest{{wider}})) {
        result.back() = wider;
        continue;
      }
    }
    result.push_back(range);
  }
  return result;
}

}  // namespace

tl::expected<CommandJob, CommandFault> CommandJob::make(const Command& command,
                                                        const DeviceSpec& device, DeviceIndex index,
                                                        ChannelIndex first_channel,
                                                        const Protocol& protocol,
                                                        TextCodec& codec) {
  CommandJob job(command, index, protocol, codec);
  job.max_rewrites_ = device.retries;
  const auto* named = std::get_if<ChannelTarget>(&command.target);
  const auto found = named ? job.find_channels(device, named->name, first_channel)
                           : job.find_address(device, std::get<AddressTarget>(command.target));
  if (!found) return tl::make_unexpected(found.error());
  if (command.ad_hoc) job.subjects_.front().channel.reset();
  const ChannelSpec* channel = nullptr;
  if (job.subjects_.size() == 1 && job.subjects_[0].channel)
    channel = &device.channels[*job.subjects_[0].channel - first_channel];
  const auto prepared = command.operation == Operation::kWrite
                            ? job.prepare_write(channel)
                            : job.prepare_acquire(device.max_block);
  if (!prepared) return tl::make_unexpected(prepared.error());
  return job;
}

tl::expected<void, CommandFault> CommandJob::find_channels(const DeviceSpec& device,
                                                           const std::string& name,
                                                           ChannelIndex first_channel) {
  const bool write = command_.operation == Operation::kWrite;
  ChannelIndex index = first_channel;
  for (const ChannelSpec& channel : device.channels) {
    const bool readable = is_requestable(channel);
    if (name.empty() ? readable : channel.name == name) {
      if (channel.calculation)
        return fault(write ? Cause::kReadOnly : Cause::kUnsupported,
                     "channel '" + channel.name +
                         "' is calculated by the bridge; only its inputs can be requested");
      if (write && channel.access == Access::kReadOnly)
        return fault(Cause::kReadOnly,
                     "channel '" + channel.name +
                         (channel.exponent_from.empty()
                              ? "' is read-only; its configuration would have to say access: "
                                "read-write"
                              : "' has an exponent of the device and cannot be written"));
      if (!write && channel.unsolicited)
        return fault(Cause::kUnsupported,
                     "channel '" + channel.name +
                         "' cannot be requested: the device sends it by itself; its last sample "
                         "is the newest value");
      if (!write && !readable)
        return fault(Cause::kUnsupported, "channel '" + channel.name +
                                              "' is write-only; its configuration would have to "
                                              "say access: read-write");
      subjects_.push_back({channel.range, channel.encoding, index, readable, channel.name});
    }
    ++index;
  }
  if (write && name.empty())
    return fault(Cause::kUnknownChannel, "a write needs a channel or an address");
  if (subjects_.empty())
    return fault(Cause::kUnknownChannel,
                 "device '" + device.name + "' has no channel '" + name + "'");
  return {};
}

tl::expected<void, CommandFault> CommandJob::find_address(const DeviceSpec& device,
                                                          const AddressTarget& target) {
  const bool write = command_.operation == Operation::kWrite;
  if (write ? !device.allow_raw_write : !device.allow_raw_read && !command_.gateway)
    return fault(Cause::kRawNotAllowed, "device '" + device.name + "' does not allow " +
                                            (write ? "raw-write" : "raw-read") +
                                            "; its configuration would have to say allow: [" +
                                            (write ? "raw-write" : "raw-read") + ']');
  const auto address = protocol_->parse_address(target.at);
  if (!address)
    return fault(Cause::kBadAddress,
                 address.error().what + "; allowed: " + address.error().allowed +
                     (address.error().suggestion.empty()
                          ? ""
                          : "; did you mean " + address.error().suggestion + '?'));
  const std::size_t count = write ? command_.values.size() : command_.count;
  const std::uint32_t most_values = command_.gateway ? kMaxGatewayValues : kMaxRawValues;
  if (count == 0 || count > most_values)
    return fault(Cause::kRange,
                 "between 1 and " + std::to_string(most_values) + " values in one command");
  const Area& area = protocol_->areas()[address->area];
  if (write && !area.writable)
    return fault(Cause::kReadOnly, std::string(area.name) + " cannot be written");
  const auto encoding = encoding_of(target, *address, area);
  if (!encoding) return tl::make_unexpected(encoding.error());
  const std::uint32_t width = item_count(*encoding, area.item_bits);
  const std::uint32_t most = device.max_block == 0 || write
                                 ? (write ? area.max_write : area.max_read)
                                 : std::min(area.max_read, device.max_block);
  if (width > most && write && is_field(*address)) return never_written(target.at);
  if (width > most)
    return fault(Cause::kRange, "'" + target.at + "' needs " + std::to_string(width) +
                                    " items in one " + (write ? "write" : "read") +
                                    "; allowed: at most " + std::to_string(most));
  return add_values(target, *address, *encoding, static_cast<std::uint32_t>(count));
}

// For a bit of an item, the next value is the next bit.
tl::expected<void, CommandFault> CommandJob::add_values(const AddressTarget& target,
                                                        const ParsedAddress& address,
                                                        const Encoding& encoding,
                                                        std::uint32_t count) {
  const Area& area = protocol_->areas()[address.area];
  const bool bits = encoding.type == ValueType::kBool && encoding.bit;
  if (count > 1 && !bits && is_part(encoding, area.item_bits))
    return fault(Cause::kUnsupported, "bytes of an item are read and written one at a time");
  const std::uint32_t width = item_count(encoding, area.item_bits);
  const std::uint64_t end = std::uint64_t{target.skip} + count;
  const std::uint64_t last_bit = bits ? *encoding.bit + end - 1 : 0;
  const std::uint64_t items = bits ? last_bit / area.item_bits + 1 : width * end;
  // A declared field is one value; its bits do not extend into the next field.
  const bool past_field = is_field(address) && (bits ? items > 1 : end > 1);
  if (address.first + items > area.items || past_field)
    return fault(Cause::kBadAddress, "'" + target.at + "' with " + std::to_string(count) +
                                         " values reaches beyond the " +
                                         (past_field ? "field" : "area"));
  for (std::uint32_t i = target.skip; i < end; ++i) {
    CommandSubject subject{{address.area, address.first + i * width, width}, encoding, {}, true};
    if (bits) {
      const std::uint32_t bit = *encoding.bit + i;
      subject.range.first = address.first + bit / area.item_bits;
      subject.encoding.bit = static_cast<std::uint8_t>(bit % area.item_bits);
    }
    if (!in_one_bank(area, subject.range.first, subject.range.end()))
      return fault(Cause::kBadAddress, "'" + target.at + "' reaches beyond its bank of the area");
    subjects_.push_back(subject);
  }
  return {};
}

CommandFault CommandJob::unfit(const CommandSubject& subject, const Value& value,
                               Cause cause) const {
  const auto* text = std::get_if<std::string>(&value);
  const std::string shown = text == nullptr ? to_text(value) : "'" + escaped(*text) + "'";
  const Encoding& encoding = subject.encoding;
  if (cause != Cause::kRange) return {cause, shown + " is no value of type " + type_text(encoding)};
  if (text != nullptr && !codec_->from_utf8(encoding.charset, *text))
    return {cause,
            shown + (is_utf8(*text) ? " has a character that " +
                                          std::string(to_text(encoding.charset)) + " does not have"
                                    : " is no UTF-8")};
  if (!encoding.not_available.empty()) {
    const auto bits = bits_of_value(encoding, value);
    if (bits && is_not_available(encoding, *bits))
      return {cause, shown + " means 'not available' at this channel (key 'not-available')" +
                         "; write another value"};
  }
  return {cause, shown + " does not fit " + type_text(encoding)};
}

tl::expected<void, CommandFault> CommandJob::prepare_write(const ChannelSpec* channel) {
  if (command_.values.size() != subjects_.size())
    return fault(Cause::kRange,
                 "one value expected, " + std::to_string(command_.values.size()) + " given");
  for (std::size_t i = 0; i < subjects_.size(); ++i) {
    const CommandSubject& subject = subjects_[i];
    auto items =
        encode_value(subject.encoding, area(subject.range).item_bits, command_.values[i], *codec_);
    if (!items) return tl::make_unexpected(unfit(subject, command_.values[i], items.error()));
    if (channel) {
      const Value& value = command_.values[i];
      const auto stored =
          subject.encoding.scaled()
              ? decode_value(subject.encoding, area(subject.range).item_bits, *items, *codec_)
              : value;
      if (auto ok = check_limits(*channel, value, stored.value_or(value)); !ok) return ok;
    }
    append(image_, *items);
  }
  const CommandSubject& first = subjects_.front();
  const bool one_word = subjects_.size() == 1 && image_.size() == 2;
  if (command_.mask && !(one_word && area(first.range).mask_write))
    return fault(Cause::kUnsupported, "this protocol writes no bits by a mask");
  if (is_part(first.encoding, area(first.range).item_bits)) {
    if (subjects_.size() > 1)
      return fault(Cause::kUnsupported, "bits of a word are written one at a time");
    bit_ = *first.encoding.bit;
    part_bits_ = width_bits(first.encoding);
    if (part_bits_ > 1) {
      const std::string& at =
          channel != nullptr ? channel->at : std::get<AddressTarget>(command_.target).at;
      if (const auto why = why_no_byte_write("'" + at + "'", area(first.range)))
        return fault(Cause::kUnsupported, *why);
    }
    merge_needed_ = part_bits_ == 1 && !area(first.range).bit_write;
    if (merge_needed_ && !first.readable)
      return fault(Cause::kUnsupported, "a bit of a word that cannot be read cannot be written");
  }
  if (!protocol_->size(write_request())) {
    // If another value can be written, only this one is too large for the field of the device.
    WriteRequest other = write_request();
    const auto zero =
        encode_value(first.encoding, area(first.range).item_bits, Value{std::int64_t{0}}, *codec_);
    if (zero && subjects_.size() == 1) other.items = *zero;
    if (protocol_->size(other))
      return fault(Cause::kRange, to_text(command_.values[0]) +
                                      " does not fit the digits that the device accepts");
    if (const auto* address = std::get_if<AddressTarget>(&command_.target);
        address != nullptr && is_field(*protocol_->parse_address(address->at)))
      return never_written(address->at);
    const Area& written = area(first.range);
    if (written.sends_earlier && (first.range.first > 0 || bit_))
      return fault(Cause::kUnsupported,
                   "other bytes are sent with it and are not known yet: write " +
                       std::string(written.name) + ":0 first");
    return fault(Cause::kRange, "too many values for one request");
  }
  phase_ = merge_needed_ ? Phase::kReadBefore : Phase::kWrite;
  return {};
}

tl::expected<void, CommandFault> CommandJob::prepare_acquire(std::uint32_t max_block) {
  std::vector<Range> ranges;
  for (const CommandSubject& subject : subjects_) ranges.push_back(subject.range);
  reads_ = joined(std::move(ranges), *protocol_, max_block);
  phase_ = Phase::kAcquire;
  return {};
}

}  // namespace fieldcast
