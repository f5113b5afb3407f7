// How a forwarder reaches a server by HTTP. A plain value.
#pragma once

#include <string>

#include "core/base/time.hpp"

namespace fieldcast::forward {

struct HttpSpec {
  std::string server;     // "https://HOST:PORT", also followed by "/PATH"
  std::string authority;  // PEM file that signed the server's certificate; empty: the system's
  std::string certificate, key;     // PEM files of this client
  std::string user, password_file;  // basic authentication
  std::string token_file;           // a token in the header
  bool without_tls = false;         // plain text off the loopback, explicitly configured
  Duration acknowledgement = std::chrono::seconds{10};  // of one request; then it is repeated
  friend bool operator==(const HttpSpec&, const HttpSpec&) = default;
};

}  // namespace fieldcast::forward
