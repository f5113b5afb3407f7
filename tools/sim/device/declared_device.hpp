// A simulated device of a declared protocol. After bytes that match no request of its own it waits
// for a silence, because a response of another device can have any form. Without an error frame in
// the declaration it stays silent instead of refusing. If a response has several forms, it sends
// each of them for some time, as a meter whose switch is turned.
#pragma once

#include <memory>
#include <string>

#include "tools/sim/device/declared_text.hpp"
#include "tools/sim/device/item_memory.hpp"

namespace fieldcast::sim {

class DeclaredDevice : public MemoryDevice {
 public:
  explicit DeclaredDevice(const DeviceSetup& setup);

  [[nodiscard]] std::unique_ptr<Receiver> open_receiver() override;

  enum class Taken : std::uint8_t { kMore, kDone, kNothing };
  // Parses all bytes since the last silence or response. kDone, empty response: stay silent.
  [[nodiscard]] Taken take(ByteView bytes, Instant now, Reaction& reaction);
  // The frame that the device sends by itself. REQUIRES: the operation has no request.
  [[nodiscard]] Bytes unsolicited(const declared::Operation& operation, Instant now);
  // Devices of one line begin at different times, so that their frames do not collide.
  [[nodiscard]] Duration first_frame_after(Duration period) const {
    constexpr std::uint64_t kSlots = 8;
    return period * static_cast<std::int64_t>(address_.number % kSlots) / kSlots;
  }
  [[nodiscard]] const declared::Declaration& declaration() const { return *declaration_; }
  [[nodiscard]] std::optional<ItemAddress> parse_address(std::string_view at) const;

 private:
  // A round before a request: a greeting or a login.
  [[nodiscard]] std::optional<Bytes> greet(const declared::Operation& round, ByteView bytes,
                                           bool& more) const;
  [[nodiscard]] Bytes execute(const declared::Operation& operation, DeclaredText text, Instant now);
  [[nodiscard]] std::uint8_t refusal(const declared::Operation& operation,
                                     const DeclaredText& text) const;
  [[nodiscard]] Bytes refuse(const declared::Operation& operation, DeclaredText text,
                             std::uint8_t code);
  void store(const declared::Operation& operation, const DeclaredText& text);
  // The form of the response at this time.
  [[nodiscard]] const declared::Frame& form(const declared::Operation& operation,
                                            Instant now) const;
  void fill(const declared::Operation& operation, Instant now, DeclaredText& text) const;

  const std::shared_ptr<const declared::Declaration> declaration_;
  const declared::DeviceAddress address_;
  const LineFormat line_;
  const bool stream_;
  const Instant start_;
  const std::optional<unsigned> form_;
};

[[nodiscard]] std::vector<std::string_view> declared_area_names(
    const declared::Declaration& declaration);

// The code, or the lowest of the declaration if it has codes without this one.
[[nodiscard]] std::uint8_t declared_code(const declared::Declaration& declaration,
                                         std::uint8_t code);

[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_declared_device(
    const DeviceSetup& setup);

}  // namespace fieldcast::sim
