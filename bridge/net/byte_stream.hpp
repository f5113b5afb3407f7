// Bytes both ways over a socket, a TLS connection or a descriptor of a line: what a relay needs of
// any of them, and an HTTP session. Lives on one io thread. Includes Asio.
#pragma once

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <functional>
#include <memory>
#include <string>

#include "bridge/base/file_descriptor.hpp"

namespace boost::asio {
class io_context;
}

namespace fieldcast {

class ByteStream {
 public:
  using Done = std::function<void(boost::system::error_code fault, std::size_t count)>;

  virtual ~ByteStream() = default;
  // One read and one write at a time; the buffer lives until `done`.
  virtual void read_some(boost::asio::mutable_buffer into, Done done) = 0;
  virtual void write_some(boost::asio::const_buffer from, Done done) = 0;
  // Bytes that the kernel has taken and not delivered: the peer's kernel has not acknowledged them,
  // or the line has not shifted them out. Always 0 for a pseudo-terminal.
  [[nodiscard]] virtual std::size_t queued() const = 0;
  // Nothing more is sent: a TCP peer reads the end of the stream. It may still send.
  virtual void end_sending() {}
  virtual void close() = 0;  // what is under way ends in an error
  // The common name of the certificate that the peer has proven to own; empty: it showed none.
  [[nodiscard]] virtual std::string peer_name() const { return {}; }
};

// ByteStream::queued() of a descriptor.
[[nodiscard]] std::size_t queued_at(int fd);

[[nodiscard]] std::unique_ptr<ByteStream> socket_stream(boost::asio::ip::tcp::socket socket);

// A socket, a serial line or a pseudo-terminal, non-blocking. Null when the descriptor is of no
// use.
[[nodiscard]] std::unique_ptr<ByteStream> descriptor_stream(boost::asio::io_context& io,
                                                            FileDescriptor descriptor);

}  // namespace fieldcast
