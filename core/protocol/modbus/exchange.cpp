#include "core/protocol/modbus/exchange.hpp"

#include "core/protocol/modbus/function.hpp"

namespace fieldcast::modbus {

Step ModbusExchange::start(Bytes& out) {
  framing_.wrap(header_, request_.pdu(), out);
  silence_ = Cause::kNoAnswer;
  fallback_.clear();
  return Step::send(static_cast<std::uint32_t>(framing_.size(request_.answer_size())));
}

Step ModbusExchange::on_bytes(ByteView all, Bytes&) {
  if (all.size() > kMaxReceived) return Step::failed(Cause::kOverlong);
  const ParseResult parsed = framing_.find(all, header_, request_, scratch_);
  silence_ = parsed.cause;
  fallback_.assign(parsed.fallback.begin(), parsed.fallback.end());
  switch (parsed.kind) {
    case ParseResult::Kind::kAnswer:
    case ParseResult::Kind::kException: return take(parsed.pdu);
    case ParseResult::Kind::kNothing: return Step::need_answer();
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

}  // namespace fieldcast::modbus
