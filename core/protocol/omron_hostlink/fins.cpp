#include "core/protocol/omron_hostlink/fins.hpp"

#include "core/codec/digits.hpp"
#include "core/protocol/omron_hostlink/fins_command.hpp"
#include "core/protocol/omron_hostlink/hostlink.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::omron {
namespace {

constexpr std::size_t kMaxFinsReceived = 4096;                 // three of the largest frames
constexpr std::size_t kDirectHeader = 4, kRelayedHeader = 10;  // bytes up to SID, inclusive
// Host Link part of a request and of a response: @uuFA and w or ee, FCS * CR.
constexpr std::size_t kRequestFrame = kHeadSize + 1 + kFcsSize + 2;
constexpr std::size_t kResponseFrame = kHeadSize + kEndCodeSize + kFcsSize + 2;

Bytes header_of(const FinsRoute& route, std::uint8_t sid) {
  if (!route.relayed) return {0, route.unit, 0, sid};
  return {kRelayedFlag, 0, kGatewayCount, route.network, route.node, route.unit, 0, 0, 0, sid};
}

class FinsExchange final : public Exchange {
 public:
  FinsExchange(const FinsRoute& route, std::uint8_t sid, const Request& request)
      : route_(route), command_(kHostLinkLimits, header_of(route, sid), request) {}

  Step start(Bytes& out) override {
    append_head(out, route_.host_unit, "FA");
    append_digits(out, route_.wait, 1);
    append_hex_bytes(out, command_.message());
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
  const Reply& reply() const override { return command_.reply(); }

 private:
  std::size_t frame_size() const { return kResponseFrame + 2 * command_.response_size(); }

  Step judge(ByteView text, bool last) {
    silence_ = Cause::kForeign;
    if (text.size() < kHeadSize || read_digits(text.subspan(1, 2), 10) != route_.host_unit)
      return Step::need_response();
    // The response of a PLC without FINS.
    if (last && text.size() == kHeadSize && text[3] == 'I' && text[4] == 'C')
      return Step::failed(Cause::kDeviceError, kNotSupported);
    if (text[3] != 'F' || text[4] != 'A') return Step::need_response();
    silence_ = Cause::kMalformed;
    const auto bytes = read_hex_bytes(text.subspan(kHeadSize));
    if (!last || !bytes || bytes->empty()) return Step::need_response();
    const std::uint8_t end_code = bytes->front();
    const ByteView message = ByteView(*bytes).subspan(1);
    if (command_.is_foreign(message)) {  // a response to an earlier request
      silence_ = Cause::kForeign;
      return Step::need_response();
    }
    if (end_code != 0) {
      const bool shaped = message.empty() || (message.size() > command_.header_size() &&
                                              (message[0] & kResponseFlag) != 0);
      return shaped ? Step::failed(device_code_cause(kEndCodes, end_code), end_code)
                    : Step::need_response();
    }
    return command_.judge(message, silence_);
  }

  const FinsRoute route_;
  FinsCommand command_;
  Cause silence_ = Cause::kNoResponse;
};

}  // namespace

std::optional<ExchangeSize> fins_size(const FinsRoute& route, const Request& request) {
  const auto sizes =
      fins_sizes(kHostLinkLimits, route.relayed ? kRelayedHeader : kDirectHeader, request);
  if (!sizes) return std::nullopt;
  return ExchangeSize::of(kRequestFrame + 2 * sizes->request, kResponseFrame + 2 * sizes->response,
                          1, std::chrono::milliseconds{10} * route.wait);
}

std::unique_ptr<Exchange> begin_fins(const FinsRoute& route, std::uint8_t sid,
                                     const Request& request) {
  return std::make_unique<FinsExchange>(route, sid, request);
}

std::string_view fins_end_text(std::uint16_t code) {
  // Codes below 0100 belong to the surrounding frame, except for two FINS codes.
  const auto text = device_code_text(kFinsCodes, code);
  return (code > 1 && code < 0x100) || text.empty() ? "unknown end code" : text;
}

}  // namespace fieldcast::omron
