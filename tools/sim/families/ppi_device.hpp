// A simulated S7-200 at its PPI port. Implemented from the specification only, independent of the
// bridge's codec except for the sum.
//
//     request   68 LE LE 68 DA SA FC 32 01 .. FCS 16     ->  E5
//     poll      10 DA SA FC FCS 16                       ->  68 .. 32 03 .. 16
//               if nothing is queued                     ->  10 SA DA 09 FCS 16
//
// This class is the link layer; S7Unit (s7_unit.hpp) executes the requests.
#pragma once

#include <memory>
#include <string>

#include "tools/sim/device/device.hpp"
#include "tools/sim/families/s7_unit.hpp"

namespace fieldcast::sim {

class PpiDevice : public MemoryDevice {
 public:
  explicit PpiDevice(const DeviceSetup& setup);

  [[nodiscard]] std::unique_ptr<Receiver> open_receiver() override;

  // `telegram`: from destination to last unit byte. Returns an empty response to stay silent.
  [[nodiscard]] Bytes take_long(ByteView telegram, Instant now);
  [[nodiscard]] Bytes take_short(std::uint8_t to, std::uint8_t from, std::uint8_t control);

 private:
  const std::uint8_t station_;
  const LineFormat line_;
  const bool stream_;
  S7Unit unit_;
  Bytes queued_;  // response waiting for a poll
  Bytes given_;   // response to the last poll
  // Frame control of the last poll: a poll with the same value repeats the response.
  std::optional<std::uint8_t> last_poll_{};
};

// Fails for a station outside 0..126 or an invalid channel address.
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_ppi_device(
    const DeviceSetup& setup);

}  // namespace fieldcast::sim
