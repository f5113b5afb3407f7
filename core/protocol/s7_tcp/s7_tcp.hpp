// S7 messages over ISO-on-TCP, port 102 (RFC 1006, ISO 8073 class 0).
//
//     frame       03 00 length(2) TPDU                   length: of the whole frame
//     connect     LI E0 0000 0001 00 C0 01 0A C1 02 local TSAP(2) C2 02 TSAP of the CPU(2)
//                 ->  LI D0 ..
//     set up      02 F0 80 message: job F0 00 jobs(2) jobs(2) PDU(2)
//                 ->  02 F0 80 message with the granted PDU
//     messages    02 F0 80 message                       (core/protocol/s7comm)
//     refusal     LI 80 ..
//
// Connect and set up are sent once for each connection. Its state is kept in
// ExchangeContext::session: one byte for each of the two that is done.
#pragma once

#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::s7_tcp {

[[nodiscard]] const ProtocolEntry& entry();

[[nodiscard]] std::vector<FrameField> explain(ByteView frame);

}  // namespace fieldcast::s7_tcp
