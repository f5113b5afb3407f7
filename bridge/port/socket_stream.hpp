// A connected socket as a bus uses it, however it came to be: called (TcpPort) or dialled in
// (DialInPort). Lives on its bus's io thread.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <memory>
#include <optional>

#include "bridge/bus/clock.hpp"
#include "bridge/port/stream.hpp"

namespace fieldcast {

// Keep-alive and no delay: a peer that vanished without a word is noticed within about 20 s even
// when nothing is sent. `unacknowledged`: how long bytes may wait for a peer that takes none.
inline constexpr Duration kUnacknowledged = std::chrono::seconds{10};
// To a server with one client: while this end holds on, no other bridge can serve the bus.
inline constexpr Duration kUnacknowledgedByOne = std::chrono::seconds{3};
void tune_socket(int fd, Duration unacknowledged = kUnacknowledged);

// A connected socket as Asio's; nothing when it is of no use any more.
[[nodiscard]] std::optional<boost::asio::ip::tcp::socket> adopt_socket(boost::asio::io_context& io,
                                                                       FileDescriptor fd);

// False: the peer of this socket leaves what is sent unanswered for so long that it is gone. A peer
// that answers but takes no bytes, since its line is slow, is there. True for what is no TCP
// socket.
[[nodiscard]] bool peer_answers(int fd);

// How many clients the peer takes (`fence: one-client`). One that has its client may accept another
// connection and close it at once; and it should learn soon that its client is gone.
enum class Clients : std::uint8_t { kMany, kOne };

class SocketStream final : public Stream {
 public:
  // Closed by the peer so soon after it was opened, it was never served.
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

// A connected socket as a stream; null when it is of no use any more.
[[nodiscard]] std::shared_ptr<SocketStream> make_socket_stream(boost::asio::io_context& io,
                                                               FileDescriptor socket,
                                                               PortListener& listener,
                                                               Clients clients = Clients::kMany);

}  // namespace fieldcast
