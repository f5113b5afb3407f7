#include "core/protocol/modbus/exchange.hpp"

namespace fieldcast::modbus {
namespace {

constexpr std::uint8_t kAcknowledge = 0x05;  // accepted, but the work takes long
constexpr std::uint8_t kBusy = 0x06;

}  // namespace

Step ModbusExchange::start(Bytes& out) {
  framing_.wrap(ticket_, question_.pdu(), out);
  silence_ = Cause::kNoAnswer;
  fallback_.clear();
  return Step::send(static_cast<std::uint32_t>(framing_.size(question_.answer_size())));
}

Step ModbusExchange::on_bytes(ByteView all, Bytes&) {
  if (all.size() > kMaxReceived) return Step::failed(Cause::kOverlong);
  const Sighting sighting = framing_.find(all, ticket_, question_, scratch_);
  silence_ = sighting.cause;
  fallback_.assign(sighting.fallback.begin(), sighting.fallback.end());
  switch (sighting.kind) {
    case Sighting::Kind::kAnswer:
    case Sighting::Kind::kException: return take(sighting.pdu);
    case Sighting::Kind::kNothing: return Step::need_answer();
    case Sighting::Kind::kBegun: return Step::need_rest(sighting.missing);
    case Sighting::Kind::kHopeless: break;
  }
  return Step::failed(sighting.cause);
}

Step ModbusExchange::on_silence(Bytes&) {
  if (!fallback_.empty()) return take(fallback_);
  return Step::failed(silence_);
}

Step ModbusExchange::take(ByteView pdu) {
  if ((pdu[0] & kExceptionFlag) != 0) {
    const std::uint8_t code = pdu[1];
    return Step::failed(
        code == kAcknowledge || code == kBusy ? Cause::kDeviceBusy : Cause::kDeviceError, code);
  }
  reply_ = question_.unpack(pdu);
  return Step::done();
}

}  // namespace fieldcast::modbus
