// A connected socket as the line of a bus: an outgoing connection (TcpPort) or a dialled-in module
// (DialInPort). Lives on its bus's io thread.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <memory>
#include <optional>

#include "bridge/base/clock.hpp"
#include "bridge/port/stream.hpp"

namespace fieldcast {

// Sets keep-alive and no delay: a peer that vanished is detected within about 20 s, also if nothing
// is sent. `unacknowledged`: how long bytes may wait for the peer's acknowledgement.
inline constexpr Duration kUnacknowledged = std::chrono::seconds{10};
// For a server with one client: until this connection closes, no other bridge can serve the bus.
inline constexpr Duration kUnacknowledgedByOne = std::chrono::seconds{3};
void tune_socket(int fd, Duration unacknowledged = kUnacknowledged);

// Returns the socket as an Asio socket, or `std::nullopt` if it is no longer usable.
[[nodiscard]] std::optional<boost::asio::ip::tcp::socket> adopt_socket(boost::asio::io_context& io,
                                                                       FileDescriptor fd);

// Returns false if the peer has not acknowledged sent bytes for so long that it must be lost. A
// peer that acknowledges but has no window, because its line is slow, is present. Returns true for
// a descriptor that is not a TCP socket.
[[nodiscard]] bool peer_answers(int fd);

// Number of clients of the peer (`fence: one-client`). With kOne, it may accept a second connection
// and close it immediately, and must soon detect that its client has disconnected.
enum class Clients : std::uint8_t { kMany, kOne };

class SocketStream final : public Stream {
 public:
  // A connection that the peer closes within this time was never served.
  static constexpr Duration kAtOnce = std::chrono::seconds{1};

  SocketStream(boost::asio::io_context& io, PortListener& listener,
               Clients clients = Clients::kMany)
      : Stream(io, listener, Unsent::Kind::kSocket), clients_(clients), began_(steady_now()) {}
  ~SocketStream() override { close(); }

 private:
  std::optional<End> restore(int fd) override;
  End end_of(int error) const override;
  void before_close(int) override {}

  const Clients clients_;
  const Instant began_;
};

// Returns null if the socket is no longer usable.
[[nodiscard]] std::shared_ptr<SocketStream> make_socket_stream(boost::asio::io_context& io,
                                                               FileDescriptor socket,
                                                               PortListener& listener,
                                                               Clients clients = Clients::kMany);

}  // namespace fieldcast
