#include "core/protocol/mitsubishi_mc_serial/mitsubishi_mc_serial.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/protocol/mitsubishi_mc/areas.hpp"
#include "core/protocol/mitsubishi_mc/command.hpp"
#include "core/protocol/mitsubishi_mc_serial/codes.hpp"
#include "core/protocol/mitsubishi_mc_serial/frame.hpp"
#include "core/protocol/mitsubishi_mc_serial/short_command.hpp"
#include "core/protocol/option_reader.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::mitsubishi_mc {
namespace {

constexpr std::size_t kMaxReceived = 16'000;  // three of the largest frames

// A response names the stations of its request, but not the command. In format 2 it also has the
// block number: SH-080008 shows one in each response, and the computer link manual of the A series
// (AJ71C24-S6, 8.4.5) calls it a reference of the computer to its data.
constexpr Traits kSerialTraits{
    .name = "mitsubishi-mc-serial",
    .summary = "Mitsubishi MC protocol on a serial line: 1C, 3C and 4C frames",
    .lowest_address = 0,
    .highest_address = 31,
    .identity = ResponseIdentity::kAddress,
    .codes = kSerialCodes};

template <class Commands>
Bytes frame_with(const Request& request, const Commands& commands, const SerialFormat& format,
                 ByteView header) {
  Bytes content, frame;
  append_command(content, commands, request);
  append_request(frame, format, header, content);
  return frame;
}

// `Commands`: Format of 3C and 4C frames, ShortCommands of 1C frames.
template <class Commands>
class SerialExchange final : public Exchange {
 public:
  SerialExchange(const SerialFormat& format, const Commands& commands, Bytes header,
                 std::span<const DeviceCode> codes, Request request)
      : format_(format),
        commands_(commands),
        header_(std::move(header)),
        codes_(codes),
        request_(std::move(request)) {}

  Step start(Bytes& out) override {
    const auto sizes = command_sizes(commands_, request_);
    if (!sizes) std::abort();  // see REQUIRES of begin()
    expected_ = response_size(format_, sizes->response);
    out = frame_with(request_, commands_, format_, header_);
    return Step::send(expected_);
  }

  Step on_bytes(ByteView all, Bytes&) override {
    if (all.size() > kMaxReceived) return Step::failed(Cause::kOverlong);
    silence_ = cause_of_noise(all);
    Step step = Step::need_response();
    for (;;) {
      SerialResponse response = first_response(all, format_);
      all = all.subspan(response.end);
      switch (response.kind) {
        case SerialResponse::Kind::kNothing: return step;
        case SerialResponse::Kind::kOpen:
          silence_ = Cause::kTruncated;
          return Step::need_rest(expected_ > all.size() ? expected_ - all.size() : 1);
        case SerialResponse::Kind::kBroken:
          silence_ = Cause::kChecksum;
          step = Step::need_rest(0);
          break;
        default:
          step = judge(response);
          if (step.kind != Step::Kind::kNeedMore) return step;
      }
    }
  }

  Step on_silence(Bytes&) override { return Step::failed(silence_); }
  const Reply& reply() const override { return reply_; }

 private:
  Step judge(const SerialResponse& response) {
    silence_ = Cause::kForeign;
    if (response.header != header_) return Step::need_response();
    if (response.kind == SerialResponse::Kind::kRefused)
      return Step::failed(device_code_cause(codes_, response.code), response.code);
    silence_ = Cause::kMalformed;
    const bool read = std::holds_alternative<ReadRequest>(request_);
    if (read != (response.kind == SerialResponse::Kind::kData)) return Step::need_response();
    auto reply = unpack(response.data, commands_, request_);
    if (!reply) return Step::need_response();
    reply_ = std::move(*reply);
    return Step::done();
  }

  const SerialFormat format_;
  const Commands commands_;
  const Bytes header_;
  const std::span<const DeviceCode> codes_;
  const Request request_;
  std::size_t expected_ = 0;
  Reply reply_;
  Cause silence_ = Cause::kNoResponse;
};

template <class Commands>
class SerialProtocol final : public Protocol {
 public:
  SerialProtocol(const SerialFormat& format, const Commands& commands, const SerialRoute& route,
                 std::uint16_t max_ranges, std::span<const DeviceCode> codes)
      : format_(format), commands_(commands), route_(route) {
    traits_.max_ranges = max_ranges;
    traits_.codes = codes;
    if (format.numbered) traits_.identity = ResponseIdentity::kSequence;
  }
  const Traits& traits() const override { return traits_; }
  std::span<const Area> areas() const override { return reached_by(commands_).areas; }
  tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at) const override {
    return parse_with_suggestion(
        at, [&](std::string_view text) { return mitsubishi_mc::parse_address(commands_, text); });
  }
  std::optional<ExchangeSize> size(const Request& request) const override {
    const auto sizes = command_sizes(commands_, request);
    if (!sizes) return std::nullopt;
    const std::size_t response = response_size(format_, sizes->response);
    if (!format_.binary) return ExchangeSize::of(request_size(format_, sizes->request), response);
    // Some characters are sent twice; those of a response depend on its data and are not counted.
    return ExchangeSize::of(frame_with(request, commands_, format_, header({})).size(), response);
  }
  std::unique_ptr<Exchange> begin(Request request, ExchangeContext context) const override {
    return std::make_unique<SerialExchange<Commands>>(format_, commands_, header(context),
                                                      traits_.codes, std::move(request));
  }

  // Without a block number, a response shows its stations and its length, which is the same for all
  // writes. A refusal shows its stations only: a late one counts for the request that is in flight.
  bool mistakable(const Request& earlier, ExchangeContext earlier_context, const Request& later,
                  ExchangeContext later_context) const override {
    if (format_.numbered)
      return Protocol::mistakable(earlier, earlier_context, later, later_context);
    const auto first = command_sizes(commands_, earlier), second = command_sizes(commands_, later);
    return !first || !second || first->response == second->response;
  }

 private:
  Bytes header(const ExchangeContext& context) const {
    return header_of(format_, route_, static_cast<std::uint8_t>(context.sequence));
  }

  const SerialFormat format_;
  const Commands commands_;
  const SerialRoute route_;
  Traits traits_ = kSerialTraits;
};

constexpr std::array<std::string_view, 10> kOptions{"frame",    "format",     "sum-check", "series",
                                                    "commands", "network",    "pc",        "module",
                                                    "unit",     "own-station"};

// Refuses options that the frame has no field for.
void refuse_unused(OptionReader& reader, SerialFrame frame) {
  const auto refuse = [&](std::initializer_list<std::string_view> names, std::string_view allowed) {
    for (const std::string_view name : names) {
      if (reader.text_of(name) != nullptr)
        reader.refuse(name, "the frame has no field for it", std::string(allowed));
    }
  };
  if (frame != SerialFrame::k1c) refuse({"commands"}, "with frame: 1c");
  if (frame != SerialFrame::k4c) refuse({"module", "unit"}, "with frame: 4c");
  if (frame == SerialFrame::k1c)
    refuse({"series", "network", "own-station"}, "with frame: 3c or 4c");
}

tl::expected<std::unique_ptr<Protocol>, OptionFault> make(const DeviceLink& link) {
  OptionReader reader(link, kSerialTraits, kOptions);
  SerialFormat format;
  format.frame = static_cast<SerialFrame>(reader.choice("frame", {"4c", "3c", "1c"}));
  const std::size_t number = 1 + reader.choice("format", {"1", "2", "3", "4", "5"});
  format.numbered = number == 2;
  format.enclosed = number == 3;
  format.line_end = number == 4;
  format.binary = number == 5;
  format.sum_check = reader.flag("sum-check", true);
  if (format.binary && format.frame != SerialFrame::k4c)
    reader.refuse("format", "only 4C frames have format 5", "1, 2, 3, 4");
  if (format.binary && link.line.data_bits != 8)
    reader.refuse("format", "format 5 needs 8 data bits", "format: 8E1, 8N1 or 8O1 of the port");
  refuse_unused(reader, format.frame);
  const Format commands{.ascii = !format.binary,
                        .wide = reader.choice("series", {"q", "iqr"}) == 1};
  SerialRoute route{.station = static_cast<std::uint8_t>(link.address)};
  for (const auto& [name, highest, usual, field] :
       {std::tuple{"network", 239u, 0u, &route.network}, std::tuple{"pc", 255u, 255u, &route.pc},
        std::tuple{"unit", 31u, 0u, &route.unit},
        std::tuple{"own-station", 31u, 0u, &route.own_station}})
    *field = static_cast<std::uint8_t>(reader.number(name, 0, highest, usual));
  route.module = static_cast<std::uint16_t>(reader.number("module", 0, 0x03FF, 0x03FF));
  const auto short_commands =
      static_cast<ShortCommands>(reader.choice("commands", {"a", "ana", "fx"}));
  if (reader.fault()) return tl::unexpected(*reader.fault());
  if (format.frame == SerialFrame::k1c) {
    return std::make_unique<SerialProtocol<ShortCommands>>(format, short_commands, route, 1,
                                                           kShortCodes);
  }
  return std::make_unique<SerialProtocol<Format>>(format, commands, route, max_random(commands),
                                                  kSerialCodes);
}

constexpr std::string_view kAddresses[] = {
    "D100",  "D101.5", "D102.15", "D103.F", "W1A0", "WB",   "W5.3", "R5",   "ZR70000",
    "SD203", "SW1F",   "Z3",      "TN5",    "SN6",  "STN7", "CN5",  "M14",  "L3",
    "F4",    "V5",     "B1F",     "BA",     "X1F",  "YA0",  "SM40", "SB1F", "S3",
    "TS5",   "TC6",    "SS5",     "SC6",    "STS7", "STC8", "CS5",  "CC6",  "D9.0"};
constexpr std::string_view kAAddresses[] = {
    "D100", "D101.5", "D103.F", "W1A0", "WB",  "W5.3", "R5",  "TN5", "CN5", "M14",
    "F4",   "B1F",    "BA",     "X1F",  "YA0", "TS5",  "TC6", "CS5", "CC6"};
constexpr std::string_view kFxAddresses[] = {"D100", "D8010", "D101.5", "TN5", "CN6",
                                             "M14",  "M8001", "S3",     "X17", "Y5",
                                             "TS5",  "TC5",   "CS5",    "CC5"};
constexpr ProtocolOption kFormat2[] = {{"format", "2"}};
constexpr ProtocolOption kFormat3[] = {{"format", "3"}};
constexpr ProtocolOption kFormat4[] = {{"format", "4"}};
constexpr ProtocolOption kFormat5[] = {{"format", "5"}};
constexpr ProtocolOption k3c[] = {{"frame", "3c"}};
constexpr ProtocolOption k3cFormat3[] = {{"frame", "3c"}, {"format", "3"}};
constexpr ProtocolOption k3cFormat4[] = {{"frame", "3c"}, {"format", "4"}};
constexpr ProtocolOption k1c[] = {{"frame", "1c"}};
constexpr ProtocolOption k1cFormat2[] = {{"frame", "1c"}, {"format", "2"}};
constexpr ProtocolOption k1cFormat3[] = {{"frame", "1c"}, {"format", "3"}};
constexpr ProtocolOption k1cFormat4[] = {{"frame", "1c"}, {"format", "4"}};
constexpr ProtocolOption kAna[] = {{"frame", "1c"}, {"commands", "ana"}};
constexpr ProtocolOption kFx[] = {{"frame", "1c"}, {"commands", "fx"}};
constexpr ProtocolOption kWide[] = {{"series", "iqr"}};
constexpr ProtocolAlias kAliases[] = {{"mc-serial"}, {"melsec-serial"}};
constexpr ProtocolVariant kVariants[] = {
    {.addresses = kAddresses},
    {.options = kFormat2, .addresses = kAddresses},
    {.options = kFormat3, .addresses = kAddresses},
    {.options = kFormat4, .addresses = kAddresses},
    {.options = kFormat5, .addresses = kAddresses},
    {.options = k3c, .addresses = kAddresses},
    {.options = k3cFormat3, .addresses = kAddresses},
    {.options = k3cFormat4, .addresses = kAddresses},
    {.options = kWide, .addresses = kAddresses},
    {.options = k1c, .addresses = kAAddresses},
    {.options = k1cFormat2, .addresses = kAAddresses},
    {.options = k1cFormat3, .addresses = kAAddresses},
    {.options = k1cFormat4, .addresses = kAAddresses},
    {.options = kAna, .addresses = kAAddresses},
    {.options = kFx, .addresses = kFxAddresses},
};

}  // namespace

const ProtocolEntry& serial_entry() {
  static constexpr ProtocolEntry row{
      .name = kSerialTraits.name,
      .summary = kSerialTraits.summary,
      .make = make,
      .explain = explain_serial,
      .seen_request = seen_serial_request,
      .options = kOptions,
      .options_text =
          "`frame: 3c`, `1c` (4c), `format: 2` to `5` (1) and `sum-check: false` (true) as the "
          "module has them, `series: iqr` (q), `commands: ana`, `fx` (a) of 1C frames, `network`, "
          "`pc`, `module`, `unit` of another PLC behind the module, `own-station` of this "
          "computer; "
          "its `address` is the station",
      // The module has no factory setting; this is the default of Mitsubishi's operator terminals.
      .factory_line = {19200, 8, Parity::kOdd, 1},
      .aliases = kAliases,
      .variants = kVariants};
  return row;
}

}  // namespace fieldcast::mitsubishi_mc
