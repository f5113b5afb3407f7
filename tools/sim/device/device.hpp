// Interface of a simulated PLC family.
//
// A SimDevice owns the memory of one PLC and outlives its receivers: one on a serial bus, one for
// each TCP connection. Receivers get every character of the line, also of other devices, as a real
// slave does. Pure: characters and instants in, responses out. Single-threaded.
#pragma once

#include <charconv>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "core/frame/line.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast::sim {

struct DeviceStatistics {
  // Requests executed or refused, by function: "03".
  std::map<std::string, std::uint64_t> requests;
  std::map<unsigned, std::uint64_t> exceptions;  // by code
  // By item: "holding:107"; counts the write requests that changed it.
  std::map<std::string, std::uint64_t> writes;
  std::uint64_t write_requests = 0;  // executed
  std::uint64_t broadcasts = 0;      // executed without a response
  std::uint64_t bad_frames = 0;      // received with wrong checksum, length or characters
  std::uint64_t responses = 0;       // created; faults may still drop them
};

struct Reaction {
  Bytes response;  // empty: no response
  // Delay before the response that the request demands, in addition to the device's own.
  Duration pause{};
  std::uint32_t baud = 0;  // of the response; 0: that of the line
  bool hang_up = false;    // TCP: the stream cannot be parsed further; close the connection
};

class Receiver {
 public:
  virtual ~Receiver() = default;
  // `end`: end of the last stop bit. Instants never decrease.
  virtual void on_character(std::uint8_t character, Instant end, Reaction& reaction) = 0;
  // Time at which an unbroken silence has a meaning; kNever: none.
  [[nodiscard]] virtual Instant silence_due() const { return kNever; }
  // The line was silent until `now`, which is not before silence_due().
  virtual void on_silence([[maybe_unused]] Instant now, [[maybe_unused]] Reaction& reaction) {}
  // When the device sends a frame by itself; kLongAgo: immediately, kNever: never.
  [[nodiscard]] virtual Instant sends_at() const { return kNever; }
  // REQUIRES: sends_at() <= now.
  virtual void send([[maybe_unused]] Instant now, [[maybe_unused]] Reaction& reaction) {}
};

// A receiver that a silence on the line makes ready for the next frame. A derived on_character()
// begins with heard().
class GapReceiver : public Receiver {
 public:
  static constexpr Duration kStreamGap = std::chrono::milliseconds{100};  // parts arrive separately

  GapReceiver(const LineFormat& line, Duration gap) : character_(line.characters(1)), gap_(gap) {}
  [[nodiscard]] Instant silence_due() const override {
    return received_.empty() && !lost_ ? kNever : last_ + gap_;
  }
  void on_silence(Instant, Reaction&) override { ready(false); }

 protected:
  void heard(Instant end, Reaction& reaction) {
    if (silence_due() != kNever && end - character_ >= silence_due())
      on_silence(silence_due(), reaction);
    last_ = end;
  }
  // `lost`: ignores the line until a silence.
  void ready(bool lost) {
    received_.clear();
    lost_ = lost;
  }

  Bytes received_;
  bool lost_ = false;

 private:
  Duration character_, gap_;
  Instant last_ = kLongAgo;
};

class SimDevice {
 public:
  virtual ~SimDevice() = default;
  // REQUIRES: the device outlives the receiver.
  [[nodiscard]] virtual std::unique_ptr<Receiver> open_receiver() = 0;
  [[nodiscard]] virtual const DeviceStatistics& statistics() const = 0;
  // Access an item directly, right-aligned; fail for an unknown item. A poked item keeps its value.
  [[nodiscard]] virtual std::optional<std::uint64_t> peek([[maybe_unused]] std::string_view area,
                                                          [[maybe_unused]] std::uint32_t item,
                                                          [[maybe_unused]] Instant now) {
    return std::nullopt;
  }
  virtual bool poke([[maybe_unused]] std::string_view area, [[maybe_unused]] std::uint32_t item,
                    [[maybe_unused]] std::uint64_t bits) {
    return false;
  }
};

struct RefusedRange {
  std::string area;                // name in the protocol's DeviceKind
  std::uint32_t from = 0, to = 0;  // both included
  std::uint8_t code = 2;
};

struct DeviceSetup {
  DeviceSpec spec;
  LineFormat line;
  bool stream = false;        // TCP: parts of a frame may arrive separately
  bool first_on_bus = false;  // responds for the bus itself (unit 0 and 255 on Modbus TCP)
  std::vector<RefusedRange> refused;
  bool only_configured = false;    // only addresses of configured channels exist
  std::uint64_t seed = 1;          // for its waveforms
  Instant start{};                 // of the plant and its waveforms
  std::optional<unsigned> form{};  // see DeviceFaults
};

struct DeviceKind {
  std::string_view protocol;                // as in the configuration: "modbus-rtu"
  std::span<const std::string_view> areas;  // names for RefusedRange
  bool half_duplex = true;                  // overlapping transmissions garble each other
  tl::expected<std::unique_ptr<SimDevice>, std::string> (*make)(const DeviceSetup& setup) = nullptr;
};
[[nodiscard]] std::span<const DeviceKind> device_kinds();
[[nodiscard]] const DeviceKind* find_device_kind(std::string_view protocol);
[[nodiscard]] const DeviceKind* kind_of(const DeviceSpec& device);
[[nodiscard]] std::vector<std::string_view> area_names(const DeviceSpec& device);

// Digits of the simulated devices, independent of the bridge's codec. Header only.
// Accepts upper case only, as the standards define.
[[nodiscard]] inline std::optional<unsigned> digit_of(std::uint8_t character) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  const std::size_t at = kDigits.find(static_cast<char>(character));
  return at == std::string_view::npos ? std::nullopt
                                      : std::optional<unsigned>(static_cast<unsigned>(at));
}

// Parses all digits; empty if the column is empty, longer than 16 or has another character.
[[nodiscard]] inline std::optional<std::uint64_t> number_in(ByteView column, unsigned base = 16) {
  if (column.empty() || column.size() > 16) return std::nullopt;
  std::uint64_t number = 0;
  for (const std::uint8_t character : column) {
    const auto digit = digit_of(character);
    if (!digit || *digit >= base) return std::nullopt;
    number = number * base + *digit;
  }
  return number;
}
[[nodiscard]] inline std::optional<std::uint64_t> number_in(std::string_view text,
                                                            unsigned base = 10) {
  return number_in(ByteView(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()), base);
}

// Parses a number of an address: any count of digits, hexadecimal in both cases.
[[nodiscard]] inline std::optional<std::uint64_t> address_number(std::string_view text,
                                                                 int base = 10) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

inline void append_hex(Bytes& out, std::uint64_t number, unsigned digits) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  for (unsigned left = digits; left-- > 0;)
    out.push_back(static_cast<std::uint8_t>(kDigits[number >> 4 * left & 0x0Fu]));
}

// Parses pairs of digits; empty for an odd count or another character.
[[nodiscard]] inline std::optional<Bytes> bytes_in(ByteView pairs) {
  Bytes bytes;
  for (std::size_t i = 0; i < pairs.size(); i += 2) {
    const auto byte = i + 2 <= pairs.size() ? number_in(pairs.subspan(i, 2)) : std::nullopt;
    if (!byte) return std::nullopt;
    bytes.push_back(static_cast<std::uint8_t>(*byte));
  }
  return bytes;
}

}  // namespace fieldcast::sim
