#include "core/protocol/omron_hostlink/c_mode.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "core/codec/digits.hpp"
#include "core/protocol/omron_hostlink/hostlink.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::omron {
namespace {

constexpr std::size_t kMaxReceived = 1024;  // since the last send: eight frames
constexpr std::uint32_t kWordDigits = 4;

const AreaRow& row_of(const Range& range) { return *reached_in(Mode::kCMode).rows[range.area]; }
std::uint32_t digits_of(const Range& range) {
  return row_of(range).flags ? range.count : range.count * kWordDigits;
}

bool fits_c_mode(const Range& range, bool write) {
  if (!fieldcast::fits(reached_in(Mode::kCMode).areas, range, write)) return false;
  // Limit of a bank with four digits.
  return !is_extended(row_of(range)) || range.first % kBankWords + range.count <= 10000;
}

// Number of frames for the data characters.
std::uint32_t frames_for(std::uint32_t digits, std::uint32_t first, std::uint32_t later) {
  return digits <= first ? 1 : 1 + (digits - first + later - 1) / later;
}

void append_first(Bytes& out, const Range& range) {
  const AreaRow& row = row_of(range);
  std::uint32_t first = range.first + row.c_offset;
  if (is_extended(row)) {
    append_digits(out, first / kBankWords, 2);
    first %= kBankWords;
  }
  append_digits(out, first, 4, 10);
}
std::uint32_t first_size(const Range& range) { return is_extended(row_of(range)) ? 6 : 4; }

// First frame of the response, and aborting a transfer, for reads and writes.
class CModeExchange : public Exchange {
 public:
  CModeExchange(std::uint16_t unit, std::string header) : unit_(unit), header_(std::move(header)) {}

  Step on_bytes(ByteView all, Bytes& out) final {
    if (giving_up_) return Step::need_response();
    if (all.size() > kMaxReceived) return fail(Cause::kOverlong, out);
    return take(all, out);
  }
  Step on_silence(Bytes& out) final {
    if (giving_up_) return Step::failed(silence_);
    return fail(silence_, out);
  }
  const Reply& reply() const final { return reply_; }

 protected:
  virtual Step take(ByteView all, Bytes& out) = 0;
  // `text`: the response to the command after its end code 00.
  virtual Step accept(ByteView text, bool last, Bytes& out) = 0;

  // `expected`: characters of the whole expected frame.
  Step search(ByteView all, std::size_t expected, Bytes& out) {
    return search_frames(all, expected, silence_,
                         [&](const ParseResult& parsed) { return judge(parsed, out); });
  }

  // While a transfer is open, the PLC treats any command as a delimiter. XZ closes it and has no
  // response.
  Step fail(Cause cause, Bytes& out) {
    silence_ = cause;
    if (!open_) return Step::failed(cause);
    giving_up_ = true;
    out.clear();
    append_head(out, unit_, "XZ");
    append_end(out, 0, true);
    return Step::send(0);
  }

  const std::uint16_t unit_;
  const std::string header_;
  Reply reply_;
  Cause silence_ = Cause::kNoResponse;
  bool open_ = false;  // more frames are expected or to be sent

 private:
  Step judge(const ParseResult& parsed, Bytes& out) {
    const ByteView text = parsed.text;
    silence_ = Cause::kForeign;
    if (text.size() < kHeadSize || read_digits(text.subspan(1, 2), 10) != unit_)
      return Step::need_response();
    const std::string header(text.begin() + 3, text.begin() + kHeadSize);
    if (header == "IC" && parsed.last) return Step::failed(Cause::kDeviceError, kNotSupported);
    if (header != header_) return Step::need_response();
    silence_ = Cause::kMalformed;
    if (text.size() < kHeadSize + kEndCodeSize) return Step::need_response();
    const auto code = read_digits(text.subspan(kHeadSize, kEndCodeSize));
    if (!code) return Step::need_response();
    const ByteView data = text.subspan(kHeadSize + kEndCodeSize);
    if (*code == 0) return accept(data, parsed.last, out);
    // The XOR does not detect the loss of two equal characters.
    if (!data.empty() || !parsed.last) return Step::need_response();
    const auto refused = static_cast<std::uint16_t>(*code);
    return Step::failed(device_code_cause(kEndCodes, refused), refused);
  }

  bool giving_up_ = false;
};

class CModeRead final : public CModeExchange {
 public:
  CModeRead(std::uint16_t unit, const Range& range)
      : CModeExchange(unit, {'R', row_of(range).letter}),
        range_(range),
        digits_(digits_of(range)),
        flags_(row_of(range).flags) {}

  Step start(Bytes& out) override {
    append_head(out, unit_, header_);
    append_first(out, range_);
    append_digits(out, range_.count, 4, 10);
    append_end(out, 0, true);
    return Step::send(static_cast<std::uint32_t>(kHeadSize + kEndCodeSize) +
                      frame_size(flags_ ? kFlagsFirst : kReadFirst));
  }

 private:
  // Characters of the next frame from its data on, if the PLC fills it to its limit.
  std::uint32_t frame_size(std::uint32_t capacity) const {
    const auto left = static_cast<std::uint32_t>(digits_ - data_.size());
    return std::min(left, capacity) + static_cast<std::uint32_t>(end_size(left <= capacity));
  }

  Step take(ByteView all, Bytes& out) override {
    if (open_) {  // an adapter may add noise behind our delimiter
      const auto noise = std::ranges::find_if_not(all, is_turnaround) - all.begin();
      all = all.subspan(static_cast<std::size_t>(noise));
      if (all.empty()) return Step::need_response();
    }
    if (!open_ || all.front() == kAt) {
      const std::uint32_t first = open_ ? 0 : frame_size(flags_ ? kFlagsFirst : kReadFirst);
      return search(all, kHeadSize + kEndCodeSize + first, out);
    }
    const ParseResult parsed = later_frame(all);
    if (parsed.kind == ParseResult::Kind::kFrame) return accept(parsed.text, parsed.last, out);
    silence_ = parsed.kind == ParseResult::Kind::kBroken ? Cause::kChecksum : Cause::kTruncated;
    const std::size_t whole = frame_size(kReadLater);
    return Step::need_rest(
        parsed.kind == ParseResult::Kind::kOpen ? whole - std::min(whole - 1, all.size()) : 0);
  }

  Step accept(ByteView text, bool last, Bytes& out) override {
    // No word is split between two frames.
    const bool whole = flags_ || text.size() % kWordDigits == 0;
    const bool fits = whole && (last ? data_.size() + text.size() == digits_
                                     : !text.empty() && data_.size() + text.size() < digits_);
    if (!fits) {
      silence_ = Cause::kMalformed;
      // Before the first frame, this is a response to an earlier request.
      return open_ ? fail(Cause::kMalformed, out) : Step::need_response();
    }
    append(data_, text);
    if (!last) {
      open_ = true;
      out.push_back(kCr);
      return Step::send(frame_size(flags_ ? kFlagsLater : kReadLater));
    }
    open_ = false;
    return finish();
  }

  Step finish() {
    RangeReply reply;
    if (flags_) {
      for (const std::uint8_t c : data_) {
        if (c != '0' && c != '1') return Step::failed(Cause::kMalformed);
        reply.items.push_back(c - '0');
      }
    } else {
      auto bytes = read_hex_bytes(data_);
      if (!bytes) return Step::failed(Cause::kMalformed);
      reply.items = std::move(*bytes);
    }
    reply_.push_back(std::move(reply));
    return Step::done();
  }

  const Range range_;
  const std::size_t digits_;
  const bool flags_;
  Bytes data_;
};

class CModeWrite final : public CModeExchange {
 public:
  CModeWrite(std::uint16_t unit, const WriteRequest& write)
      : CModeExchange(unit, {'W', row_of(write.range).letter}), range_(write.range) {
    if (row_of(range_).flags) {
      for (const std::uint8_t item : write.items) data_.push_back(item != 0 ? '1' : '0');
    } else {
      append_hex_bytes(data_, write.items);
    }
  }

  Step start(Bytes& out) override {
    append_head(out, unit_, header_);
    append_first(out, range_);
    return send_next(kWriteFirst, 0, out);
  }

 private:
  static constexpr std::size_t kResponse = kHeadSize + kEndCodeSize + kFcsSize + 2;

  Step send_next(std::size_t capacity, std::size_t start, Bytes& out) {
    const std::size_t size = std::min(capacity, data_.size() - sent_);
    append(out, ByteView(data_).subspan(sent_, size));
    sent_ += size;
    open_ = sent_ < data_.size();
    append_end(out, start, !open_);
    return Step::send(open_ ? 1 : kResponse);
  }

  Step take(ByteView all, Bytes& out) override {
    const auto cr = std::ranges::find(all, kCr);
    if (open_ && cr != all.end() && std::find(all.begin(), cr, kAt) == cr) {
      out.clear();
      return send_next(kWriteLater, 0, out);
    }
    return search(all, kResponse, out);
  }

  Step accept(ByteView text, bool last, Bytes&) override {
    if (open_ || !last || !text.empty()) return Step::need_response();
    reply_.emplace_back();
    return Step::done();
  }

  const Range range_;
  Bytes data_;
  std::size_t sent_ = 0;
};

ExchangeSize read_size(const Range& range) {
  const std::uint32_t digits = digits_of(range);
  const bool flags = row_of(range).flags;
  const std::uint32_t frames =
      frames_for(digits, flags ? kFlagsFirst : kReadFirst, flags ? kFlagsLater : kReadLater);
  return ExchangeSize::of(kHeadSize + first_size(range) + 4 + 4 + (frames - 1),
                          kHeadSize + kEndCodeSize + digits + 3 * frames + 1, frames);
}

ExchangeSize write_size(const Range& range) {
  const std::uint32_t digits = digits_of(range);
  const std::uint32_t frames = frames_for(digits, kWriteFirst, kWriteLater);
  return ExchangeSize::of(kHeadSize + first_size(range) + digits + 3 * frames + 1,
                          11 + (frames - 1), frames);
}

}  // namespace

std::optional<ExchangeSize> c_mode_size(const Request& request) {
  if (const auto* read = std::get_if<ReadRequest>(&request)) {
    if (read->ranges.size() != 1) return std::nullopt;
    const Range& range = read->ranges.front();
    return fits_c_mode(range, false) ? std::optional(read_size(range)) : std::nullopt;
  }
  const auto* write = std::get_if<WriteRequest>(&request);
  if (write == nullptr || write->bit) return std::nullopt;
  const Range& range = write->range;
  if (!fits_c_mode(range, true) ||
      write->items.size() != image_bytes(row_of(range).flags ? 1 : 16, range.count))
    return std::nullopt;
  return write_size(range);
}

std::unique_ptr<Exchange> begin_c_mode(std::uint16_t unit, const Request& request) {
  if (const auto* read = std::get_if<ReadRequest>(&request))
    return std::make_unique<CModeRead>(unit, read->ranges.front());
  return std::make_unique<CModeWrite>(unit, std::get<WriteRequest>(request));
}

bool c_mode_mistakable(const Request& earlier, const Request& later) {
  const auto* first = std::get_if<ReadRequest>(&earlier);
  const auto* second = std::get_if<ReadRequest>(&later);
  if ((first == nullptr) != (second == nullptr)) return false;
  if (first != nullptr) {
    const Range &a = first->ranges.front(), &b = second->ranges.front();
    return row_of(a).letter == row_of(b).letter && digits_of(a) == digits_of(b);
  }
  return row_of(std::get<WriteRequest>(earlier).range).letter ==
         row_of(std::get<WriteRequest>(later).range).letter;
}

}  // namespace fieldcast::omron
