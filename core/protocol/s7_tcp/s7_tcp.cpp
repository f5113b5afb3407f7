#include "core/protocol/s7_tcp/s7_tcp.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "core/protocol/field_writer.hpp"
#include "core/protocol/option_reader.hpp"
#include "core/protocol/s7_tcp/areas.hpp"
#include "core/protocol/s7_tcp/iso_frame.hpp"
#include "core/protocol/s7comm/explain.hpp"
#include "core/protocol/s7comm/message.hpp"
#include "core/protocol/s7comm/s7_200.hpp"

namespace fieldcast::s7_tcp {
namespace {

constexpr auto kTcpCodes = joined_codes(
    s7comm::kErrorCodes,
    std::array{
        DeviceCode{0x8104, "function not available: the CPU does not permit PUT/GET access"},
        DeviceCode{0x7001, "S7: the CPU grants a smaller PDU than the option pdu"},
        DeviceCode{0x7080, "ISO-on-TCP: no such rack, slot or TSAP, or no connection is left",
                   Cause::kMalformed},
    });
constexpr std::uint16_t kSmallPdu = 0x7001, kRefused = 0x7080;

constexpr Traits kTraits{
    .name = "s7-tcp",
    .summary = "Siemens S7 over ISO-on-TCP: S7-300, 400, 1200, 1500, S7-200 SMART and LOGO!",
    .lowest_address = 0,
    .highest_address = 31,
    .max_ranges = s7comm::kMaxItems,
    .identity = ResponseIdentity::kSequence,
    .codes = kTcpCodes};

struct Link {
  std::uint16_t local_tsap = 0x0100;
  std::uint16_t tsap = 0;
  std::uint16_t pdu = s7comm::kSmallestPdu;
};

// Requests in flight that the bridge may have at most.
constexpr std::uint8_t kJobs = 16;

Bytes set_up_message(std::uint16_t reference, std::uint16_t pdu) {
  Bytes message{0x32, 1, 0, 0};
  append_u16(message, reference);
  append(message, Bytes{0, 8, 0, 0, 0xF0, 0, 0, kJobs, 0, kJobs});
  append_u16(message, pdu);
  return message;
}
constexpr std::size_t kSetUpResponse = 20;

class S7TcpExchange final : public Exchange {
 public:
  S7TcpExchange(const Link& link, const s7comm::Memory& memory, ExchangeContext context,
                Request request)
      : link_(link),
        memory_(memory),
        reference_(context.sequence),
        session_(context.session != nullptr ? *context.session : own_session_),
        request_(std::move(request)) {}

  Step start(Bytes& out) override { return send(out); }

  Step on_bytes(ByteView all, Bytes& out) override {
    const std::size_t most = kDataHeader + memory_.pdu;
    if (all.size() > 4 * most) return Step::failed(Cause::kOverlong);
    silence_ = Cause::kNoResponse;
    while (!all.empty()) {
      const IsoFrame frame = first_iso_frame(all, most);
      if (frame.kind == IsoFrame::Kind::kHopeless) return Step::failed(Cause::kMalformed);
      if (frame.kind == IsoFrame::Kind::kPart) {
        silence_ = Cause::kTruncated;
        return Step::need_response();
      }
      all = all.subspan(frame.size);
      const Step step = take(frame, out);
      if (step.kind != Step::Kind::kNeedMore) return step;
    }
    return Step::need_response();
  }

  Step on_silence(Bytes&) override { return Step::failed(silence_); }
  const Reply& reply() const override { return reply_; }

 private:
  enum class Stage : std::uint8_t { kConnect, kSetUp, kMessage };
  [[nodiscard]] Stage stage() const {
    return static_cast<Stage>(std::min<std::size_t>(session_.size(), 2));
  }

  Step send(Bytes& out) {
    silence_ = Cause::kNoResponse;
    switch (stage()) {
      case Stage::kConnect:
        append_connect(out, link_.local_tsap, link_.tsap);
        return Step::send(kConfirmation);
      case Stage::kSetUp:
        append_data(out, set_up_message(reference_, link_.pdu));
        return Step::send(kDataHeader + kSetUpResponse);
      case Stage::kMessage: break;
    }
    append_data(out, s7comm::message_of(memory_, request_, reference_));
    return Step::send(kDataHeader + s7comm::message_sizes(memory_, request_)->response);
  }

  Step take(const IsoFrame& frame, Bytes& out) {
    silence_ = Cause::kForeign;
    if (frame.type == Tpdu::kRefusal) return fail_with(kRefused);
    if (stage() == Stage::kConnect) {
      if (frame.type != Tpdu::kConfirm) return Step::need_response();
      session_.push_back(1);
      return send(out);
    }
    if (frame.type != Tpdu::kData) return Step::need_response();  // late
    return stage() == Stage::kSetUp ? take_set_up(frame.message, out) : judge(frame.message);
  }

  Step take_set_up(ByteView message, Bytes& out) {
    if (message.size() < 12 || message[0] != 0x32) return Step::failed(Cause::kMalformed);
    if (read_u16(message, 4) != reference_) return Step::need_response();
    if (const std::uint16_t error = read_u16(message, 10); error != 0) return fail_with(error);
    if (message.size() != kSetUpResponse || message[12] != 0xF0)
      return Step::failed(Cause::kMalformed);
    if (read_u16(message, 18) < link_.pdu) return fail_with(kSmallPdu);
    session_.push_back(1);
    return send(out);
  }

  Step judge(ByteView message) {
    using Kind = s7comm::Judgement::Kind;
    auto judgement = s7comm::judge(message, memory_, request_, reference_);
    switch (judgement.kind) {
      case Kind::kResponse: reply_ = std::move(judgement.reply); return Step::done();
      case Kind::kRefused: return fail_with(judgement.code);
      case Kind::kMalformed: silence_ = Cause::kMalformed; break;
      case Kind::kForeign: break;
    }
    return Step::need_response();
  }

  static Step fail_with(std::uint16_t code) {
    return Step::failed(device_code_cause(kTcpCodes, code), code);
  }

  const Link link_;
  const s7comm::Memory memory_;
  const std::uint16_t reference_;
  Bytes own_session_;
  Bytes& session_;
  const Request request_;
  Reply reply_;
  Cause silence_ = Cause::kNoResponse;
};

using ParseAddress = ParsedOrFault (*)(std::span<const Area> areas, std::string_view at);

class S7TcpProtocol final : public Protocol {
 public:
  S7TcpProtocol(const Link& link, std::span<const Area> areas,
                std::span<const s7comm::AreaCode> codes, ParseAddress parse)
      : link_(link),
        areas_(areas.begin(), areas.end()),
        memory_{areas_, codes, link.pdu},
        parse_(parse) {}
  S7TcpProtocol(const S7TcpProtocol&) = delete;

  const Traits& traits() const override { return kTraits; }
  std::span<const Area> areas() const override { return areas_; }
  tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at) const override {
    return parse_with_suggestion(at,
                                 [this](std::string_view text) { return parse_(areas_, text); });
  }
  std::optional<ExchangeSize> size(const Request& request) const override {
    const auto sizes = s7comm::message_sizes(memory_, request);
    if (!sizes) return std::nullopt;
    return ExchangeSize::of(kDataHeader + sizes->request, kDataHeader + sizes->response);
  }
  std::unique_ptr<Exchange> begin(Request request, ExchangeContext context) const override {
    return std::make_unique<S7TcpExchange>(link_, memory_, context, std::move(request));
  }

 private:
  const Link link_;
  const std::vector<Area> areas_;
  const s7comm::Memory memory_;
  const ParseAddress parse_;
};

std::optional<std::size_t> first_frame(ByteView stream) {
  const IsoFrame frame = first_iso_frame(stream, kDataHeader + s7comm::kLargestPdu);
  if (frame.kind == IsoFrame::Kind::kHopeless) return std::nullopt;
  return frame.size;
}

constexpr std::array<std::string_view, 6> kOptions{"rack", "connection", "pdu",
                                                   "cpu",  "tsap",       "local-tsap"};

// "10.01": two bytes in hexadecimal digits, as in TIA Portal and LOGO!Soft Comfort.
std::uint16_t tsap(OptionReader& reader, std::string_view name, std::uint16_t otherwise) {
  const std::string* text = reader.text_of(name);
  if (text == nullptr) return otherwise;
  const auto high = whole_number(std::string_view(*text).substr(0, 2), 16);
  const auto low = whole_number(text->size() == 5 ? std::string_view(*text).substr(3) : "", 16);
  if (high && low && (*text)[2] == '.') return static_cast<std::uint16_t>(*high << 8 | *low);
  reader.refuse(name, std::string(name) + " " + in_quotes(*text) + " is no TSAP",
                "two hexadecimal numbers of two digits: \"10.01\"");
  return otherwise;
}

tl::expected<std::unique_ptr<Protocol>, OptionFault> make(const DeviceLink& link) {
  OptionReader reader(link, kTraits, kOptions);
  const auto rack = reader.number("rack", 0, 7, 0);
  const auto connection = 3 - reader.choice("connection", {"basic", "op", "pg"});
  Link s7;
  s7.pdu = static_cast<std::uint16_t>(
      reader.number("pdu", s7comm::kSmallestPdu, s7comm::kLargestPdu, s7comm::kSmallestPdu));
  const bool s7_200 = reader.choice("cpu", {"s7-300", "s7-200"}) == 1;
  const auto place = static_cast<std::uint16_t>(connection << 8 | rack << 5 | link.address);
  s7.tsap = tsap(reader, "tsap", place);
  s7.local_tsap = tsap(reader, "local-tsap", s7.local_tsap);
  if (reader.fault()) return tl::unexpected(*reader.fault());
  if (s7_200)
    return std::make_unique<S7TcpProtocol>(s7, s7comm::s7_200_areas(s7comm::kS7200Smart, s7.pdu),
                                           s7comm::kS7200Codes, s7comm::parse_s7_200_address);
  return std::make_unique<S7TcpProtocol>(s7, areas_of(s7.pdu), kCodes, parse_address);
}

constexpr std::string_view kAddresses[] = {"DB1.DBB0",  "DB1.DBW2",    "DB1.DBD4",
                                           "DB1.DBL8",  "DB1.DBX16.3", "DB1.DBS20",
                                           "DB1.DTL32", "DB1.DT44",    "DB300.DBW65534",
                                           "MB1",       "MW2",         "MD4",
                                           "ML8",       "M9.7",        "IB0",
                                           "IW2",       "ID4",         "I9.3",
                                           "QB0",       "QW2",         "QD4",
                                           "Q9.0",      "PIB0",        "PIW752",
                                           "T5",        "C5"};
constexpr ProtocolOption kLongPdu[] = {{"pdu", "960"}, {"rack", "1"}, {"connection", "pg"}};
constexpr ProtocolOption kS7200[] = {{"cpu", "s7-200"}, {"tsap", "10.00"}, {"local-tsap", "10.00"}};
constexpr ProtocolAlias kAliases[] = {{"s7"},     {"s7comm"},  {"s7-300"},
                                      {"s7-400"}, {"s7-1200"}, {"s7-1500"}};
constexpr ProtocolVariant kVariants[] = {{.addresses = kAddresses},
                                         {.options = kLongPdu, .addresses = kAddresses},
                                         {.options = kS7200, .addresses = s7comm::kS7200Addresses}};

}  // namespace

const ProtocolEntry& entry() {
  static constexpr ProtocolEntry row{
      .name = kTraits.name,
      .summary = kTraits.summary,
      .make = make,
      .explain = explain,
      .options = kOptions,
      .options_text =
          "`rack` (0), `connection` (`basic`, `op`, `pg`), `pdu` (bytes, 240 to 960; 240), `cpu: "
          "s7-200` (also S7-200 SMART and LOGO!), `tsap` and `local-tsap` (`10.01`); its "
          "`address` is the slot",
      .first_frame = first_frame,
      .network_only = true,
      .stream_only = true,
      .instead = "s7-ppi",
      .one_device = true,
      .carrier_checks = true,
      .dissector = "tpkt",
      .aliases = kAliases,
      .variants = kVariants};
  return row;
}

std::vector<FrameField> explain(ByteView frame) {
  FieldWriter writer;
  const IsoFrame iso = first_iso_frame(frame, 0xFFFF);
  if (iso.kind != IsoFrame::Kind::kWhole || iso.size != frame.size()) {
    writer.remark(to_hex(frame), "no whole ISO-on-TCP frame");
    return writer.take();
  }
  writer.add(0, kTpktHeader, "TPKT", "03, " + std::to_string(iso.size) + " bytes");
  const std::size_t header = frame.size() - kTpktHeader - iso.message.size();
  const char* type = iso.type == Tpdu::kConnect   ? "E0 connect"
                     : iso.type == Tpdu::kConfirm ? "D0 connect confirmed"
                     : iso.type == Tpdu::kRefusal ? "80 disconnect"
                     : iso.type == Tpdu::kData    ? "F0 data"
                                                  : "";
  writer.add(kTpktHeader, header, "TPDU",
             *type != '\0' ? type : to_hex(frame.subspan(kTpktHeader + 1, 1)),
             *type != '\0' ? "" : "no TPDU of this protocol");
  if (!iso.message.empty()) {
    static constexpr Areas kAll = areas_of(s7comm::kLargestPdu);
    FieldWriter inner(kTpktHeader + header, 1, 1);
    s7comm::explain(iso.message, {kAll, kCodes}, inner);
    writer.append(inner.take());
  }
  return writer.take();
}

}  // namespace fieldcast::s7_tcp
