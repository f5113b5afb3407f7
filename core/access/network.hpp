// An IP network, "10.0.0.0/8" or "fd00::/8", or one address, for access rules. Pure; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace fieldcast::access {

class Network {
 public:
  // Empty if the text is invalid or ambiguous: "10.0.0.7/8" may mean the host or the network.
  [[nodiscard]] static std::optional<Network> parse(std::string_view text);

  // Accepts brackets and a zone. ::ffff:10.0.0.7 counts as IPv4. Returns false if it is invalid.
  [[nodiscard]] bool contains(std::string_view address) const;

 private:
  std::array<std::uint8_t, 16> address_{};  // IPv4 as ::ffff:a.b.c.d
  unsigned prefix_ = 0;                     // bits, 0..128
};

// Key for limits per address. IPv6 becomes its /64, as a host can use all of it; IPv4-mapped
// becomes IPv4. Accepts brackets and a zone, and returns another text without them.
[[nodiscard]] std::string address_group(std::string_view address);

}  // namespace fieldcast::access
