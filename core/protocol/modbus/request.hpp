// One Modbus request as a PDU, and what its answer must be: the layer under all framings.
//
//     function  request                                              answer
//     01 02     first(2) quantity(2)                                 count(1) bits..
//     03 04     first(2) quantity(2)                                 count(1) registers..
//     05 06     address(2) value(2)                                  the request
//     0F        first(2) quantity(2) count(1) bits..                 first(2) quantity(2)
//     10        first(2) quantity(2) count(1) registers..            first(2) quantity(2)
//     16        address(2) and-mask(2) or-mask(2)                    the request
//     17        first(2) quantity(2) first(2) quantity(2) count(1)
//               registers..                                          count(1) registers..
//     fn | 80   -                                                    exception code(1)
//
// Bits come least significant first, registers big-endian.
// (Modbus Application Protocol V1.1b3, 6)
#pragma once

#include <cstdint>
#include <optional>

#include "core/protocol/modbus/function.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::modbus {

// What a device's configuration chooses among the functions.
struct Options {
  // Functions 15 and 16 for single items too: some devices know no 5 and 6.
  bool write_multiple = false;
  bool mask_write = false;  // function 22 for one bit or byte of a register
  bool read_write = false;  // function 23 for a write that is read back at once
};

struct PduSizes {
  std::size_t request = 0;
  std::size_t answer = 0;
};

// Nothing when the request breaks a limit or asks for what these functions cannot do. Allocates
// nothing.
[[nodiscard]] std::optional<PduSizes> pdu_sizes(const Request& request, const Options& options);

// What an answer PDU is to a request.
enum class Verdict : std::uint8_t {
  kAnswer,
  kException,  // of our function
  // Our function, but a byte count or an echo that is not ours: an answer to an earlier request, or
  // a confused device.
  kMismatch,
  kForeign,  // another function
};

// A request in the bytes of its function, and the judge of the answers to it. A plain value; it is
// read on the thread of its exchange.
class RequestPdu {
 public:
  // REQUIRES: pdu_sizes(request, options) holds a value.
  RequestPdu(const Request& request, const Options& options);

  [[nodiscard]] ByteView pdu() const { return pdu_; }
  [[nodiscard]] std::size_t answer_size() const { return answer_size_; }
  [[nodiscard]] std::uint8_t function() const { return pdu_[0]; }

  // REQUIRES: answer is one whole PDU, checked by its framing.
  [[nodiscard]] Verdict judge(ByteView answer) const;
  // The items of the answer. REQUIRES: judge(answer) == kAnswer.
  [[nodiscard]] Reply unpack(ByteView answer) const;

 private:
  Bytes pdu_;
  std::size_t answer_size_ = 0;
  // Items that the answer brings; 0: the answer echoes the start of the request.
  std::uint16_t read_count_ = 0;
  bool bits_ = false;
  bool writes_and_reads_ = false;
};

}  // namespace fieldcast::modbus
