// Receivers of a simulated Modbus device for the three framings.
//
// RTU    unit(1) PDU CRC lo, CRC hi                       256 bytes at most
// ASCII  ':' hex(unit PDU LRC) CR LF                      513 characters at most
// TCP    transaction(2) 0000 length(2) unit(1) PDU        length 2..254
//
// A slave on a serial bus also receives frames of other units, so it parses requests and responses.
// After any other frame it waits for a silence of 3.5 characters (Modbus over Serial Line V1.02,
// 2.5.1). It tracks whose response is next: a response of two registers whose checksum ends with 00
// starts with the bytes of a valid request.
#pragma once

#include "tools/sim/device/device.hpp"
#include "tools/sim/families/modbus/modbus_unit.hpp"

namespace fieldcast::sim {

// A silence of 3.5 characters ends an invalid frame or one of unknown length; on a `stream` 100 ms,
// because the network may delay part of a frame.
class RtuReceiver : public GapReceiver {
 public:
  RtuReceiver(ModbusUnit& unit, const LineFormat& line, bool stream);
  void on_character(std::uint8_t character, Instant end, Reaction& reaction) override;
  void on_silence(Instant now, Reaction& reaction) override;

 private:
  void respond(Instant now, Reaction& reaction);
  ModbusUnit& unit_;
  // unit and function of the last request to another unit, until its response; empty: none
  Bytes requested_;
};

class AsciiReceiver : public Receiver {
 public:
  explicit AsciiReceiver(ModbusUnit& unit) : unit_(unit) {}
  void on_character(std::uint8_t character, Instant end, Reaction& reaction) override;

 private:
  void respond(Instant now, Reaction& reaction);
  ModbusUnit& unit_;
  bool inside_ = false;
  Bytes digits_;  // characters after ':'
};

// `any_unit`: also responds for units 0 and 255, which mean the device at the connection's address.
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
