// A simulated Mitsubishi FX at its programming port. Implemented from the specification only,
// independent of the bridge's codec except for the sum.
//
//     ENQ 05                               ->  ACK 06
//     02 command address(4) .. 03 sum(2)   ->  02 data 03 sum(2), or 06; 15 to refuse
//
// Supports the classic commands 0, 1, 7, 8 and the extended E00, E10, E7, E8 with their own address
// map. A port has one PLC without an address.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "tools/sim/device/item_memory.hpp"

namespace fieldcast::sim {

inline constexpr std::array<std::string_view, 14> kFxAreaNames{
    "D", "D8000", "T", "C", "C200", "M", "M8000", "X", "Y", "S", "TS", "TC", "CS", "CC"};

class FxDevice : public MemoryDevice {
 public:
  explicit FxDevice(const DeviceSetup& setup);

  [[nodiscard]] std::unique_ptr<Receiver> open_receiver() override;

  // `text`: after STX up to and including ETX; `sum`: its two digits.
  [[nodiscard]] Bytes take(ByteView text, ByteView sum, Instant now);

 private:
  // One byte of an address map: of a word or dword, or eight bits.
  struct Cell {
    std::size_t area = 0;
    std::uint32_t item = 0;
    unsigned byte = 0;  // index in the item, lowest first
  };
  [[nodiscard]] std::optional<Cell> cell_at(bool extended, std::uint32_t address) const;
  [[nodiscard]] bool refuses(const Cell& cell) const;
  [[nodiscard]] std::uint8_t load(const Cell& cell, Instant now) const;
  void store(const Cell& cell, std::uint8_t byte, Instant now);

  [[nodiscard]] Bytes execute(ByteView text, Instant now);
  [[nodiscard]] Bytes read(bool extended, ByteView range, Instant now) const;
  [[nodiscard]] Bytes write(bool extended, ByteView range, Instant now);
  [[nodiscard]] Bytes force(bool extended, ByteView range, bool on);
};

[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_fx_device(
    const DeviceSetup& setup);

}  // namespace fieldcast::sim
