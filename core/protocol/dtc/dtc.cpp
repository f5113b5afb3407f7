// The response only repeats address and command, so its length, which follows from the request, is
// checked too.
#include "core/protocol/dtc/dtc.hpp"

#include <algorithm>
#include <array>

#include "core/codec/checksum.hpp"
#include "core/codec/lzw.hpp"
#include "core/protocol/dtc/message.hpp"
#include "core/protocol/dtc/packet.hpp"
#include "core/protocol/option_reader.hpp"
#include "core/protocol/protocol_entry.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::dtc {
namespace {

// Bytes in addition to the response; more means that the line never becomes silent.
constexpr std::size_t kNoiseAllowed = 512;
constexpr std::uint32_t kDefaultMessage = 1024, kLeastMessage = 32;
constexpr Traits kTraits{
    .name = "dtc",
    .summary =
        "DTC: scattered variables of several types in one message, compressed by LZW where it pays",
    .lowest_address = 0,
    .highest_address = 255,
    .max_ranges = 1,  // replaced by a limit from max-message, for each device
    .identity = ResponseIdentity::kAddress,
    .codes = kRefusals};

struct Link {
  std::uint8_t address = 1;
  std::size_t longest = kDefaultMessage;  // message before compression
  std::size_t threshold = kNever;
};

class DtcExchange final : public Exchange {
 public:
  DtcExchange(const Link& link, Request request)
      : link_(link),
        request_(std::move(request)),
        sent_(message_of(link.address, request_)),
        response_size_(message_sizes(request_, link.longest)->response) {}

  Step start(Bytes& out) override {
    append_packet(out, sent_, link_.threshold);
    return Step::send(kPacketHead + response_size_);
  }

  Step on_bytes(ByteView all, Bytes&) override {
    if (all.size() > kPacketHead + response_size_ + kNoiseAllowed)
      return Step::failed(Cause::kOverlong);
    const Step step = scan(all);
    if (open_) received_.assign(all.begin(), all.end());
    return step;
  }

  // Noise may have looked like the head of a packet before the response.
  Step on_silence(Bytes&) override {
    while (open_) {
      const Cause before = silence_;
      ++judged_;
      const Step step = scan(received_);
      if (step.kind != Step::Kind::kNeedMore) return step;
      silence_ = before;
    }
    return Step::failed(silence_);
  }

  const Reply& reply() const override { return reply_; }

 private:
  // Continues where the last call stopped, so that no byte is examined twice.
  Step scan(ByteView all) {
    open_ = false;
    while (judged_ < all.size()) {
      const ByteView bytes = all.subspan(judged_);
      const ParseResult parsed = parse_packet(bytes);
      if (parsed.kind == ParseResult::Kind::kOpen) {
        open_ = true;
        // Otherwise the previous reason is more specific.
        if (!waited_out_) silence_ = Cause::kTruncated;
        return Step::need_rest(parsed.size - bytes.size());
      }
      if (parsed.kind == ParseResult::Kind::kNoise) {
        if (silence_ == Cause::kNoResponse && !is_turnaround(bytes[0]))
          silence_ = Cause::kMalformed;
        ++judged_;
        continue;
      }
      const auto step = judge(parsed);
      if (step) return *step;
    }
    return waited_out_ ? Step::need_rest(0) : Step::need_response();
  }

  // Empty if it is not the response and was skipped.
  std::optional<Step> judge(const ParseResult& parsed) {
    Bytes expanded;
    ByteView message = parsed.content;
    if (parsed.compressed) {
      if (!lzw_decode(parsed.content, parsed.original, expanded))
        return broken(Cause::kMalformed, 1);
      message = expanded;
    }
    if (!ends_with_crc16(message)) return broken(Cause::kChecksum, 1);
    const std::uint8_t command = sent_[1];
    const bool ours = message[0] == link_.address && (message[1] & ~kRefused) == command;
    // A foreign message, or an echo.
    if (!ours || std::ranges::equal(message, sent_)) return broken(Cause::kForeign, parsed.size);
    if ((message[1] & kRefused) != 0) {
      if (message.size() != kRefusalSize) return broken(Cause::kMalformed, parsed.size);
      return Step::failed(Cause::kDeviceError, message[kMessageHead]);
    }
    if (message.size() != response_size_) return broken(Cause::kMalformed, parsed.size);
    reply_ = reply_of(request_,
                      message.subspan(kMessageHead, message.size() - kMessageHead - kCrcBytes));
    return Step::done();
  }

  std::optional<Step> broken(Cause cause, std::size_t size) {
    silence_ = cause;
    judged_ += size;
    waited_out_ = cause != Cause::kForeign;
    return std::nullopt;
  }

  const Link link_;
  const Request request_;
  const Bytes sent_;  // the message
  const std::size_t response_size_;
  std::size_t judged_ = 0;   // bytes that do not begin a response
  bool open_ = false;        // the bytes at judged_ may be an incomplete packet
  bool waited_out_ = false;  // the last packet was broken; it may have been the response
  Bytes received_;           // while open_
  Reply reply_;
  Cause silence_ = Cause::kNoResponse;
};

class DtcProtocol final : public Protocol {
 public:
  explicit DtcProtocol(const Link& link) : link_(link), traits_(kTraits) {
    const std::size_t room = link.longest - kMessageHead - kCrcBytes;
    traits_.max_ranges = static_cast<std::uint16_t>(room / kGroupHead);
    for (AreaIndex type = 0; type < kTypeCount; ++type) {
      areas_[type] = {
          .name = kTypeNames[type],
          .item_bits = kTypeBits[type],
          .type = kValueTypes[type],
          .items = kVariables,
          .writable = true,
          .max_read = static_cast<std::uint16_t>(room * 8 / kTypeBits[type]),
          .max_write = static_cast<std::uint16_t>((room - kGroupHead) * 8 / kTypeBits[type])};
    }
  }

  const Traits& traits() const override { return traits_; }
  std::span<const Area> areas() const override { return areas_; }
  tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at) const override {
    return parse_with_suggestion(at, dtc::parse_address);
  }

  // Sizes without compression, as its gain depends on the values; a packet is never longer.
  std::optional<ExchangeSize> size(const Request& request) const override {
    const auto sizes = message_sizes(request, link_.longest);
    if (!sizes) return std::nullopt;
    return ExchangeSize::of(kPacketHead + sizes->request, kPacketHead + sizes->response);
  }

  std::unique_ptr<Exchange> begin(Request request, ExchangeContext) const override {
    return std::make_unique<DtcExchange>(link_, std::move(request));
  }

  // A response shows its station, its command and its length.
  bool mistakable(const Request& earlier, ExchangeContext, const Request& later,
                  ExchangeContext) const override {
    if (std::holds_alternative<ReadRequest>(earlier) != std::holds_alternative<ReadRequest>(later))
      return false;
    const auto first = message_sizes(earlier, link_.longest);
    const auto second = message_sizes(later, link_.longest);
    return !first || !second || first->response == second->response;
  }

 private:
  const Link link_;
  Traits traits_;
  std::array<Area, kTypeCount> areas_;
};

constexpr std::array<std::string_view, 3> kOptions{"codec-ns-per-byte", "max-message", "threshold"};
// Sum of both ends, with a 32-bit controller at 100 MHz as the device.
constexpr std::uint32_t kCodecNs = 1000;

tl::expected<std::unique_ptr<Protocol>, OptionFault> make(const DeviceLink& link) {
  OptionReader reader(link, kTraits, kOptions);
  Link dtc{.address = static_cast<std::uint8_t>(link.address)};
  dtc.longest = reader.number("max-message", kLeastMessage, kMaxMessage, kDefaultMessage);
  const Duration per_byte{reader.number("codec-ns-per-byte", 0, 1'000'000, kCodecNs)};
  if (reader.fault()) return tl::unexpected(*reader.fault());
  const auto threshold = link.options.find("threshold");
  if (threshold == link.options.end() || threshold->second == "auto") {
    dtc.threshold = auto_threshold(link.line, per_byte);
  } else {
    dtc.threshold = reader.number("threshold", 0, kNever, kNever);
    if (reader.fault()) {
      return tl::unexpected(OptionFault{"threshold", reader.fault()->what,
                                        "auto, or bytes " + reader.fault()->allowed});
    }
  }
  return std::make_unique<DtcProtocol>(dtc);
}

constexpr std::string_view kAddresses[] = {"bit:7",      "int16:100", "int16:101.3", "int32:5",
                                           "int32:6.31", "float32:6", "float64:7",   "int16:65535"};
constexpr ProtocolOption kPlainOptions[] = {{"threshold", "65535"}};
constexpr ProtocolOption kCompressedOptions[] = {{"threshold", "0"}};
constexpr ProtocolVariant kVariants[] = {{.options = kPlainOptions, .addresses = kAddresses},
                                         {.options = kCompressedOptions, .addresses = kAddresses}};

}  // namespace

const ProtocolEntry& entry() {
  static constexpr ProtocolEntry row{
      .name = kTraits.name,
      .summary = kTraits.summary,
      .make = make,
      .explain = explain,
      .seen_request = seen_request,
      .options = kOptions,
      .options_text =
          "`max-message` (bytes of a message, 1024; as the device has it), `threshold` (compresses "
          "requests from so many bytes on; `auto`, `codec-ns-per-byte` 1000: where the line's time "
          "is worth more than the computing of both ends; 65535: never)",
      .variants = kVariants};
  return row;
}

}  // namespace fieldcast::dtc
