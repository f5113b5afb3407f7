// Bytes in both directions over a socket, TLS or a line's descriptor. On one io thread.
#pragma once

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <functional>
#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "bridge/base/file_descriptor.hpp"
#include "core/model/program_spec.hpp"

namespace boost::asio {
class io_context;
}

namespace fieldcast {

class ByteStream {
 public:
  using Done = std::function<void(boost::system::error_code fault, std::size_t count)>;

  virtual ~ByteStream() = default;
  // One read and one write at a time; the buffer must live until `done`.
  virtual void read_some(boost::asio::mutable_buffer into, Done done) = 0;
  virtual void write_some(boost::asio::const_buffer from, Done done) = 0;
  // Bytes that the peer or the line has not acknowledged; always 0 for a pseudo-terminal.
  [[nodiscard]] virtual std::size_t queued() const = 0;
  // Half-closes: a TCP peer reads the end of the stream and may still send.
  virtual void end_sending() {}
  virtual void close() = 0;  // pending operations fail
  // Returns the common name of the peer's verified certificate, or an empty string if it has none.
  [[nodiscard]] virtual std::string peer_name() const { return {}; }
};

// Bytes that the kernel has not sent, or the peer has not acknowledged. 0 if the system does not
// report it.
[[nodiscard]] std::size_t queued_at(int fd);

[[nodiscard]] std::unique_ptr<ByteStream> socket_stream(boost::asio::ip::tcp::socket socket);

// For a socket, a serial line or a pseudo-terminal, non-blocking. Null if it is not usable.
[[nodiscard]] std::unique_ptr<ByteStream> descriptor_stream(boost::asio::io_context& io,
                                                            FileDescriptor descriptor);

}  // namespace fieldcast

namespace fieldcast {

// A listening socket. Lives on one io thread. Includes Asio.
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
