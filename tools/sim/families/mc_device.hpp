// A simulated Mitsubishi PLC at its MC protocol port, from the specification only (SH-080008,
// chapters 5 and 8). It responds to 3E and 4E frames in the code that its options name.
//
//     0401, 1401    batch read and write, words (0000, 0002) and bits (0001, 0003)
//     0403          random read of words and double words
//     1402          random write of words and double words, and of bits
//
// A frame with an unknown subheader ends the connection. A silence of 100 ms ends a partial frame:
// the device no longer waits for its rest.
#pragma once

#include <array>
#include <memory>
#include <string_view>

#include "tools/sim/device/item_memory.hpp"

namespace fieldcast::sim {

inline constexpr std::array<std::string_view, 26> kMcAreaNames{
    "D", "W", "R", "ZR", "SD", "SW", "Z", "TN", "SN", "CN", "M",  "L",  "F",
    "V", "B", "X", "Y",  "SM", "SB", "S", "TS", "TC", "SS", "SC", "CS", "CC"};

class McDevice : public MemoryDevice {
 public:
  explicit McDevice(const DeviceSetup& setup);

  [[nodiscard]] std::unique_ptr<Receiver> open_receiver() override;

 protected:
  struct Place {
    std::size_t area = 0;
    std::uint32_t number = 0;
  };
  struct Result {
    std::uint16_t end = 0;
    Bytes data;
  };
  McDevice(const DeviceSetup& setup, bool ascii);

  // Empty for an unknown device, or digits that are not a number of its base.
  [[nodiscard]] static std::optional<Place> place_at(std::string_view name, ByteView digits);
  // Executes a request from its command on.
  [[nodiscard]] Result run(ByteView content, Instant now);

  // The end code of a refusal, or 0. Of bit devices, a word is 16 of them.
  [[nodiscard]] std::uint16_t refusal_of_words(const Place& place, std::uint32_t words) const;
  [[nodiscard]] std::uint16_t refusal_of_bits(const Place& place, std::uint32_t bits) const;
  [[nodiscard]] std::uint16_t word(const Place& place, std::uint32_t index, Instant now) const;
  void store_word(const Place& place, std::uint32_t index, std::uint32_t value);
  void append_field(Bytes& out, std::uint64_t value, unsigned bytes) const;

  const LineFormat line_;
  const bool ascii_;

 private:
  class Connection;
  class Text;

  // Responds to a whole request.
  void answer(ByteView frame, Instant now, Reaction& reaction);
  [[nodiscard]] Result execute(std::uint32_t command, std::uint32_t subcommand, Text& text,
                               Instant now);
  [[nodiscard]] Result cpu_model() const;
  [[nodiscard]] Result batch(bool write, bool bits, Text& text, Instant now);
  [[nodiscard]] Result random_read(bool series_r, Text& text, Instant now) const;
  [[nodiscard]] Result random_write(bool bits, bool series_r, Text& text);

  const std::uint8_t station_, network_;
  const bool has_port_;  // the PLC of the connection; others are behind it
};

// Empty for an invalid address.
[[nodiscard]] std::optional<ItemAddress> parse_mc_address(std::string_view at);

// Fails for an address above 255 or an invalid channel address.
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_mc_device(
    const DeviceSetup& setup);

}  // namespace fieldcast::sim
