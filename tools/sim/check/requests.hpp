// Requests that show what a protocol can do: for every area small and large reads and writes, for
// records their places.
#pragma once

#include <optional>
#include <random>
#include <string>
#include <vector>

#include "tools/sim/check/exchange_run.hpp"

namespace fieldcast::sim {

// A run of items that is read, and perhaps written, as one.
struct Slot {
  Range range;
  unsigned item_bits = 16;
  // Of a record's place: bits of all items together, right-aligned (0: all that they have), which
  // a sign may fill; the largest number that its digits can say; or the bytes of a text, and a
  // character that ends it.
  unsigned value_bits = 0;
  bool is_signed = false;
  std::uint64_t largest = UINT64_MAX;
  std::uint16_t text_bytes = 0;
  std::uint8_t end_of_text = 0;
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
  // Where `count` items of an area are tried: its beginning, its middle, its end, as far as they
  // can be read at all.
  [[nodiscard]] std::vector<Slot> slots(AreaIndex area, std::uint32_t count) const;
  [[nodiscard]] std::optional<Range> largest_read(AreaIndex area) const;
  [[nodiscard]] std::optional<Range> largest_write(AreaIndex area) const;
  [[nodiscard]] bool allows(const Request& request) const {
    return protocol_->size(request).has_value();
  }
  // Requests of every kind that the protocol has, for every area: to be disturbed.
  [[nodiscard]] std::vector<NamedRequest> examples() const;
  [[nodiscard]] std::vector<Slot> places(AreaIndex area) const;  // of a record

  // Random contents of a slot, as the image of its items.
  [[nodiscard]] static Bytes contents(const Slot& slot, std::mt19937& random);
  // Puts them into the device past the wire; false: it has no such items.
  static bool poke(SimDevice& device, std::string_view area, const Slot& slot, ByteView image);
  [[nodiscard]] static std::optional<Bytes> peek(SimDevice& device, std::string_view area,
                                                 const Slot& slot, Instant now);

 private:
  const Subject& subject_;
  std::unique_ptr<Protocol> protocol_;
};

}  // namespace fieldcast::sim
