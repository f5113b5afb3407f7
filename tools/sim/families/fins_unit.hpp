// A simulated Omron PLC on the level of FINS messages (Omron W342). Does not own the PLC's memory.
//
//     direct    ICF 00, DA2, SA2, SID, command(2), text
//     response  ICF 40, the same, command, end code(2), data
//     relayed   ICF 80, RSV, GCT, destination(3), source(3), SID, command(2), text
//     response  ICF C0, source and destination exchanged
#pragma once

#include "tools/sim/device/device.hpp"
#include "tools/sim/device/item_memory.hpp"

namespace fieldcast::sim {

class FinsUnit {
 public:
  FinsUnit(ItemMemory& memory, DeviceStatistics& statistics)
      : memory_(memory), statistics_(statistics) {}

  [[nodiscard]] Bytes execute(ByteView message, Instant now);

 private:
  struct Address {
    std::size_t area = 0;
    std::uint32_t first = 0;
    std::optional<std::uint8_t> bit;  // bit of a word: `count` counts bits
  };
  struct Result {
    std::uint16_t end = 0;
    Bytes data;
  };
  [[nodiscard]] static std::optional<Address> address_of(ByteView area_and_address);
  [[nodiscard]] std::uint16_t refusal(const Address& address, std::uint32_t count) const;
  [[nodiscard]] static std::size_t item_size(const Address& address);
  void append_items(const Address& address, std::uint32_t count, Instant now, Bytes& out) const;
  void store(const Address& address, std::uint32_t count, ByteView data, Instant now);

  [[nodiscard]] Result dispatch(std::uint16_t command, ByteView text, Instant now);
  [[nodiscard]] Result read(ByteView text, Instant now) const;
  [[nodiscard]] Result write(ByteView text, Instant now);
  [[nodiscard]] Result fill(ByteView text, Instant now);
  [[nodiscard]] Result read_many(ByteView text, Instant now) const;
  [[nodiscard]] Result transfer(ByteView text, Instant now);
  [[nodiscard]] static Result cpu_data(ByteView text);

  ItemMemory& memory_;
  DeviceStatistics& statistics_;
  std::uint8_t mode_ = 2;  // 0 PROGRAM, 2 MONITOR, 4 RUN
};

}  // namespace fieldcast::sim
