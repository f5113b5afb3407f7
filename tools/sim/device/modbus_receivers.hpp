// How a simulated Modbus device receives: the three framings.
//
//   RTU    unit(1) PDU CRC lo, CRC hi                       256 bytes at most
//   ASCII  ':' hex(unit PDU LRC) CR LF                      513 characters at most
//   TCP    transaction(2) 0000 length(2) unit(1) PDU        length 2..254
//
// A slave on a serial bus receives the others too: it knows the shapes of requests and of answers,
// and after a frame that is neither it waits for a silence of 3.5 characters before it trusts the
// line again (Modbus over Serial Line V1.02, 2.5.1). It knows whose answer is next: every answer of
// two registers whose checksum ends with 00 begins with what would be a whole request.
#pragma once

#include "tools/sim/device/device.hpp"
#include "tools/sim/device/modbus_unit.hpp"

namespace fieldcast::sim {

// Receives RTU frames. A silence of 3.5 characters ends a frame of unknown length or a broken one.
// On a `stream`, whose network may hold back the second half of a frame, a tenth of a second does.
class RtuReceiver : public Receiver {
 public:
  RtuReceiver(ModbusUnit& unit, const LineFormat& line, bool stream);
  void on_character(std::uint8_t character, Instant end, Reaction& reaction) override;
  [[nodiscard]] Instant silence_due() const override;
  void on_silence(Instant now, Reaction& reaction) override;

 private:
  void answer(Instant now, Reaction& reaction);  // to the whole frame in frame_
  ModbusUnit& unit_;
  Duration character_, gap_;
  Bytes frame_;
  Bytes asked_;  // unit and function of the last request to another, until its answer; empty: none
  bool lost_ = false;  // inside something broken: nothing counts until a silence
  Instant last_ = kLongAgo;
};

class AsciiReceiver : public Receiver {
 public:
  explicit AsciiReceiver(ModbusUnit& unit) : unit_(unit) {}
  void on_character(std::uint8_t character, Instant end, Reaction& reaction) override;

 private:
  void answer(Instant now, Reaction& reaction);
  ModbusUnit& unit_;
  bool inside_ = false;
  Bytes digits_;  // characters after ':'
};

// `any_unit`: also answers for unit 0 and 255, the device that the address of the connection names.
class TcpReceiver : public Receiver {
 public:
  TcpReceiver(ModbusUnit& unit, bool any_unit) : unit_(unit), any_unit_(any_unit) {}
  void on_character(std::uint8_t character, Instant end, Reaction& reaction) override;

 private:
  ModbusUnit& unit_;
  bool any_unit_;
  Bytes frame_;
};

}  // namespace fieldcast::sim
