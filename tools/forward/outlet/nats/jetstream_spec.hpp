// How a forwarder reaches NATS JetStream. A plain value.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast::forward {

// The streams that the forwarder creates if they are missing. It changes none.
struct StreamSpec {
  bool create = false;
  std::uint32_t replicas = 1;
  Duration keep{};                                 // age of a message; 0: no limit
  Duration duplicates = std::chrono::minutes{10};  // how long the server remembers message ids
  friend bool operator==(const StreamSpec&, const StreamSpec&) = default;
};

struct JetStreamSpec {
  std::vector<std::string> servers{"nats://127.0.0.1:4222"};
  std::string authority;  // PEM file that signed the server's certificate; empty: the system's
  std::string certificate, key;  // PEM files of this client
  std::string user;              // with the password in password_file
  std::string password_file, token_file;
  std::string credentials;   // file with a JWT and the seed of its key, as `nsc` makes it
  bool without_tls = false;  // plain text off the loopback, explicitly configured
  Duration acknowledgement = std::chrono::seconds{5};  // then a message is sent again
  std::string sample_stream = "FIELDCAST", alarm_stream = "FIELDCAST_ALARMS";
  std::string audit_stream = "FIELDCAST_AUDIT";
  std::string bucket = "fieldcast-catalogue";
  std::string site_bucket = "fieldcast-sites";
  StreamSpec streams;
  friend bool operator==(const JetStreamSpec&, const JetStreamSpec&) = default;
};

// True if the scheme of the server is tls.
[[nodiscard]] inline bool uses_tls(const JetStreamSpec& spec) {
  for (const std::string& server : spec.servers) {
    if (server.starts_with("tls://")) return true;
  }
  return false;
}

}  // namespace fieldcast::forward
