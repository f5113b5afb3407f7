// A protocol with the sizes of Modbus RTU but without frames, and with special areas.
#pragma once

#include <array>

#include "core/protocol/protocol.hpp"

namespace fieldcast::test {

inline constexpr AreaIndex kRegisters = 0, kBits = 1, kBytewise = 2, kWindow = 3;

class FakeProtocol : public Protocol {
 public:
  [[nodiscard]] const Traits& traits() const override { return traits_; }
  [[nodiscard]] std::span<const Area> areas() const override { return areas_; }
  [[nodiscard]] tl::expected<ParsedAddress, AddressFault> parse_address(
      std::string_view) const override {
    return tl::unexpected(AddressFault{});
  }
  [[nodiscard]] std::optional<ExchangeSize> size(const Request& request) const override {
    const auto* read = std::get_if<ReadRequest>(&request);
    if (read == nullptr || read->ranges.size() != 1) return std::nullopt;
    const Range& range = read->ranges.front();
    const Area& area = areas_[range.area];
    if (range.count == 0 || range.count > area.max_read || range.end() > area.items)
      return std::nullopt;
    return ExchangeSize{
        8, 5 + (area.item_bits == 16 ? 2 * range.count : (range.count * area.item_bits + 7) / 8)};
  }
  [[nodiscard]] std::unique_ptr<Exchange> begin(Request, ExchangeContext) const override {
    return nullptr;
  }

 private:
  Traits traits_{"fake", "sizes only"};
  std::array<Area, 4> areas_{Area{.name = "register"},
                             Area{.name = "bit", .item_bits = 1, .max_read = 2000},
                             Area{.name = "bytewise",
                                  .item_bits = 1,
                                  .items = 1024,
                                  .max_read = 512,
                                  .max_write = 0,
                                  .alignment = 8},
                             Area{.name = "window",
                                  .item_bits = 8,
                                  .items = 64,
                                  .max_read = 64,
                                  .max_write = 0,
                                  .window = true}};
};

inline const FakeProtocol kFakeProtocol;

}  // namespace fieldcast::test
