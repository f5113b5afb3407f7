// A simulated Omron PLC at its Host Link port: C-mode commands, including replies and writes of
// several frames, and FINS (header FA). Implemented from the specification only, independent of the
// bridge's codec except for the XOR.
//
//     @ uu HH text FCS * CR        ->  @ uu HH ee data FCS * CR
//     .. FCS CR                        an unfinished frame: a lone CR requests the next one
#pragma once

#include <deque>
#include <memory>
#include <string>

#include "tools/sim/device/item_memory.hpp"
#include "tools/sim/families/fins_unit.hpp"

namespace fieldcast::sim {

class HostLinkDevice : public MemoryDevice {
 public:
  explicit HostLinkDevice(const DeviceSetup& setup);

  [[nodiscard]] std::unique_ptr<Receiver> open_receiver() override;

  // `line`: without CR; starts with `@`, except a delimiter or a later frame of a write.
  void take(ByteView line, Instant now, Reaction& reaction);

 private:
  struct Command {
    std::string header;
    std::string text;  // after the header
    bool last = true;  // ended with `*`
  };
  struct Address {
    std::size_t area = 0;
    std::uint32_t first = 0;
  };
  void take_command(ByteView line, Instant now, Reaction& reaction);
  void take_write_part(ByteView line, Reaction& reaction);
  [[nodiscard]] Bytes execute(const Command& command, Instant now);
  [[nodiscard]] Bytes read(const Command& command, Instant now);
  [[nodiscard]] Bytes begin_write(const Command& command);
  [[nodiscard]] Bytes finish_write();
  [[nodiscard]] Bytes fins(const Command& command, Instant now, Duration& pause);
  [[nodiscard]] tl::expected<Address, std::string> address_of(char letter, std::string_view digits,
                                                              std::uint32_t count) const;
  [[nodiscard]] std::uint8_t refusal(const Address& address, std::uint32_t count) const;
  [[nodiscard]] Bytes respond(std::string_view header, std::string_view end_code,
                              std::string_view text = {});
  void forget_transfer();

  const unsigned unit_;
  FinsUnit fins_;
  unsigned mode_ = 2;               // set by SC: 0 PROGRAM, 2 MONITOR, 3 RUN
  std::deque<Bytes> later_frames_;  // frames of a reply that wait for a delimiter
  std::string writing_;             // header of the unfinished write
  std::string write_address_;       // first item of the write, as digits
  std::string write_data_;          // received so far
};

// Fails for a unit outside 0..31 or an invalid channel address.
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_hostlink_device(
    const DeviceSetup& setup);

}  // namespace fieldcast::sim
