#pragma once

#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/protocol/declared/scaled.hpp"
#include "tools/sim/check/exchange_run.hpp"

namespace fieldcast::sim {

struct Slot {
  Range range;
  unsigned item_bits = 16;
  // For record places: bits of all items (0: all) and sign; largest number of its digits; or the
  // bytes of a text and its end character.
  unsigned value_bits = 0;
  bool is_signed = false;
  std::uint64_t largest = UINT64_MAX;
  bool by_item = false;  // these limits apply to each item
  bool counts = false;   // the first item counts the others
  std::uint16_t text_bytes = 0;
  std::uint8_t end_of_text = 0;
  // Of a scaled value: the exponents that are tried, and whether it can be negative. `largest` is
  // that of its digits.
  std::optional<declared::ExponentRange> exponents{};
  bool negative = false;
};

struct NamedRequest {
  std::string name;  // "read holding 3"
  Request request;
};

class Requests {
 public:
  explicit Requests(const Subject& subject);

  [[nodiscard]] const Protocol& protocol() const { return *protocol_; }
  [[nodiscard]] std::string_view area_name(AreaIndex area) const {
    return protocol_->areas()[area].name;
  }
  // Returns readable ranges of `count` items at the start, middle and end of an area.
  [[nodiscard]] std::vector<Slot> slots(AreaIndex area, std::uint32_t count) const;
  [[nodiscard]] std::optional<Range> largest_read(AreaIndex area) const;
  [[nodiscard]] std::optional<Range> largest_write(AreaIndex area) const;
  [[nodiscard]] bool allows(const Request& request) const {
    return protocol_->size(request).has_value();
  }
  [[nodiscard]] std::vector<NamedRequest> examples() const;
  [[nodiscard]] std::vector<Slot> places(AreaIndex area) const;  // of a record

  // The range with the limits of declared digits.
  [[nodiscard]] Slot slot(const Range& range) const;
  [[nodiscard]] static bool holds(const Slot& slot, ByteView image);
  [[nodiscard]] static Bytes contents(const Slot& slot, std::mt19937& random);
  // Writes the image to the device without the wire. Returns false if it has no such items.
  static bool poke(SimDevice& device, std::string_view area, const Slot& slot, ByteView image);
  [[nodiscard]] static std::optional<Bytes> peek(SimDevice& device, std::string_view area,
                                                 const Slot& slot, Instant now);

 private:
  const Subject& subject_;
  std::unique_ptr<Protocol> protocol_;
};

// Whether a frame with a valid check begins in the noise before a response of a declaration: no
// master can distinguish it from a response.
[[nodiscard]] bool frame_begins_in(const Subject& subject, ByteView bytes, std::size_t noise);

// All notations of an address. The simulated device must accept what the bridge accepts.
// Returns at least one address of each form; for a declaration, of its areas and records.
[[nodiscard]] std::vector<std::string> notations_of(const Subject& subject);

// Default type: bool for a bit, an unsigned number of its width, or a declared text.
[[nodiscard]] Encoding natural_encoding(const ParsedAddress& address, const Area& area,
                                        const declared::Declaration* declaration);

}  // namespace fieldcast::sim
