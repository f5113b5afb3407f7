// FINS commands (fins_command.hpp) over TCP and UDP, port 9600 (Omron W421, 7-4 and 6-2). With the
// option `client-node` a FINS message is a datagram, without the frame and the greeting of TCP:
//
//     frame      "FINS" length(4) command(4) error(4) data..     length: bytes after this field
//     greeting   command 0, data: node of the client(4), 0: the PLC assigns it
//                ->  command 1, data: node of the client(4) node of the PLC(4)
//     message    command 2, data: a FINS message
//
// The PLC accepts the greeting once for each connection, so the bus keeps its result until it opens
// the port again (ExchangeContext::session): the two nodes, one byte each.
#pragma once

#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::omron {

[[nodiscard]] const ProtocolEntry& fins_tcp_entry();

[[nodiscard]] std::vector<FrameField> explain_fins_tcp(ByteView frame);

}  // namespace fieldcast::omron
