#include "core/protocol/dtc/types.hpp"

#include <algorithm>
#include <string>

#include "core/base/near_miss.hpp"
#include "core/protocol/address_text.hpp"

namespace fieldcast::dtc {
namespace {

constexpr std::string_view kAllowed =
    "bit:N, int16:N, int32:N, float32:N, float64:N with N 0..65535, or int16:N.BIT, int32:N.BIT "
    "for a bit of an integer";

using Parsed = tl::expected<ParsedAddress, AddressFault>;

Parsed fault(std::string what, std::string suggestion = {}) {
  return tl::unexpected(
      AddressFault{std::move(what), std::string(kAllowed), std::move(suggestion)});
}
}  // namespace

Parsed parse_address(std::string_view at) {
  const std::size_t colon = at.find(':');
  const std::string_view name = at.substr(0, colon);
  const auto found = std::ranges::find(kTypeNames, name);
  if (colon == std::string_view::npos || found == kTypeNames.end()) {
    const std::string_view near = near_miss(name, kTypeNames);
    const std::string rest(colon == std::string_view::npos ? ":0" : at.substr(colon));
    return fault("type " + quoted(name) + " is unknown",
                 near.empty() || rest.size() > 16 ? "" : std::string(near) + rest);
  }
  ParsedAddress address{.area = static_cast<AreaIndex>(found - kTypeNames.begin())};
  const unsigned bits = kTypeBits[address.area];
  const std::string_view number = at.substr(colon + 1);
  const std::size_t dot = number.find('.');
  const auto first = whole_number(number.substr(0, dot));
  if (!first)
    return fault(quoted(number.substr(0, dot)) + " is no number", std::string(name) + ":0");
  if (*first >= kVariables)
    return fault(quoted(at) + " is beyond the end of " + std::string(name),
                 std::string(name) + ":65535");
  address.first = *first;
  if (dot == std::string_view::npos) {
    // Floating-point numbers are whole; a value may consist of several integers.
    if (address.area == kBit || address.area == kFloat32 || address.area == kFloat64)
      address.width_bits = bits;
    return address;
  }
  const std::string whole(at.substr(0, colon + 1 + dot));
  if (address.area != kInt16 && address.area != kInt32)
    return fault(quoted(at) + " has no bits", whole);
  const auto bit = whole_number(number.substr(dot + 1));
  if (!bit || *bit >= bits) {
    return fault("bit " + quoted(number.substr(dot + 1)) + " is not 0.." + std::to_string(bits - 1),
                 whole + ".0");
  }
  address.bit = static_cast<std::uint8_t>(*bit);
  address.width_bits = 1;
  return address;
}

}  // namespace fieldcast::dtc
