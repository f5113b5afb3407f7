#include "core/bus/command/command_job.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {
namespace {

std::string error_text(Cause cause, std::uint16_t code, const Traits& traits) {
  std::string text{to_text(cause)};
  if (cause == Cause::kDeviceError || cause == Cause::kDeviceBusy)
    text += device_code_note(traits.codes, code);
  return text;
}

}  // namespace

WriteRequest CommandJob::write_request() const {
  Range whole = subjects_.front().range;
  whole.count = subjects_.back().range.end() - whole.first;
  return {whole, image_, merge_needed_ ? std::nullopt : bit_, distinct_, part_bits_, command_.mask};
}

std::optional<Request> CommandJob::next() const {
  switch (phase_) {
    case Phase::kReadBefore: return ReadRequest{{subjects_.front().range}};
    case Phase::kWrite: {
      WriteRequest write = write_request();
      if (command_.verify && !bit_ && !command_.mask && subjects_.front().readable &&
          protocol_->traits().write_read) {
        // Read-back in the same exchange: Modbus supports it for registers but not for coils.
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

std::optional<WriteRequest> CommandJob::batchable() const {
  if (phase_ != Phase::kWrite || bit_ || command_.mask || alone_ || rewrites_ > 0)
    return std::nullopt;
  const auto request = next();
  const auto* write = std::get_if<WriteRequest>(&*request);
  return write != nullptr ? std::optional(*write) : std::nullopt;
}

bool CommandJob::reads_back_same(ByteView items) const {
  if (command_.mask)
    return items.size() == 2 && ((read_u16(items) ^ read_u16(image_)) & *command_.mask) == 0;
  if (!bit_) {
    if (std::equal(items.begin(), items.end(), image_.begin(), image_.end())) return true;
    // A device may format the same number differently: "+25.0" for " 25.00".
    const CommandSubject& only = subjects_.front();
    if (!only.encoding.text_number || subjects_.size() > 1) return false;
    const unsigned bits = area(only.range).item_bits;
    const auto back = decode_value(only.encoding, bits, items);
    return back && back == decode_value(only.encoding, bits, image_);
  }
  const std::size_t byte = image_.size() - 1 - *bit_ / 8;
  const auto mask = static_cast<std::uint8_t>(((1u << part_bits_) - 1) << *bit_ % 8);
  return items.size() == image_.size() && ((items[byte] ^ image_[byte]) & mask) == 0;
}

void CommandJob::read_first() {
  if (phase_ == Phase::kWrite && subjects_.front().readable) phase_ = Phase::kReadBefore;
}

// If a device refuses one form of a write, no value was written and the echo is known.
bool CommandJob::has_plainer_form() const {
  if (!distinct_ || phase_ != Phase::kWrite) return false;
  WriteRequest write = write_request();
  Bytes distinct, plain;
  (void)protocol_->begin(write, {})->start(distinct);
  write.distinct_response = false;
  (void)protocol_->begin(write, {})->start(plain);
  return distinct != plain;
}

void CommandJob::wrote() {
  const CommandSubject& subject = subjects_.front();
  const bool silent = area(subject.range).no_response > Duration::zero();
  if ((command_.verify || silent) && subject.readable)
    phase_ = Phase::kReadBack;
  else
    finish(CommandState::kDone);
}

void CommandJob::responded(const Reply& reply, Instant now) {
  asked_ = true;
  for (const RangeReply& range : reply) {
    if (range.cause != Cause::kNone) return failed(range.cause, range.device_code);
    if (!range.absent.empty()) return failed(Cause::kNotAvailable, 0);
  }
  switch (phase_) {
    case Phase::kReadBefore: merge_into(reply.front().items); break;
    case Phase::kWrite:
      if (reply.size() > 1)
        verify(reply.back().items);
      else
        wrote();
      break;
    case Phase::kReadBack:
      if (in_doubt_)
        resolve_doubt(reply.front().items, now);
      else
        verify(reply.front().items);
      break;
    case Phase::kAcquire:
      read_items_.push_back(reply.front().items);
      if (read_items_.size() == reads_.size()) finish(CommandState::kDone);
      break;
    case Phase::kFinished: break;
  }
}

// Changes only the command's bit: the rest of the word keeps the value just read.
void CommandJob::merge_into(const Bytes& before) {
  phase_ = Phase::kWrite;
  if (!merge_needed_) return;  // the read only showed whether the line echoes
  const std::size_t byte = image_.size() - 1 - *bit_ / 8;
  const bool on = (image_[byte] >> *bit_ % 8 & 1) != 0;
  image_ = before;
  merge_bit(image_, *bit_, on);
}

void CommandJob::verify(const Bytes& items) {
  read_back_ = items;
  if (reads_back_same(items))
    finish(CommandState::kVerified);
  else
    finish(CommandState::kFailed, Cause::kNotVerified, 0,
           std::string(to_text(Cause::kNotVerified)));
}

// The items show whether a write without a response took effect.
void CommandJob::resolve_doubt(const Bytes& items, Instant now) {
  const bool was_busy = cause_ == Cause::kDeviceBusy;
  const std::string what = was_busy ? error_text(cause_, device_code_, protocol_->traits()) : "";
  if (reads_back_same(items)) {
    read_back_ = items;
    if (command_.verify) return finish(CommandState::kVerified);
    return finish(CommandState::kDone, Cause::kNone, 0,
                  (was_busy ? what : "the response was lost") + "; reading back shows the value");
  }
  if (was_busy) {
    read_back_ = items;
    return finish(CommandState::kFailed, cause_, device_code_,
                  what + "; reading back shows a different value");
  }
  const bool is_late = now >= command_.expires;
  if (rewrites_ < max_rewrites_ && !is_late) {  // `items` is the value before it, so it is not kept
    ++rewrites_;
    in_doubt_ = false;
    return merge_into(items);  // another bit of the word may have changed since the first read
  }
  read_back_ = items;
  finish(CommandState::kFailed, Cause::kNoResponse, 0,
         std::string("no response, and reading back shows a different value") +
             (is_late ? "; not written again after its expiry" : ""));
}

bool CommandJob::refuses(Cause cause, std::uint16_t device_code) const {
  return cause == Cause::kDeviceError ||
         (cause == Cause::kDeviceBusy &&
          (phase_ != Phase::kWrite || !may_have_written(protocol_->traits().codes, device_code)));
}

void CommandJob::failed(Cause cause, std::uint16_t device_code, std::string_view seen) {
  asked_ = true;
  const bool refused = refuses(cause, device_code);
  if (cause == Cause::kDeviceError && has_plainer_form()) {
    distinct_ = false;
    return;
  }
  if (phase_ == Phase::kWrite && !refused && cause != Cause::kPortClosed &&
      subjects_.front().readable) {
    // A write is not repeated without reading back: the first may have taken effect.
    in_doubt_ = true;
    cause_ = cause;
    device_code_ = device_code;
    phase_ = Phase::kReadBack;
    return;
  }
  std::string reason = error_text(cause, device_code, protocol_->traits());
  if (!seen.empty()) reason.append("; ").append(seen);
  if (in_doubt_ || (phase_ == Phase::kWrite && !refused))
    reason += "; unknown whether the write took effect";
  else if (phase_ == Phase::kReadBack)
    reason = "written, but reading back failed: " + reason;
  finish(CommandState::kFailed, cause, device_code, std::move(reason));
}

void CommandJob::finish(CommandState state, Cause cause, std::uint16_t device_code,
                        std::string reason) {
  phase_ = Phase::kFinished;
  state_ = state;
  cause_ = cause;
  device_code_ = device_code;
  reason_ = std::move(reason);
}

ByteView CommandJob::items_of(const CommandSubject& subject, std::size_t first) const {
  const unsigned bits = area(subject.range).item_bits;
  const auto cut = [&](const Range& range, const Bytes& items) -> ByteView {
    if (range.area != subject.range.area || subject.range.first < range.first ||
        subject.range.end() > range.end())
      return {};
    return ByteView(items).subspan(image_bytes(bits, subject.range.first - range.first),
                                   image_bytes(bits, subject.range.count));
  };
  if (command_.operation == Operation::kWrite)
    return read_back_.empty() ? ByteView{} : cut(write_request().range, read_back_);
  for (std::size_t i = first; i < read_items_.size(); ++i) {
    if (const ByteView found = cut(reads_[i], read_items_[i]); !found.empty()) return found;
  }
  return {};
}

std::vector<CommandJob::Acquired> CommandJob::take_acquired() {
  const std::size_t first = std::exchange(taken_, read_items_.size());
  std::vector<Acquired> result;
  for (const CommandSubject& subject : subjects_) {
    const ByteView items = items_of(subject, first);
    if (subject.channel && !items.empty())
      result.push_back({*subject.channel, area(subject.range).item_bits, items});
  }
  return result;
}

std::optional<ChannelIndex> CommandJob::written_channel() const {
  return command_.operation == Operation::kWrite ? subjects_.front().channel : std::nullopt;
}

CommandResult CommandJob::result(Instant received, Instant completed) const {
  CommandResult result{command_.requester,
                       command_.request_id,
                       state_,
                       cause_,
                       device_code_,
                       reason_,
                       {},
                       received,
                       started_.value_or(completed),
                       completed,
                       command_.gateway,
                       command_.is_gateway_read(),
                       command_.ad_hoc != nullptr};
  for (const CommandSubject& subject : subjects_) {
    const ByteView items = items_of(subject);
    if (items.empty()) continue;
    if (auto value =
            decode_value(subject.encoding, area(subject.range).item_bits, items, *codec_)) {
      result.values.push_back(std::move(*value));
    } else if (result.state == CommandState::kDone) {
      result.state = CommandState::kFailed;
      result.cause = value.error();
      const std::string place = !subject.name.empty()
                                    ? "channel '" + subject.name + "'"
                                    : "value " + std::to_string(result.values.size() + 1);
      result.reason =
          (subjects_.size() > 1 ? place + ": " : "") +
          (value.error() == Cause::kNotAvailable ? std::string(to_text(value.error()))
                                                 : "the device holds no value of type " +
                                                       std::string(to_text(subject.encoding.type)));
    }
  }
  return result;
}

}  // namespace fieldcast
