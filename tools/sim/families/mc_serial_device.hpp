// A simulated Mitsubishi PLC at its serial communication module, from the specification only
// (SH-080008, chapters 4 and 8). It responds to the frames and in the format that its options name,
// and to a request whose header has its station and the route of its options.
//
//     05 header content sum  ->  02 header data 03 sum, 06 header, or 15 header code
//     02 header content 03 sum  ->  02 header QACK data 03 sum, 02 header QACK 03, or
//                                   02 header QNAK code 03 (format 3; 1C: GG and NN)
//     10 02 count header content 10 03 sum  ->  10 02 count header FF FF code data 10 03 sum
//
// In format 2, a response has the block number of its request. 1C frames carry BR, WR, BW, WW, JR,
// QR, JW and QW; an FX has octal numbers of X and Y. A refused range has the code 06 there,
// whatever its configuration says.
//
// The module finds the end of a request without CR LF by the length that its command needs. A
// silence of 100 ms ends a partial frame; an unknown command is refused then.
#pragma once

#include <memory>
#include <optional>

#include "tools/sim/families/mc_device.hpp"

namespace fieldcast::sim {

class McSerialDevice : public McDevice {
 public:
  explicit McSerialDevice(const DeviceSetup& setup);

  [[nodiscard]] std::unique_ptr<Receiver> open_receiver() override;

 private:
  class Line;

  // Returns true if the request is whole, or is for another station.
  bool take_ascii(ByteView text, Instant now, Reaction& reaction);
  void refuse_unknown(ByteView text, Reaction& reaction);
  bool take_binary(ByteView bytes, Instant now, Reaction& reaction);

  // Characters of a request in ASCII code from its command on. Empty: not known yet; 0: the command
  // does not exist.
  [[nodiscard]] std::optional<std::size_t> length_of(ByteView content) const;
  [[nodiscard]] Result execute(ByteView content, Instant now);
  // Of a 1C frame.
  [[nodiscard]] Result run_short(ByteView content, Instant now);
  [[nodiscard]] Result read_short(const Place& place, bool bits, std::uint32_t points,
                                  Instant now) const;
  [[nodiscard]] Result write_short(const Place& place, bool bits, std::uint32_t points,
                                   ByteView data);
  void respond(const Result& result, Reaction& reaction);
  void respond_ascii(const Result& result, Bytes& out) const;
  void respond_binary(const Result& result, Bytes& out) const;

  // Characters of a request in ASCII code before its command.
  [[nodiscard]] std::size_t content_begin() const { return header_.size() + (numbered_ ? 2 : 0); }

  const bool binary_, numbered_, enclosed_, line_end_, sum_check_, short_, octal_;
  Bytes header_;
  Bytes block_;  // of the request that is executed; format 2
};

// Fails for a station above 31 or an invalid channel address.
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_mc_serial_device(
    const DeviceSetup& setup);

}  // namespace fieldcast::sim
