// A simulated device of a declared protocol: it answers what the declaration says, from a memory
// like that of any other.
//
// What fits no request makes it wait for a silence; a request for another address too, for its
// answer may look like anything. Where the declaration has an error frame it refuses, elsewhere it
// stays silent.
#pragma once

#include <memory>
#include <string>

#include "tools/sim/device/declared_text.hpp"
#include "tools/sim/device/device.hpp"
#include "tools/sim/device/item_memory.hpp"

namespace fieldcast::sim {

class DeclaredDevice : public SimDevice {
 public:
  explicit DeclaredDevice(const DeviceSetup& setup);

  [[nodiscard]] std::unique_ptr<Receiver> open_receiver() override;
  [[nodiscard]] const DeviceStatistics& statistics() const override { return statistics_; }
  [[nodiscard]] std::optional<std::uint64_t> peek(std::string_view area, std::uint32_t item,
                                                  Instant now) override {
    return memory_.peek(area, item, now);
  }
  bool poke(std::string_view area, std::uint32_t item, std::uint64_t bits) override {
    return memory_.poke(area, item, bits);
  }
  [[nodiscard]] ItemMemory& memory() { return memory_; }

  enum class Taken : std::uint8_t { kMore, kDone, kNothing };
  // All since the last silence or answer. kDone with an empty answer: silence is right.
  [[nodiscard]] Taken take(ByteView bytes, Instant now, Bytes& answer);
  [[nodiscard]] std::optional<ItemAddress> parse_address(std::string_view at) const;

 private:
  [[nodiscard]] Bytes execute(const declared::Operation& operation, DeclaredText text, Instant now);
  [[nodiscard]] std::uint8_t refusal(const declared::Operation& operation,
                                     const DeclaredText& text) const;
  [[nodiscard]] Bytes refuse(const declared::Operation& operation, DeclaredText text,
                             std::uint8_t code);
  void store(const declared::Operation& operation, const DeclaredText& text);
  void fill(const declared::Operation& operation, Instant now, DeclaredText& text) const;

  const std::shared_ptr<const declared::Declaration> declaration_;
  const std::uint16_t address_;
  const LineFormat line_;
  const bool stream_;
  ItemMemory memory_;
  DeviceStatistics statistics_;
};

// Names of the areas whose items a fault can name.
[[nodiscard]] std::vector<std::string_view> declared_area_names(
    const declared::Declaration& declaration);

// Refuses, with a text for people, an address that the declaration does not have, and a channel
// whose address it does not know.
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_declared_device(
    const DeviceSetup& setup);

}  // namespace fieldcast::sim
