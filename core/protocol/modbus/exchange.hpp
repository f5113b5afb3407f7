#pragma once

#include "core/protocol/modbus/framing.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::modbus {

class ModbusExchange final : public Exchange {
 public:
  // REQUIRES: pdu_sizes(request, options) holds a value.
  ModbusExchange(const Framing& framing, Header header, const Request& request,
                 const Options& options)
      : framing_(framing), header_(header), request_(request, options) {}

  Step start(Bytes& out) override;
  Step on_bytes(ByteView all, Bytes& out) override;
  Step on_silence(Bytes& out) override;
  const Reply& reply() const override { return reply_; }

 private:
  Step take(ByteView pdu);

  const Framing& framing_;
  const Header header_;
  const RequestPdu request_;
  Scratch scratch_;
  Reply reply_;
  Cause silence_ = Cause::kNoAnswer;  // cause of a failure if no more bytes arrive
  Bytes fallback_;  // the response, if silence shows that the bytes before it were noise
};

}  // namespace fieldcast::modbus
