#include "core/protocol/modbus/framing.hpp"

#include "core/protocol/modbus/request.hpp"

namespace fieldcast::modbus {

Step ModbusExchange::start(Bytes& out) {
  framing_.wrap(header_, request_.pdu(), out);
  silence_ = Cause::kNoResponse;
  fallback_.clear();
  return Step::send(framing_.size(request_.response_size()));
}

Step ModbusExchange::on_bytes(ByteView all, Bytes&) {
  if (all.size() > kMaxReceived) return Step::failed(Cause::kOverlong);
  const ParseResult parsed = framing_.find(all, header_, request_, scratch_);
  silence_ = parsed.cause;
  fallback_.assign(parsed.fallback.begin(), parsed.fallback.end());
  switch (parsed.kind) {
    case ParseResult::Kind::kResponse:
    case ParseResult::Kind::kException: return take(parsed.pdu);
    case ParseResult::Kind::kNothing: return Step::need_response();
    case ParseResult::Kind::kBegun: return Step::need_rest(parsed.missing);
    case ParseResult::Kind::kHopeless: break;
  }
  return Step::failed(parsed.cause);
}

Step ModbusExchange::on_silence(Bytes&) {
  if (!fallback_.empty()) return take(fallback_);
  return Step::failed(silence_);
}

Step ModbusExchange::take(ByteView pdu) {
  if ((pdu[0] & kExceptionFlag) != 0) {
    const std::uint8_t code = pdu[1];
    return Step::failed(device_code_cause(kExceptions, code), code);
  }
  reply_ = request_.unpack(pdu);
  return Step::done();
}

// Modbus Messaging on TCP/IP V1.0b, 3.1.3.

namespace {

constexpr std::size_t kHeader = 7;     // transaction, protocol, length, unit
constexpr std::size_t kCounted = 6;    // bytes before those that `length` counts
constexpr std::size_t kMinLength = 2;  // unit and a function
constexpr std::size_t kMaxLength = 254;

std::size_t tcp_size(std::size_t pdu_size) { return kHeader + pdu_size; }

void wrap_tcp(const Header& header, ByteView pdu, Bytes& out) {
  append_u16(out, header.transaction);
  append_u16(out, 0);
  append_u16(out, static_cast<std::uint16_t>(pdu.size() + 1));
  out.push_back(header.unit);
  append(out, pdu);
}

// Returns true for an invalid header: the stream has lost its framing. The exchange fails
// immediately. Received bytes are dropped before the next request, so the connection need not be
// reopened unless it happens again.
bool is_hopeless(ByteView frame) {
  if (frame.size() >= 4 && read_u16(frame, 2) != 0) return true;
  if (frame.size() < kCounted) return frame.size() >= 3 && frame[2] != 0;
  const std::size_t length = read_u16(frame, 4);
  return length < kMinLength || length > kMaxLength;
}

ParseResult find_in_tcp(ByteView all, const Header& header, const RequestPdu& request, Scratch&) {
  ParseResult result;
  while (!all.empty()) {
    if (is_hopeless(all)) return {.kind = ParseResult::Kind::kHopeless, .cause = Cause::kMalformed};
    const std::size_t length = all.size() < kCounted ? kHeader : kCounted + read_u16(all, 4);
    if (all.size() < length) {
      // Not kBegun: a network may pause between segments, so the wait for the rest lasts the whole
      // timeout.
      const bool ours = all.size() < 2 || read_u16(all) == header.transaction;
      if (ours || result.cause == Cause::kNoResponse)
        result.cause = ours ? Cause::kTruncated : Cause::kForeign;
      return result;
    }
    const ByteView pdu = all.first(length).subspan(kHeader);
    if (read_u16(all) != header.transaction || all[6] != header.unit) {
      if (result.cause == Cause::kNoResponse) result.cause = Cause::kForeign;
    } else {
      const Verdict verdict = request.judge(pdu);
      if (verdict == Verdict::kResponse) return {.kind = ParseResult::Kind::kResponse, .pdu = pdu};
      if (verdict == Verdict::kException)
        return {.kind = ParseResult::Kind::kException, .pdu = pdu};
      result.cause = verdict == Verdict::kMismatch ? Cause::kMalformed : Cause::kForeign;
    }
    all = all.subspan(length);
  }
  return result;
}

}  // namespace

std::optional<std::size_t> first_tcp_frame(ByteView stream) {
  if (is_hopeless(stream)) return std::nullopt;
  if (stream.size() < kCounted) return 0;
  const std::size_t size = kCounted + read_u16(stream, 4);
  return stream.size() < size ? 0 : size;
}

const Framing& tcp_framing() {
  static constexpr Framing framing{tcp_size, wrap_tcp, find_in_tcp};
  return framing;
}

}  // namespace fieldcast::modbus
