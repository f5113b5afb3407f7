// A listening socket. Lives on one io thread. Includes Asio.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <functional>
#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "core/model/program_spec.hpp"

namespace fieldcast {

class Listener {
 public:
  // `come` is called with each connection, until close().
  Listener(boost::asio::io_context& io, std::function<void(boost::asio::ip::tcp::socket)> come);
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  // The error is one line: "cannot listen at 127.0.0.1:4950: Address already in use".
  [[nodiscard]] tl::expected<void, std::string> open(const ListenSpec& spec);
  [[nodiscard]] std::uint16_t port() const;  // REQUIRES: open
  void close();

 private:
  struct State;
  std::shared_ptr<State> state_;  // shared with pending handlers
};

// Returns the peer's address, for example "10.0.0.7:51234", or "?" if it has disconnected.
[[nodiscard]] std::string address_of(const boost::asio::ip::tcp::socket& socket);
[[nodiscard]] inline std::string host_of(const std::string& address) {
  return address.substr(0, address.rfind(':'));
}

}  // namespace fieldcast
