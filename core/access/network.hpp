// An IP network, "10.0.0.0/8", "fd00::/8", or one address: who may connect. Pure; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace fieldcast::access {

class Network {
 public:
  // Nothing: this is no address, the prefix is too long, or bits behind it are set
  // ("10.0.0.7/8": nobody knows whether the host or the network was meant).
  [[nodiscard]] static std::optional<Network> parse(std::string_view text);

  // `address` as text; one with brackets, "[fd00::7]", and one with a zone too. An IPv4 address
  // that came to an IPv6 socket (::ffff:10.0.0.7) is that IPv4 address. False for what is no
  // address.
  [[nodiscard]] bool contains(std::string_view address) const;

 private:
  std::array<std::uint8_t, 16> address_{};  // IPv4 as ::ffff:a.b.c.d
  unsigned prefix_ = 0;                     // bits, 0..128
};

}  // namespace fieldcast::access
