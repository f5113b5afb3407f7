// Bytes both ways over a socket, a TLS connection or a descriptor of a line: what a relay needs of
// any of them. Lives on one io thread. Includes Asio: for this folder and fieldcast-port.
#pragma once

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <functional>
#include <memory>

#include "bridge/base/file_descriptor.hpp"
#include "core/base/time.hpp"

namespace boost::asio {
class io_context;
}

namespace fieldcast::program {

// How long the kernel waits for the peer of a relay that takes no bytes just now: with a slow line
// behind it, a peer opens the TCP window in steps. Engineer gives up a peer that takes none at all.
inline constexpr Duration kTunnelPatience = std::chrono::seconds{90};

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
  virtual void close() = 0;  // what is under way ends in an error
};

// ByteStream::queued() of a descriptor.
[[nodiscard]] std::size_t queued_at(int fd);

[[nodiscard]] std::unique_ptr<ByteStream> socket_stream(boost::asio::ip::tcp::socket socket);

// A socket, a serial line or a pseudo-terminal, non-blocking. Null when the descriptor is of no
// use.
[[nodiscard]] std::unique_ptr<ByteStream> descriptor_stream(boost::asio::io_context& io,
                                                            FileDescriptor descriptor);

}  // namespace fieldcast::program
