// A PPI exchange has two rounds:
//
//     master  68 .. request .. 16
//     slave   E5                       received; the job is queued
//     master  10 DA SA 5C FCS 16       poll, after a pause: some CPUs miss an immediate poll
//     slave   68 .. response .. 16     or E5 again: not ready
//
// After another E5 the master polls again, with the other frame-count bit. A response without E5,
// or directly after it, is accepted too.
#include "core/protocol/s7_ppi/s7_ppi.hpp"

#include <algorithm>
#include <array>

#include "core/protocol/option_reader.hpp"
#include "core/protocol/protocol_entry.hpp"
#include "core/protocol/received.hpp"
#include "core/protocol/s7_ppi/telegram.hpp"
#include "core/protocol/s7comm/message.hpp"
#include "core/protocol/s7comm/s7_200.hpp"

namespace fieldcast::s7_ppi {
namespace {

using s7comm::Judgement;
using s7comm::kErrorCodes;
using s7comm::kS7226Memory;

constexpr std::uint8_t kFirst = 0x6C, kOdd = 0x5C,
                       kEven = 0x7C;      // frame control: first request, then alternating
constexpr std::uint8_t kPositive = 0x00;  // in a short telegram: the same as E5
constexpr std::uint8_t kDataResponse = 0x08;
constexpr std::uint8_t kControlMask = 0x0F;
constexpr unsigned kMaxPolls = 10;
constexpr std::size_t kMaxReceived = 1024;  // four of the largest telegrams

constexpr Traits kTraits{
    .name = "s7-ppi",
    .summary = "Siemens S7-200 PPI: several variables in one telegram, request and poll",
    .lowest_address = 0,
    .highest_address = 126,
    .max_ranges = 19,  // twenty do not fit 240 bytes
    .identity = ResponseIdentity::kSequence,
    .codes = kErrorCodes};

struct Link {
  std::uint8_t station = 2;
  std::uint8_t master = 0;
  Duration poll_delay{};
};

class PpiExchange final : public Exchange {
 public:
  PpiExchange(const Link& link, Request request, std::uint16_t reference)
      : link_(link),
        request_(std::move(request)),
        reference_(reference),
        response_size_(s7comm::message_sizes(kS7226Memory, request_)->response + kLinkHead +
                       kLongFrame) {}

  Step start(Bytes& out) override {
    const std::uint8_t control = reference_ == 0 ? kFirst : reference_ % 2 != 0 ? kOdd : kEven;
    poll_ = control == kOdd ? kEven : kOdd;
    append_long(out, link_.station, link_.master, control,
                s7comm::message_of(kS7226Memory, request_, reference_));
    return Step::send(1);
  }

  Step on_bytes(ByteView all, Bytes&) override {
    if (all.size() > kMaxReceived) return Step::failed(Cause::kOverlong);
    silence_ = cause_of_noise(all);
    acknowledged_ = false;
    Step step = Step::need_response();
    for (std::size_t at = 0; at < all.size();) {
      const Telegram telegram = parse_telegram(all.subspan(at));
      if (telegram.kind == Telegram::Kind::kOpen) {
        silence_ = Cause::kTruncated;
        // A telegram that begins in noise hides the acknowledgement after it; a poll does no harm.
        acknowledged_ = polls_ == 0 && all.back() == kMarkAcknowledge;
        if (acknowledged_) return Step::pause_for(link_.poll_delay);
        return Step::need_rest(telegram.size - (all.size() - at));
      }
      step = take(telegram, step);
      if (step.kind != Step::Kind::kNeedMore) return step;
      at += telegram.size;
    }
    return step;
  }

  Step on_silence(Bytes& out) override {
    if (!acknowledged_) return Step::failed(silence_);
    if (polls_ == kMaxPolls) return Step::failed(Cause::kDeviceBusy);
    ++polls_;
    acknowledged_ = false;
    silence_ = Cause::kNoResponse;
    append_short(out, link_.station, link_.master, poll_);
    poll_ = poll_ == kOdd ? kEven : kOdd;
    return Step::send(response_size_);
  }

  const Reply& reply() const override { return reply_; }

 private:
  // `before`: the wait to continue if this telegram is not relevant.
  Step take(const Telegram& telegram, const Step& before) {
    switch (telegram.kind) {
      case Telegram::Kind::kAcknowledge:
        acknowledged_ = true;
        return Step::pause_for(link_.poll_delay);
      case Telegram::Kind::kShort: return take_short(telegram, before);
      case Telegram::Kind::kLong: return take_long(telegram, before);
      case Telegram::Kind::kBroken:
        silence_ = Cause::kChecksum;
        return acknowledged_ ? before : Step::need_rest(0);
      default: return before;
    }
  }

  bool ours(const Telegram& telegram) const {
    return telegram.to == link_.master && telegram.from == link_.station;
  }

  Step take_short(const Telegram& telegram, const Step& before) {
    if (!ours(telegram)) return before;
    const auto code = static_cast<std::uint8_t>(telegram.control & kControlMask);
    if (code == kPositive) {
      acknowledged_ = true;
      return Step::pause_for(link_.poll_delay);
    }
    return Step::failed(device_code_cause(kErrorCodes, code), code);
  }

  Step take_long(const Telegram& telegram, const Step& before) {
    Judgement judgement{Judgement::Kind::kForeign};
    if (ours(telegram)) {
      judgement = (telegram.control & kControlMask) == kDataResponse
                      ? s7comm::judge(telegram.message, kS7226Memory, request_, reference_)
                      : Judgement{Judgement::Kind::kMalformed};
    }
    switch (judgement.kind) {
      case Judgement::Kind::kResponse: reply_ = std::move(judgement.reply); return Step::done();
      case Judgement::Kind::kRefused:
        return Step::failed(device_code_cause(kErrorCodes, judgement.code), judgement.code);
      case Judgement::Kind::kMalformed: silence_ = Cause::kMalformed; break;
      case Judgement::Kind::kForeign: silence_ = Cause::kForeign; break;
    }
    return before;
  }

  const Link link_;
  const Request request_;
  const std::uint16_t reference_;
  const std::size_t response_size_;
  std::uint8_t poll_ = kOdd;
  unsigned polls_ = 0;
  // E5 arrived since the last send: the pause before the next poll runs.
  bool acknowledged_ = false;
  Reply reply_;
  Cause silence_ = Cause::kNoResponse;
};

class PpiProtocol final : public Protocol {
 public:
  explicit PpiProtocol(const Link& link) : link_(link) {}
  const Traits& traits() const override { return kTraits; }
  std::span<const Area> areas() const override { return s7comm::kS7226Areas; }
  tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at) const override {
    return parse_with_suggestion(at, [](std::string_view text) {
      return s7comm::parse_s7_200_address(s7comm::kS7226Areas, text);
    });
  }

  std::optional<ExchangeSize> size(const Request& request) const override {
    const auto sizes = s7comm::message_sizes(kS7226Memory, request);
    if (!sizes) return std::nullopt;
    return ExchangeSize::of(sizes->request + kLinkHead + kLongFrame + kShortSize,
                            1 + sizes->response + kLinkHead + kLongFrame, 2, link_.poll_delay);
  }

  std::unique_ptr<Exchange> begin(Request request, ExchangeContext context) const override {
    return std::make_unique<PpiExchange>(link_, std::move(request), context.sequence);
  }

 private:
  const Link link_;
};

constexpr std::array<std::string_view, 2> kOptions{"master", "poll-delay-ms"};

tl::expected<std::unique_ptr<Protocol>, OptionFault> make(const DeviceLink& link) {
  OptionReader reader(link, kTraits, kOptions);
  Link ppi{.station = static_cast<std::uint8_t>(link.address)};
  ppi.master = static_cast<std::uint8_t>(reader.number("master", 0, 126, 0));
  ppi.poll_delay = std::chrono::milliseconds{reader.number("poll-delay-ms", 0, 1000, 10)};
  if (reader.fault()) return tl::unexpected(*reader.fault());
  if (link.options.contains("master") && ppi.master == ppi.station) {
    return tl::unexpected(OptionFault{"master", "the master's address is the station's own",
                                      "0..126 without the stations of the bus"});
  }
  return std::make_unique<PpiProtocol>(ppi);
}

constexpr ProtocolAlias kAliases[] = {{"ppi"}, {"s7-200"}};
constexpr ProtocolVariant kVariants[] = {{.addresses = s7comm::kS7200Addresses}};

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
          "`master` (our address, 0), `poll-delay-ms` (between acknowledge and poll, 10)",
      .factory_line = {9600, 8, Parity::kEven, 1},
      .aliases = kAliases,
      .variants = kVariants};
  return row;
}

}  // namespace fieldcast::s7_ppi
