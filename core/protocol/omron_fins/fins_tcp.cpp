#include "core/protocol/omron_fins/fins_tcp.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <tuple>

#include "core/protocol/omron_hostlink/explain_fins.hpp"
#include "core/protocol/omron_hostlink/fins.hpp"
#include "core/protocol/omron_hostlink/fins_command.hpp"
#include "core/protocol/option_reader.hpp"

namespace fieldcast::omron {
namespace {

constexpr std::array<std::uint8_t, 4> kMagic{'F', 'I', 'N', 'S'};
constexpr std::size_t kPrefix = 8, kFrameHeader = 16;  // bytes to the length, and to the data
constexpr std::size_t kMessageHeader = 10;             // of FINS, up to SID
constexpr std::uint32_t kAskNodes = 0, kGiveNodes = 1, kMessage = 2;
constexpr std::size_t kGreetingResponse = kFrameHeader + 8;
constexpr std::size_t kMaxTcpReceived = 8000;  // three of the largest frames
// Errors of the frame, in the codes of a device after those of FINS messages.
constexpr std::uint16_t kFrameErrors = 0x7000;

constexpr auto kTcpCodes = joined_codes(
    kFinsCodes,
    std::array{
        DeviceCode{0x7001, "FINS/TCP: the header is not FINS"},
        DeviceCode{0x7002, "FINS/TCP: message too long"},
        DeviceCode{0x7003, "FINS/TCP: command not supported"},
        DeviceCode{0x7020, "FINS/TCP: all connections are in use", Cause::kDeviceBusy},
        // The response to an earlier greeting was lost: only a new connection gets nodes.
        DeviceCode{0x7021, "FINS/TCP: this node is already connected", Cause::kMalformed},
        DeviceCode{0x7022, "FINS/TCP: node protected for another IP address"},
        DeviceCode{0x7023, "FINS/TCP: node of the client out of range"},
        DeviceCode{0x7024, "FINS/TCP: client and PLC have the same node"},
        DeviceCode{0x7025, "FINS/TCP: no node is left for the client", Cause::kDeviceBusy},
    });

constexpr Traits kTraits{
    .name = "omron-fins",
    .summary = "Omron FINS over TCP and UDP: CS, CJ, CP, NJ and NX on Ethernet",
    .lowest_address = 0,
    .highest_address = 254,
    .max_ranges = kEthernetItems,
    .identity = ResponseIdentity::kSequence,
    .codes = kTcpCodes};

void append_fins_frame(Bytes& out, std::uint32_t command, ByteView data) {
  append(out, kMagic);
  append_u32(out, static_cast<std::uint32_t>(kFrameHeader - kPrefix + data.size()));
  append_u32(out, command);
  append_u32(out, 0);
  append(out, data);
}

struct Nodes {
  std::uint8_t network = 0;
  std::uint8_t node = 0;  // 0: the PLC of the connection
  std::uint8_t unit = 0;
  std::uint8_t client = 0;  // 0: assigned by the PLC of a connection; otherwise UDP

  // A message is a datagram, without the header of a frame and without a greeting (W421, 6-2).
  [[nodiscard]] bool datagrams() const { return client != 0; }
  [[nodiscard]] std::size_t header() const { return datagrams() ? 0 : kFrameHeader; }
};

// The first frame of the received bytes.
struct FinsFrame {
  enum class Kind : std::uint8_t { kPart, kHopeless, kWhole };
  Kind kind = Kind::kPart;
  std::size_t size = 0;
  std::uint32_t command = 0, error = 0;
  ByteView data;
};

FinsFrame first_fins_frame(ByteView all) {
  const std::size_t known = std::min(all.size(), kMagic.size());
  if (!std::equal(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(known), kMagic.begin()))
    return {.kind = FinsFrame::Kind::kHopeless};
  if (all.size() < kPrefix) return {};
  const std::size_t counted = read_u32(all, kMagic.size());
  if (counted < kFrameHeader - kPrefix || counted > kFrameHeader - kPrefix + kEthernetBytes)
    return {.kind = FinsFrame::Kind::kHopeless};
  if (all.size() < kPrefix + counted) return {};
  return {.kind = FinsFrame::Kind::kWhole,
          .size = kPrefix + counted,
          .command = read_u32(all, kPrefix),
          .error = read_u32(all, kPrefix + 4),
          .data = all.first(kPrefix + counted).subspan(kFrameHeader)};
}

class FinsTcpExchange final : public Exchange {
 public:
  FinsTcpExchange(const Nodes& nodes, ExchangeContext context, Request request)
      : nodes_(nodes), context_(context), request_(std::move(request)) {}

  Step start(Bytes& out) override {
    if (nodes_.datagrams()) return send_command(nodes_.client, nodes_.node, out);
    if (context_.session != nullptr && context_.session->size() == 2)
      return send_command((*context_.session)[0], (*context_.session)[1], out);
    append_fins_frame(out, kAskNodes, Bytes(4));
    return Step::send(kGreetingResponse);
  }

  Step on_bytes(ByteView all, Bytes& out) override {
    if (all.size() > kMaxTcpReceived) return Step::failed(Cause::kOverlong);
    silence_ = Cause::kNoResponse;
    if (nodes_.datagrams()) return judge({.command = kMessage, .data = all});
    while (!all.empty()) {
      const FinsFrame frame = first_fins_frame(all);
      if (frame.kind == FinsFrame::Kind::kHopeless) return Step::failed(Cause::kMalformed);
      if (frame.kind == FinsFrame::Kind::kPart) {
        silence_ = Cause::kTruncated;
        return Step::need_response();
      }
      all = all.subspan(frame.size);
      const Step step = command_ ? judge(frame) : greet(frame, out);
      if (step.kind != Step::Kind::kNeedMore) return step;
    }
    return Step::need_response();
  }

  Step on_silence(Bytes&) override { return Step::failed(silence_); }
  const Reply& reply() const override { return command_->reply(); }

 private:
  static Step fail_with(std::uint32_t error) {
    const auto code =
        static_cast<std::uint16_t>(kFrameErrors + std::min<std::uint32_t>(error, 0xFF));
    return Step::failed(device_code_cause(kTcpCodes, code), code);
  }

  Step greet(const FinsFrame& frame, Bytes& out) {
    silence_ = Cause::kForeign;
    if (frame.command != kGiveNodes) return Step::need_response();
    if (frame.error != 0) return fail_with(frame.error);
    if (frame.data.size() != kGreetingResponse - kFrameHeader)
      return Step::failed(Cause::kMalformed);
    const std::uint32_t client = read_u32(frame.data), server = read_u32(frame.data, 4);
    if (client == 0 || client > 254 || server > 254) return Step::failed(Cause::kMalformed);
    if (context_.session != nullptr)
      *context_.session = {static_cast<std::uint8_t>(client), static_cast<std::uint8_t>(server)};
    return send_command(static_cast<std::uint8_t>(client), static_cast<std::uint8_t>(server), out);
  }

  Step send_command(std::uint8_t client, std::uint8_t server, Bytes& out) {
    silence_ = Cause::kNoResponse;
    const std::uint8_t node = nodes_.node != 0 ? nodes_.node : server;
    command_.emplace(kEthernetLimits,
                     Bytes{kRelayedFlag, 0, kGatewayCount, nodes_.network, node, nodes_.unit, 0,
                           client, 0, static_cast<std::uint8_t>(context_.sequence)},
                     request_);
    if (nodes_.datagrams())
      append(out, command_->message());
    else
      append_fins_frame(out, kMessage, command_->message());
    return Step::send(nodes_.header() + command_->response_size());
  }

  Step judge(const FinsFrame& frame) {
    silence_ = Cause::kForeign;
    if (frame.command == kGiveNodes) return Step::need_response();  // late
    if (frame.error != 0) return fail_with(frame.error);
    if (frame.command != kMessage || command_->is_foreign(frame.data) || !is_between(frame.data))
      return Step::need_response();
    return command_->judge(frame.data, silence_);
  }

  // Source and destination of a response are those of the request, exchanged.
  [[nodiscard]] bool is_between(ByteView response) const {
    constexpr std::size_t kDestination = 3, kSource = 6, kSize = 3;
    const ByteView request = command_->message();
    return response.size() >= kMessageHeader &&
           std::ranges::equal(response.subspan(kDestination, kSize),
                              request.subspan(kSource, kSize)) &&
           std::ranges::equal(response.subspan(kSource, kSize),
                              request.subspan(kDestination, kSize));
  }

  const Nodes nodes_;
  const ExchangeContext context_;
  const Request request_;
  std::optional<FinsCommand> command_;
  Cause silence_ = Cause::kNoResponse;
};

class FinsTcpProtocol final : public Protocol {
 public:
  explicit FinsTcpProtocol(const Nodes& nodes) : nodes_(nodes) {}
  const Traits& traits() const override { return kTraits; }
  std::span<const Area> areas() const override { return reached_in(Mode::kFinsEthernet).areas; }
  tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at) const override {
    return parse_with_suggestion(
        at, [](std::string_view text) { return omron::parse_address(Mode::kFinsEthernet, text); });
  }
  std::optional<ExchangeSize> size(const Request& request) const override {
    const auto sizes = fins_sizes(kEthernetLimits, kMessageHeader, request);
    if (!sizes) return std::nullopt;
    return ExchangeSize::of(nodes_.header() + sizes->request, nodes_.header() + sizes->response);
  }
  std::unique_ptr<Exchange> begin(Request request, ExchangeContext context) const override {
    return std::make_unique<FinsTcpExchange>(nodes_, context, std::move(request));
  }

 private:
  const Nodes nodes_;
};

std::optional<std::size_t> first_frame(ByteView stream) {
  const FinsFrame frame = first_fins_frame(stream);
  if (frame.kind == FinsFrame::Kind::kHopeless) return std::nullopt;
  return frame.size;
}

constexpr std::string_view kClientNode = "client-node";
constexpr std::array<std::string_view, 3> kOptions{kClientNode, "network", "unit"};

tl::expected<std::unique_ptr<Protocol>, OptionFault> make_fins_tcp(const DeviceLink& link) {
  OptionReader reader(link, kTraits, kOptions);
  Nodes nodes{.node = static_cast<std::uint8_t>(link.address)};
  for (const auto& [name, highest, field] :
       {std::tuple{"network", 127u, &nodes.network}, std::tuple{"unit", 254u, &nodes.unit}})
    *field = static_cast<std::uint8_t>(reader.number(name, 0, highest, 0));
  if (reader.text_of(kClientNode) != nullptr) {
    nodes.client = static_cast<std::uint8_t>(reader.number(kClientNode, 1, 254, 1));
    if (nodes.node == 0)
      reader.refuse("", "address 0 with client-node", "the node of the PLC, 1 to 254");
    if (nodes.node == nodes.client)
      reader.refuse(kClientNode, "client-node is the node of the PLC",
                    "a node that no other device has");
  }
  if (reader.fault()) return tl::unexpected(*reader.fault());
  return std::make_unique<FinsTcpProtocol>(nodes);
}

constexpr ProtocolAlias kTcpNames[] = {{"fins-tcp"}, {"omron-fins-tcp"}};
constexpr ProtocolOption kUdp[] = {{kClientNode, "239"}};
constexpr ProtocolVariant kVariants[] = {{.addresses = kFinsAddresses},
                                         {.options = kUdp, .addresses = kFinsAddresses}};

}  // namespace

const ProtocolEntry& fins_tcp_entry() {
  static constexpr ProtocolEntry entry{
      .name = kTraits.name,
      .summary = kTraits.summary,
      .make = make_fins_tcp,
      .explain = explain_fins_tcp,
      .options = kOptions,
      .options_text =
          "`client-node` of the bridge, with UDP; `network`, `unit` of another PLC behind "
          "this one; its `address` is the node",
      .first_frame = first_frame,
      .network_only = true,
      .stream_only = true,
      .datagram_option = kClientNode,
      .instead = "omron-hostlink",
      .carrier_checks = true,
      .aliases = kTcpNames,
      .variants = kVariants};
  return entry;
}

std::vector<FrameField> explain_fins_tcp(ByteView frame) {
  FieldWriter writer;
  if (!frame.empty() && (frame[0] & kRelayedFlag) != 0) {  // a datagram
    explain_fins(frame, (frame[0] & kResponseFlag) == 0, writer);
    return writer.take();
  }
  if (frame.size() < kFrameHeader) {
    writer.remark(to_hex(frame), "too short for a frame");
    return writer.take();
  }
  const bool magic = std::ranges::equal(frame.first(kMagic.size()), kMagic);
  writer.add(0, 4, "magic", printable(frame.first(4)), magic ? "" : "must be FINS");
  const std::size_t counted = read_u32(frame, 4);
  writer.add(4, 4, "length", std::to_string(counted),
             counted == frame.size() - kPrefix
                 ? ""
                 : "should be " + std::to_string(frame.size() - kPrefix));
  const std::uint32_t command = read_u32(frame, kPrefix), error = read_u32(frame, kPrefix + 4);
  writer.add(8, 4, "command",
             command == kAskNodes    ? "0 node of the client"
             : command == kGiveNodes ? "1 nodes of client and PLC"
             : command == kMessage   ? "2 FINS message"
                                     : std::to_string(command),
             command <= kMessage ? "" : "no command");
  const auto words =
      device_code_text(kTcpCodes, static_cast<std::uint16_t>(kFrameErrors + (error & 0xFF)));
  writer.add(12, 4, "error", error == 0 ? "0" : std::to_string(error) + " " + std::string(words));
  const ByteView data = frame.subspan(kFrameHeader);
  if (command == kMessage && !data.empty()) {
    FieldWriter inner(kFrameHeader, 1, 1);
    explain_fins(data, (data[0] & kResponseFlag) == 0, inner);
    writer.append(inner.take());
  } else {
    for (std::size_t at = 0; at + 4 <= data.size() && command <= kGiveNodes; at += 4)
      writer.add(kFrameHeader + at, 4, at == 0 ? "node of the client" : "node of the PLC",
                 std::to_string(read_u32(data, at)));
  }
  return writer.take();
}

}  // namespace fieldcast::omron
