#include "core/protocol/modbus/function.hpp"

namespace fieldcast::modbus {

std::string_view function_text(std::uint8_t function) {
  switch (function) {
    case 1: return "read coils";
    case 2: return "read discrete inputs";
    case 3: return "read holding registers";
    case 4: return "read input registers";
    case 5: return "write single coil";
    case 6: return "write single register";
    case 7: return "read exception status";
    case 8: return "diagnostics";
    case 11: return "get comm event counter";
    case 12: return "get comm event log";
    case 15: return "write multiple coils";
    case 16: return "write multiple registers";
    case 17: return "report server id";
    case 20: return "read file record";
    case 21: return "write file record";
    case 22: return "mask write register";
    case 23: return "read/write multiple registers";
    case 24: return "read fifo queue";
    case 43: return "encapsulated interface transport";
    default: return "unknown function";
  }
}

std::string_view exception_text(std::uint8_t code) {
  const auto text = device_code_text(kExceptions, code);
  return text.empty() ? "unknown exception" : text;
}

namespace {

// Function, then a byte that counts the rest.
std::size_t counted(ByteView pdu) { return pdu.size() < 2 ? 2 : std::size_t{2} + pdu[1]; }

}  // namespace

std::size_t answer_pdu_size(ByteView pdu) {
  if (pdu.empty()) return 0;
  if ((pdu[0] & kExceptionFlag) != 0) {
    const auto refused = static_cast<std::uint8_t>(pdu[0] & ~kExceptionFlag);
    return answer_pdu_size({&refused, 1}) != 0 ? 2 : 0;
  }
  switch (pdu[0]) {
    case 1:
    case 2:
    case 3:
    case 4:
    case 12:
    case 17:
    case 20:
    case 21:
    case 23: return counted(pdu);
    case 7: return 2;
    case 5:
    case 6:
    case 8:  // its common sub-functions echo two bytes
    case 11:
    case 15:
    case 16: return 5;
    case 22: return 7;
    case 24: return pdu.size() < 3 ? 3 : std::size_t{3} + read_u16(pdu, 1);
    default: return 0;
  }
}

std::size_t request_pdu_size(ByteView pdu) {
  if (pdu.empty()) return 0;
  switch (pdu[0]) {
    case 1:
    case 2:
    case 3:
    case 4:
    case 5:
    case 6:
    case 8: return 5;
    case 7:
    case 11:
    case 12:
    case 17: return 1;
    case 15:
    case 16: return pdu.size() < 6 ? 6 : std::size_t{6} + pdu[5];
    case 20:
    case 21: return counted(pdu);
    case 22: return 7;
    case 23: return pdu.size() < 10 ? 10 : std::size_t{10} + pdu[9];
    case 24: return 3;
    case 43: return 4;
    default: return 0;
  }
}

}  // namespace fieldcast::modbus
