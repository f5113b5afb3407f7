// Full duplex, one PLC on the line:                  Half duplex, the bridge is the master:
//
//     bridge  10 02 command 10 03 check                  10 01 STN 10 02 command 10 03 check
//     PLC     10 06                                      10 06
//     bridge                                             10 05 STN BCC      poll
//     PLC     10 02 response 10 03 check                 10 04 not ready, or the response
//     bridge  10 06                                      10 06
//
// A packet that the bridge does not acknowledge keeps the PLC from sending the next one. So the
// bridge acknowledges every valid packet, also a late response and a command of the PLC, and with
// full duplex it requests a damaged packet again with a NAK. This waits for a gap, since each send
// discards the received bytes. A PLC that only acknowledges the command may wait for the
// acknowledgement of a lost response, so one NAK requests this one, too.
#include "core/protocol/allen_bradley_df1/allen_bradley_df1.hpp"

#include <algorithm>
#include <array>

#include "core/protocol/allen_bradley_df1/command.hpp"
#include "core/protocol/allen_bradley_df1/frame.hpp"
#include "core/protocol/option_reader.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::df1 {
namespace {

constexpr std::size_t kMaxReceived = 2400;  // four of the largest responses
constexpr unsigned kMaxRepairs = 4, kMaxPolls = 50;

constexpr Traits kTraits{
    .name = "allen-bradley-df1",
    .summary = "Allen-Bradley SLC 500 and MicroLogix on RS-232 and RS-485 (DF1)",
    .lowest_address = 0,
    .highest_address = 254,
    .identity = ResponseIdentity::kSequence,
    .codes = kCodes};

struct Link {
  Nodes nodes;
  Check check = Check::kCrc;
  bool half_duplex = false;
  Duration poll_delay{};
};

class Df1Exchange final : public Exchange {
 public:
  Df1Exchange(const Link& link, Request request, std::uint16_t tns)
      : link_(link), request_(std::move(request)), tns_(tns) {}

  Step start(Bytes& out) override {
    append_packet(out, command_of(request_, link_.nodes, tns_), link_.check,
                  link_.half_duplex ? std::optional(station()) : std::nullopt);
    return Step::send(link_.half_duplex ? kSymbol : expected());
  }

  Step on_bytes(ByteView all, Bytes& out) override {
    if (all.size() > kMaxReceived) return Step::failed(Cause::kOverlong);
    next_.clear();
    not_ready_ = false;
    Step step = Step::need_response();
    std::size_t inside = 0;  // end of a packet that is open or damaged: symbols in it do not count
    bool mixed = false;      // a packet behind a damaged one can be the parts of two
    for (std::size_t at = 0; at < all.size();) {
      const Symbol symbol = parse_symbol(all.subspan(at), link_.check);
      const bool packet = symbol.kind == Symbol::Kind::kPacket && !mixed;
      const bool control = symbol.kind == Symbol::Kind::kControl && at >= inside;
      if (packet) step = take(symbol.packet, out);
      if (step.kind != Step::Kind::kNeedMore) return step;
      if (control) step = take(symbol.control, step);
      if (!packet && !control && at >= inside) {
        if (symbol.kind != Symbol::Kind::kNoise) {
          step = damaged(symbol);
          mixed = true;
        } else if (!is_turnaround(all[at])) {
          note(Cause::kMalformed);
        }
        inside = at + symbol.size;
      }
      at += packet || control ? symbol.size : 1;
    }
    return step;
  }

  Step on_silence(Bytes& out) override {
    const unsigned most = link_.half_duplex ? kMaxPolls : kMaxRepairs;
    const bool waits = next_.empty() && acknowledged_ && !link_.half_duplex;
    if (waits && !std::exchange(requested_again_, true)) append_symbol(next_, kNak);
    if (rounds_++ == most && not_ready_) return Step::failed(Cause::kDeviceBusy);
    if (next_.empty() || rounds_ > most) return Step::failed(cause_);
    out = std::exchange(next_, {});
    return Step::send(expected());
  }

  const Reply& reply() const override { return reply_; }

 private:
  std::uint8_t station() const { return static_cast<std::uint8_t>(link_.nodes.plc); }
  std::size_t expected() const {
    return kSymbol + response_size(request_) + kEnvelope + size_of(link_.check);
  }
  // Keeps the first finding; noise is the least.
  void note(Cause cause) {
    if (cause_ == Cause::kNoResponse || cause_ == Cause::kMalformed) cause_ = cause;
  }
  void poll_next() {
    if (acknowledged_) append_poll(next_, station());
  }

  Step take(std::uint8_t control, const Step& before) {
    if (control == kNak && !acknowledged_) {
      note(Cause::kChecksum);
      next_.clear();
      (void)start(next_);
      return Step::need_rest(0);
    }
    const bool first = control == kAck && !std::exchange(acknowledged_, true);
    if (!link_.half_duplex) {
      if (control != kEnq) return before;
      next_ = {kDle, kNak};
      return Step::need_rest(0);
    }
    if (!first && (control != kEot || !acknowledged_)) return before;
    not_ready_ = !first;
    next_.clear();
    poll_next();
    return Step::pause_for(first ? Duration{} : link_.poll_delay);
  }

  Step damaged(const Symbol& symbol) {
    note(symbol.kind == Symbol::Kind::kOpen ? Cause::kTruncated : Cause::kChecksum);
    next_.clear();
    link_.half_duplex ? poll_next() : append_symbol(next_, kNak);
    return Step::need_rest(symbol.missing);
  }

  Step take(ByteView packet, Bytes& out) {
    Judgement judgement = judge(packet, request_, link_.nodes, tns_);
    if (judgement.code != 0 || judgement.cause == Cause::kNone) {
      append_symbol(out, kAck);
      reply_ = std::move(judgement.reply);
      return judgement.code == 0 ? Step::done() : Step::failed(judgement.cause, judgement.code);
    }
    note(judgement.cause);
    next_ = {kDle, kAck};
    if (link_.half_duplex) poll_next();
    return Step::need_rest(0);
  }

  const Link link_;
  const Request request_;
  const std::uint16_t tns_;
  bool acknowledged_ = false, not_ready_ = false, requested_again_ = false;
  Bytes next_;  // what is sent after a gap
  unsigned rounds_ = 0;
  Cause cause_ = Cause::kNoResponse;
  Reply reply_;
};

class Df1Protocol final : public Protocol {
 public:
  Df1Protocol(const Link& link, std::uint32_t bytes) : link_(link), areas_(areas_of(bytes)) {}
  const Traits& traits() const override { return kTraits; }
  std::span<const Area> areas() const override { return areas_; }
  tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at) const override {
    return parse_with_suggestion(at,
                                 [](std::string_view text) { return df1::parse_address(text); });
  }

  std::optional<ExchangeSize> size(const Request& request) const override {
    const auto* read = std::get_if<ReadRequest>(&request);
    const auto* write = std::get_if<WriteRequest>(&request);
    if (read != nullptr ? read->ranges.size() != 1 || !fits(read->ranges[0], false)
                        : write == nullptr || !fits(*write))
      return std::nullopt;
    const Range& range = read != nullptr ? read->ranges[0] : write->range;
    const Place place = place_of(file_rows()[range.area], range, write != nullptr);
    // CMD, STS, TNS, FNC and type. Each byte 10 is doubled, at most both of TNS; those of the
    // response are unknown.
    std::size_t command = 6 + 2 + kEnvelope + size_of(link_.check);
    const auto doubled = [](std::uint32_t number) {
      return (number & 0xFF) == kDle || number >> 8 == kDle ? 1u : 0u;
    };
    for (const std::uint32_t number :
         {link_.nodes.plc, link_.nodes.source, place.bytes, place.file, place.element, place.sub})
      command += (number < 0xFF ? 1 : 3) + doubled(number);
    if (write != nullptr) {
      for (const std::uint8_t byte : write->items) command += 1 + doubled(byte);
      if (write->bit) command += 2 + doubled(1u << *write->bit);
    }
    const std::size_t response =
        kSymbol + response_size(request) + kEnvelope + size_of(link_.check);
    if (!link_.half_duplex) return ExchangeSize::of(command + kSymbol, response);
    const std::size_t station = link_.nodes.plc == kDle ? 2 : 1;
    return ExchangeSize::of(command + 3 * kSymbol + 2 * station + 1, response + kSymbol, 2);
  }

  std::unique_ptr<Exchange> begin(Request request, ExchangeContext context) const override {
    return std::make_unique<Df1Exchange>(link_, std::move(request), context.sequence);
  }

 private:
  bool fits(const Range& range, bool write) const {
    return fieldcast::fits(areas_, range, write) &&
           in_one_bank(areas_[range.area], range.first, range.end()) &&
           place_of(file_rows()[range.area], range, write).bytes <=
               areas_[range.area].max_read * areas_[range.area].item_bits / 8;
  }
  bool fits(const WriteRequest& write) const {
    if (!fits(write.range, true) || write.bits != 1) return false;
    const unsigned item_bits = areas_[write.range.area].item_bits;
    if (write.bit && (write.range.count != 1 || *write.bit >= 16 || item_bits != 16)) return false;
    return write.items.size() == image_bytes(item_bits, write.range.count);
  }

  const Link link_;
  const std::vector<Area> areas_;
};

constexpr std::array<std::string_view, 5> kOptions{"check", "duplex", "max-bytes", "poll-delay-ms",
                                                   "source"};

tl::expected<std::unique_ptr<Protocol>, OptionFault> make(const DeviceLink& link) {
  OptionReader reader(link, kTraits, kOptions);
  Link df1{.nodes = {.plc = link.address}};
  df1.check = reader.choice("check", {"crc", "bcc"}) == 0 ? Check::kCrc : Check::kBcc;
  df1.half_duplex = reader.choice("duplex", {"full", "half"}) == 1;
  df1.nodes.source = reader.number("source", 0, 254, 0);
  df1.poll_delay = std::chrono::milliseconds{reader.number("poll-delay-ms", 0, 1000, 10)};
  const std::uint32_t bytes = reader.number("max-bytes", 6, kMaxRead, kMaxRead);
  if (reader.fault()) return tl::unexpected(*reader.fault());
  return std::make_unique<Df1Protocol>(df1, bytes);
}

constexpr std::string_view kAddresses[] = {
    "N7:0",    "N7:1/3",   "N255:999", "B3:0/5",   "B3/21",   "B3:2",       "F8:3",
    "L9:0",    "L9:1/17",  "T4:0.ACC", "T4:1.PRE", "T4:0/DN", "T4:3.ACC/1", "C5:0.ACC",
    "C5:1/CU", "R6:0.LEN", "R6:0.POS", "R6:1/DN",  "S:1",     "S:1/15",     "S2:4",
    "O:0.0",   "O:0/3",    "I:1.0/3",  "I:1.2",    "I:2/17"};
constexpr ProtocolOption kBccOption[] = {{"check", "bcc"}};
constexpr ProtocolOption kHalfOption[] = {{"duplex", "half"}};
constexpr ProtocolOption kHalfBccOptions[] = {{"check", "bcc"}, {"duplex", "half"}};
constexpr ProtocolAlias kAliases[] = {{"df1"}, {"slc-500"}, {"micrologix"}};
constexpr ProtocolVariant kVariants[] = {{.addresses = kAddresses},
                                         {.options = kBccOption, .addresses = kAddresses},
                                         {.options = kHalfOption, .addresses = kAddresses},
                                         {.options = kHalfBccOptions, .addresses = kAddresses}};

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
          "`check: bcc` (instead of `crc`), `duplex: half` (master of a multidrop "
          "line), `source` (our node, 0), `max-bytes` (of one request, 236; 82 for SLC "
          "5/01 and 5/02), `poll-delay-ms` (half duplex, between polls, 10)",
      .factory_line = {19200, 8, Parity::kNone, 1},
      .whole_bytes = true,
      .aliases = kAliases,
      .variants = kVariants};
  return row;
}

}  // namespace fieldcast::df1
