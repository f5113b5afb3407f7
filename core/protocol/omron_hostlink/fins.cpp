#include "core/protocol/omron_hostlink/fins.hpp"

#include <algorithm>
#include <cstdlib>

#include "core/codec/digits.hpp"
#include "core/protocol/omron_hostlink/hostlink.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::omron {
namespace {

constexpr std::size_t kMaxFinsReceived = 4096;  // three of the largest frames
constexpr std::uint16_t kRead = 0x0101, kWrite = 0x0102, kReadMany = 0x0104;
constexpr std::size_t kDirectHeader = 4, kRelayedHeader = 10;  // bytes up to SID, inclusive
constexpr std::size_t kCommandSize = 2, kEndSize = 2, kItemSize = 4, kCountSize = 2;
constexpr std::uint8_t kResponseFlag = 0x40, kRelayedFlag = 0x80;
constexpr std::uint8_t kGatewayCount = 0x02;
// Host Link part of a request and of a response: @uuFA and w or ee, FCS * CR.
constexpr std::size_t kRequestFrame = kHeadSize + 1 + kFcsSize + 2;
constexpr std::size_t kResponseFrame = kHeadSize + kEndCodeSize + kFcsSize + 2;

const AreaRow& fins_row(const Range& range) { return *reached_in(Mode::kFins).rows[range.area]; }
std::size_t header_size(const FinsRoute& route) {
  return route.relayed ? kRelayedHeader : kDirectHeader;
}
std::size_t item_bytes(const Range& range) { return fins_row(range).flags ? 1 : 2; }

bool fits_fins(const Range& range, bool write) {
  const auto& areas = reached_in(Mode::kFins).areas;
  // Each bank of EM has its own area code.
  return fieldcast::fits(areas, range, write) &&
         in_one_bank(areas[range.area], range.first, range.end());
}

void append_address(Bytes& out, const Range& range, std::optional<std::uint8_t> bit = {}) {
  const AreaRow& row = fins_row(range);
  std::uint32_t first = range.first + row.fins_offset;
  std::uint8_t code = bit || row.flags ? row.bit_code : row.word_code;
  if (is_extended(row)) {
    code = static_cast<std::uint8_t>(code + first / kBankWords);
    first %= kBankWords;
  }
  out.push_back(code);
  append_u16(out, static_cast<std::uint16_t>(first));
  out.push_back(bit.value_or(0));
}

struct Sizes {
  std::size_t request = 0;   // bytes of command and parameters
  std::size_t response = 0;  // bytes of data
};

std::optional<Sizes> sizes_of(const ReadRequest& read) {
  if (read.ranges.empty() || read.ranges.size() > kFinsItems) return std::nullopt;
  for (const Range& range : read.ranges) {
    if (!fits_fins(range, false)) return std::nullopt;
  }
  if (read.ranges.size() == 1) {
    return Sizes{kCommandSize + kItemSize + kCountSize,
                 read.ranges[0].count * item_bytes(read.ranges[0])};
  }
  Sizes sizes{kCommandSize, 0};
  std::size_t items = 0;
  for (const Range& range : read.ranges) {
    items += range.count;
    sizes.request += range.count * kItemSize;
    sizes.response += range.count * (1 + item_bytes(range));
  }
  if (items > kFinsItems) return std::nullopt;
  return sizes;
}

std::optional<Sizes> sizes_of(const WriteRequest& write) {
  if (!fits_fins(write.range, true) || write.items.size() != image_bytes(16, write.range.count))
    return std::nullopt;
  if (write.bit &&
      (write.range.count != 1 || *write.bit > 15 || fins_row(write.range).bit_code == 0))
    return std::nullopt;
  return Sizes{kCommandSize + kItemSize + kCountSize + (write.bit ? 1 : write.items.size()), 0};
}

std::optional<Sizes> sizes_of(const Request& request) {
  if (const auto* read = std::get_if<ReadRequest>(&request)) return sizes_of(*read);
  if (const auto* write = std::get_if<WriteRequest>(&request)) return sizes_of(*write);
  return std::nullopt;
}

class FinsExchange final : public Exchange {
 public:
  FinsExchange(const FinsRoute& route, std::uint8_t sid, const Request& request) : route_(route) {
    const auto sizes = sizes_of(request);
    if (!sizes) std::abort();  // see REQUIRES of begin_fins()
    response_size_ = sizes->response;
    append_header(sid);
    if (const auto* write = std::get_if<WriteRequest>(&request)) {
      append_write(*write);
    } else {
      ranges_ = std::get<ReadRequest>(request).ranges;
      append_read();
    }
  }

  Step start(Bytes& out) override {
    append_head(out, route_.host_unit, "FA");
    append_digits(out, route_.wait, 1);
    append_hex_bytes(out, message_);
    append_end(out, 0, true);
    return Step::send(frame_size());
  }

  Step on_bytes(ByteView all, Bytes&) override {
    if (all.size() > kMaxFinsReceived) return Step::failed(Cause::kOverlong);
    return search_frames(all, frame_size(), silence_, [&](const ParseResult& parsed) {
      return judge(parsed.text, parsed.last);
    });
  }

  Step on_silence(Bytes&) override { return Step::failed(silence_); }
  const Reply& reply() const override { return reply_; }

 private:
  std::size_t frame_size() const {
    return kResponseFrame + 2 * (header_size(route_) + kCommandSize + kEndSize + response_size_);
  }

  void append_header(std::uint8_t sid) {
    if (route_.relayed)
      message_ = {kRelayedFlag, 0, kGatewayCount, route_.network, route_.node, route_.unit, 0, 0, 0,
                  sid};
    else
      message_ = {0, route_.unit, 0, sid};
  }

  void append_read() {
    if (ranges_.size() == 1) {
      append_u16(message_, kRead);
      append_address(message_, ranges_[0]);
      append_u16(message_, static_cast<std::uint16_t>(ranges_[0].count));
      return;
    }
    append_u16(message_, kReadMany);
    for (const Range& range : ranges_) {
      for (std::uint32_t i = 0; i < range.count; ++i)
        append_address(message_, {range.area, range.first + i, 1});
    }
  }

  void append_write(const WriteRequest& write) {
    append_u16(message_, kWrite);
    append_address(message_, write.range, write.bit);
    append_u16(message_, static_cast<std::uint16_t>(write.range.count));
    if (write.bit)
      message_.push_back((read_u16(write.items) >> *write.bit & 1) != 0 ? 1 : 0);
    else
      append(message_, write.items);
  }

  Step judge(ByteView text, bool last) {
    silence_ = Cause::kForeign;
    if (text.size() < kHeadSize || read_digits(text.subspan(1, 2), 10) != route_.host_unit)
      return Step::need_response();
    if (text[3] != 'F' || text[4] != 'A') return Step::need_response();
    silence_ = Cause::kMalformed;
    const auto bytes = read_hex_bytes(text.subspan(kHeadSize));
    if (!last || !bytes || bytes->empty()) return Step::need_response();
    const std::uint8_t end_code = bytes->front();
    const std::size_t head = header_size(route_);
    const ByteView message = ByteView(*bytes).subspan(1);
    if (message.size() >= head && (message[0] & kResponseFlag) != 0 &&
        message[head - 1] != message_[head - 1]) {
      silence_ = Cause::kForeign;  // a response to an earlier request
      return Step::need_response();
    }
    if (end_code != 0) {
      const bool shaped =
          message.empty() || (message.size() > head && (message[0] & kResponseFlag) != 0);
      return shaped ? Step::failed(device_code_cause(kEndCodes, end_code), end_code)
                    : Step::need_response();
    }
    return judge_message(message, head);
  }

  Step judge_message(ByteView message, std::size_t head) {
    if (message.size() < head + kCommandSize + kEndSize) return Step::need_response();
    const std::uint8_t flags = message[0];
    if ((flags & kResponseFlag) == 0 || ((flags & kRelayedFlag) != 0) != route_.relayed)
      return Step::need_response();
    if (!std::equal(message.begin() + static_cast<std::ptrdiff_t>(head),
                    message.begin() + static_cast<std::ptrdiff_t>(head + kCommandSize),
                    message_.begin() + static_cast<std::ptrdiff_t>(head))) {
      silence_ = Cause::kForeign;
      return Step::need_response();
    }
    // Bit 7 of the first byte: a relay failed. Bits 7 and 6 of the second byte only report errors
    // of the CPU.
    const std::uint16_t end = read_u16(message, head + kCommandSize) & 0xFF3F;
    const ByteView data = message.subspan(head + kCommandSize + kEndSize);
    if (end != 0) {
      // Only a relay adds data (the failed node). The XOR does not detect the loss of two equal
      // characters.
      const bool shaped = data.empty() || ((end & 0x8000) != 0 && data.size() == 2);
      const Cause cause = device_code_cause(kFinsCodes, end & 0x7FFF);
      return shaped ? Step::failed(cause, end) : Step::need_response();
    }
    if (data.size() != response_size_) return Step::need_response();
    return ranges_.size() > 1 ? unpack_many(data) : unpack(data);
  }

  Step unpack(ByteView data) {
    RangeReply reply{.items = Bytes(data.begin(), data.end())};
    if (!ranges_.empty() && fins_row(ranges_[0]).flags && !are_bits(reply.items))
      return Step::need_response();
    reply_.push_back(std::move(reply));
    return Step::done();
  }

  // Each item repeats its area code.
  Step unpack_many(ByteView data) {
    Reply reply(ranges_.size());
    ByteView requested = ByteView(message_).subspan(header_size(route_) + kCommandSize);
    for (std::size_t r = 0; r < ranges_.size(); ++r) {
      const std::size_t size = item_bytes(ranges_[r]);
      for (std::uint32_t i = 0; i < ranges_[r].count; ++i) {
        if (data[0] != requested[0]) return Step::need_response();
        append(reply[r].items, data.subspan(1, size));
        data = data.subspan(1 + size);
        requested = requested.subspan(kItemSize);
      }
      if (fins_row(ranges_[r]).flags && !are_bits(reply[r].items)) return Step::need_response();
    }
    reply_ = std::move(reply);
    return Step::done();
  }

  static bool are_bits(ByteView items) {
    return std::ranges::all_of(items, [](auto item) { return item <= 1; });
  }

  const FinsRoute route_;
  Bytes message_;              // header and command
  std::vector<Range> ranges_;  // of a read
  std::size_t response_size_ = 0;
  Reply reply_;
  Cause silence_ = Cause::kNoResponse;
};

}  // namespace

std::optional<ExchangeSize> fins_size(const FinsRoute& route, const Request& request) {
  const auto sizes = sizes_of(request);
  if (!sizes) return std::nullopt;
  const std::size_t head = header_size(route);
  const bool long_request = head + sizes->request > kFinsRequestBytes;
  if (long_request || head + kCommandSize + kEndSize + sizes->response > kFinsResponseBytes)
    return std::nullopt;
  return ExchangeSize::of(kRequestFrame + 2 * (head + sizes->request),
                          kResponseFrame + 2 * (head + kCommandSize + kEndSize + sizes->response),
                          1, std::chrono::milliseconds{10} * route.wait);
}

std::unique_ptr<Exchange> begin_fins(const FinsRoute& route, std::uint8_t sid,
                                     const Request& request) {
  return std::make_unique<FinsExchange>(route, sid, request);
}

std::string_view fins_end_text(std::uint16_t code) {
  // Codes below 0100 belong to the surrounding frame, except for two FINS codes.
  if (code == 0x0000) return "normal completion";
  if (code == 0x0001) return "service interrupted";
  const auto text = device_code_text(kFinsCodes, code);
  return code < 0x100 || text.empty() ? "unknown end code" : text;
}

}  // namespace fieldcast::omron
