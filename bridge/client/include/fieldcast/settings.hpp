/// @file
/// How a station joins DDS domains. Plain values; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace fieldcast::api {
inline namespace v1 {

struct Domain {
  /// Before the names of buses, if a station joins several domains: "north". Empty for one domain.
  std::string name;
  std::uint32_t domain = 0;                          ///< 0..232
  std::vector<std::string> interfaces{"127.0.0.1"};  ///< IPv4 addresses that DDS may use
  /// "host:port" of Fast DDS discovery servers. Empty: multicast.
  std::vector<std::string> discovery_servers;
  std::optional<std::string> profile;  ///< an XML file of Fast DDS with a profile "fieldcast"
  std::optional<std::string> partition;
  std::optional<std::string> security;  ///< a member's folder, made by `fieldcast secure add`
};

/// A domain cannot be joined: an interface does not exist, a file cannot be read, a certificate has
/// expired. what() names the cause and the domain.
class JoinError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace v1
}  // namespace fieldcast::api
