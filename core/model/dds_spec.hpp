// How a program joins a DDS domain. Plain values.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fieldcast {

struct DdsSpec {
  std::uint32_t domain = 0;                          // 0..232
  std::vector<std::string> interfaces{"127.0.0.1"};  // IPv4 addresses for DDS
  // "host:port" of Fast DDS discovery servers with identities 0, 1 and so on; all participants list
  // all. Empty: multicast.
  std::vector<std::string> discovery_servers;
  // The user's Fast DDS XML file; its participant profile "fieldcast" is used.
  std::optional<std::string> profile;
  std::optional<std::string> partition;
  std::optional<std::string> security;  // a member's directory, created by `fieldcast secure add`
  bool without_security = false;        // explicitly configured
  std::uint64_t max_rate = 0;           // of outgoing samples, in bytes per second; 0: no limit
  // Limits: participants, endpoints of each, and bytes of a fragmented sample.
  std::uint32_t max_participants = 1024, max_endpoints = 8192, max_sample = 1 << 20;
  friend bool operator==(const DdsSpec&, const DdsSpec&) = default;
};

struct DdsSite {
  std::string name;  // prefix of its bus names: "north:line-7"; empty for the only site
  DdsSpec dds;
  friend bool operator==(const DdsSite&, const DdsSite&) = default;
};

}  // namespace fieldcast
