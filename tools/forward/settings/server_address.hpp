// The address of a NATS server as text. Pure.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace fieldcast::forward {

struct ServerAddress {
  bool tls = false;
  bool on_loopback = false;
};

// "nats://127.0.0.1:4222", "tls://nats.example:4222". Fails with what is wrong; the message does
// not repeat a login.
[[nodiscard]] tl::expected<ServerAddress, std::string> server_address_from(std::string_view text);

// "localhost", "127.0.0.1", "::1".
[[nodiscard]] bool is_loopback(const std::string& host);

}  // namespace fieldcast::forward
