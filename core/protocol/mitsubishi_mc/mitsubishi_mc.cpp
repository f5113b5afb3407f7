#include "core/protocol/mitsubishi_mc/mitsubishi_mc.hpp"

#include <array>
#include <cstdlib>
#include <tuple>

#include "core/protocol/mitsubishi_mc/areas.hpp"
#include "core/protocol/mitsubishi_mc/codes.hpp"
#include "core/protocol/mitsubishi_mc/command.hpp"
#include "core/protocol/mitsubishi_mc/frame.hpp"
#include "core/protocol/option_reader.hpp"

namespace fieldcast::mitsubishi_mc {
namespace {

constexpr std::size_t kMaxReceived = 12'000;  // three of the largest frames
// Time that the PLC may need, in units of 250 ms: the manual recommends at least 1 for the PLC of
// the connection and 2 for others (SH-080008, 5.2, monitoring timer).
constexpr std::uint16_t kOwnTimer = 4, kOtherTimer = 8;
constexpr std::uint8_t kOwnStation = 0xFF;

constexpr Traits kTraits{.name = "mitsubishi-mc",
                         .summary = "Mitsubishi MC protocol (SLMP): Q, L, iQ-R, iQ-F on Ethernet",
                         .lowest_address = 0,
                         .highest_address = 255,
                         .max_ranges = 192,
                         .identity = ResponseIdentity::kAddress,
                         .codes = kCodes};

class McExchange final : public Exchange {
 public:
  McExchange(const Format& format, const Route& route, std::uint16_t serial, Request request)
      : format_(format), route_(route), serial_(serial), request_(std::move(request)) {}

  Step start(Bytes& out) override {
    const auto sizes = command_sizes(format_, request_);
    if (!sizes) std::abort();  // see REQUIRES of begin()
    Bytes content;
    append_command(content, format_, request_);
    append_request(out, format_, serial_, route_, route_ == Route{} ? kOwnTimer : kOtherTimer,
                   content);
    return Step::send(header_size(format_) + kEndCode * format_.width() + sizes->response);
  }

  Step on_bytes(ByteView all, Bytes&) override {
    if (all.size() > kMaxReceived) return Step::failed(Cause::kOverlong);
    silence_ = Cause::kNoResponse;
    while (!all.empty()) {
      const Response response = first_response(all, format_);
      if (response.kind == Response::Kind::kHopeless) return Step::failed(Cause::kMalformed);
      if (response.kind == Response::Kind::kPart) {
        silence_ = Cause::kTruncated;
        return Step::need_response();
      }
      all = all.subspan(response.size);
      const Step step = judge(response);
      if (step.kind != Step::Kind::kNeedMore) return step;
    }
    return Step::need_response();
  }

  Step on_silence(Bytes&) override { return Step::failed(silence_); }
  const Reply& reply() const override { return reply_; }

 private:
  Step judge(const Response& response) {
    silence_ = Cause::kForeign;
    if (response.route != route_ || (format_.numbered && response.serial != serial_))
      return Step::need_response();
    if (response.end_code != 0) return judge_error(response);
    auto reply = unpack(response.data, format_, request_);
    if (!reply) {
      silence_ = Cause::kMalformed;
      return Step::need_response();
    }
    reply_ = std::move(*reply);
    return Step::done();
  }

  // The error part repeats the command. Its route is that of the station that found the error.
  Step judge_error(const Response& response) {
    const std::size_t width = format_.width();
    silence_ = Cause::kMalformed;
    if (response.data.size() != kErrorPart * width) return Step::need_response();
    const ByteView command = response.data.last(kCommand * width);
    const auto code = read_number(command, format_, 2),
               subcommand = read_number(command.subspan(2 * width), format_, 2);
    if (!code || !subcommand) return Step::need_response();
    if ((*code << 16 | *subcommand) != command_of(format_, request_)) {
      silence_ = Cause::kForeign;
      return Step::need_response();
    }
    return Step::failed(device_code_cause(kCodes, response.end_code), response.end_code);
  }

  const Format format_;
  const Route route_;
  const std::uint16_t serial_;
  const Request request_;
  Reply reply_;
  Cause silence_ = Cause::kNoResponse;
};

class McProtocol final : public Protocol {
 public:
  McProtocol(const Format& format, const Route& route) : format_(format), route_(route) {
    traits_.max_ranges = max_random(format);
    if (format.numbered) traits_.identity = ResponseIdentity::kSequence;
  }
  const Traits& traits() const override { return traits_; }
  std::span<const Area> areas() const override { return reached_by(format_).areas; }
  tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at) const override {
    return parse_with_suggestion(
        at, [&](std::string_view text) { return mitsubishi_mc::parse_address(format_, text); });
  }
  std::optional<ExchangeSize> size(const Request& request) const override {
    const auto sizes = command_sizes(format_, request);
    if (!sizes) return std::nullopt;
    const std::size_t header = header_size(format_), width = format_.width();
    return ExchangeSize::of(header + kTimer * width + sizes->request,
                            header + kEndCode * width + sizes->response);
  }
  std::unique_ptr<Exchange> begin(Request request, ExchangeContext context) const override {
    return std::make_unique<McExchange>(format_, route_, context.sequence, std::move(request));
  }

  // A 3E response shows its station and its length, which is the same for all writes.
  bool mistakable(const Request& earlier, ExchangeContext earlier_context, const Request& later,
                  ExchangeContext later_context) const override {
    if (format_.numbered)
      return Protocol::mistakable(earlier, earlier_context, later, later_context);
    const auto first = command_sizes(format_, earlier), second = command_sizes(format_, later);
    return !first || !second || first->response == second->response;
  }

 private:
  const Format format_;
  const Route route_;
  Traits traits_ = kTraits;
};

// Of 4E frames, whose first character shows the code.
std::optional<std::size_t> first_frame(ByteView stream) {
  const bool ascii = !stream.empty() && stream[0] == 'D';
  const Response response = first_response(stream, {.numbered = true, .ascii = ascii});
  if (response.kind == Response::Kind::kHopeless) return std::nullopt;
  return response.size;
}

constexpr std::array<std::string_view, 6> kOptions{"frame",   "code",   "series",
                                                   "network", "module", "unit"};

tl::expected<std::unique_ptr<Protocol>, OptionFault> make(const DeviceLink& link) {
  OptionReader reader(link, kTraits, kOptions);
  Format format;
  for (const auto& [name, usual, other, field] :
       {std::tuple{"frame", "3e", "4e", &format.numbered},
        std::tuple{"code", "binary", "ascii", &format.ascii},
        std::tuple{"series", "q", "iqr", &format.wide}})
    *field = reader.choice(name, {usual, other}) == 1;
  Route route;
  if (link.address != 0) route.station = static_cast<std::uint8_t>(link.address);
  route.network = static_cast<std::uint8_t>(reader.number("network", 0, 239, 0));
  route.module = static_cast<std::uint16_t>(reader.number("module", 0, 0x03FF, 0x03FF));
  route.unit = static_cast<std::uint8_t>(reader.number("unit", 0, 31, 0));
  if (reader.fault()) return tl::unexpected(*reader.fault());
  return std::make_unique<McProtocol>(format, route);
}

constexpr std::string_view kAddresses[] = {
    "D100",  "D101.5", "D102.15", "D103.F", "W1A0", "WB",   "W5.3", "R5",   "ZR70000",
    "SD203", "SW1F",   "Z3",      "TN5",    "SN6",  "STN7", "CN5",  "M14",  "L3",
    "F4",    "V5",     "B1F",     "BA",     "X1F",  "YA0",  "SM40", "SB1F", "S3",
    "TS5",   "TC6",    "SS5",     "SC6",    "STS7", "STC8", "CS5",  "CC6",  "D9.0"};
constexpr ProtocolOption kNumbered[] = {{"frame", "4e"}};
constexpr ProtocolOption kAscii[] = {{"code", "ascii"}};
constexpr ProtocolOption kNumberedAscii[] = {{"frame", "4e"}, {"code", "ascii"}};
constexpr ProtocolOption kWide[] = {{"series", "iqr"}};
constexpr ProtocolOption kWideAscii[] = {{"series", "iqr"}, {"code", "ascii"}};
constexpr ProtocolAlias kAliases[] = {{"slmp"}, {"mc"}, {"mc-protocol"}, {"mcprotocol"}};
constexpr ProtocolVariant kVariants[] = {
    {.addresses = kAddresses},
    {.options = kNumbered, .addresses = kAddresses},
    {.options = kAscii, .addresses = kAddresses},
    {.options = kNumberedAscii, .addresses = kAddresses},
    {.options = kWide, .addresses = kAddresses},
    {.options = kWideAscii, .addresses = kAddresses},
};

}  // namespace

const ProtocolEntry& entry() {
  static constexpr ProtocolEntry row{
      .name = kTraits.name,
      .summary = kTraits.summary,
      .make = make,
      .explain = explain,
      .options = kOptions,
      .options_text =
          "`frame: 4e` (numbered requests; 3e), `code: ascii` (binary; as the PLC has "
          "it), `series: iqr` (commands of the iQ-R series; q), `network`, `module`, "
          "`unit` of another PLC behind this one; its `address` is the station",
      .first_frame = first_frame,
      .network_only = true,
      .instead = "mitsubishi-mc-serial",
      .carrier_checks = true,
      .aliases = kAliases,
      .variants = kVariants};
  return row;
}

}  // namespace fieldcast::mitsubishi_mc
