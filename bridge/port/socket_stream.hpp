// A connected socket as a bus uses it, however it came to be: called (TcpPort) or dialled in
// (DialInPort). Lives on its bus's io thread.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <memory>
#include <optional>

#include "bridge/port/stream.hpp"

namespace fieldcast {

// Keep-alive and no delay: a peer that vanished without a word is noticed within about 20 s even
// when nothing is sent. `unacknowledged`: how long bytes may wait for a peer that takes none.
inline constexpr Duration kUnacknowledged = std::chrono::seconds{10};
void tune_socket(int fd, Duration unacknowledged = kUnacknowledged);

// A connected socket as Asio's; nothing when it is of no use any more.
[[nodiscard]] std::optional<boost::asio::ip::tcp::socket> adopt_socket(boost::asio::io_context& io,
                                                                       FileDescriptor fd);

// False: the peer of this socket leaves what is sent unanswered for so long that it is gone. A peer
// that answers but takes no bytes, since its line is slow, is there. True for what is no TCP
// socket.
[[nodiscard]] bool peer_answers(int fd);

class SocketStream final : public Stream {
 public:
  SocketStream(boost::asio::io_context& io, PortListener& listener)
      : Stream(io, listener, Unsent::Kind::kSocket) {}
  ~SocketStream() override { close(); }

 private:
  std::optional<End> restore(int fd) override;
  End end_of(int error) const override;
  void before_close(int) override {}
};

// A connected socket as a stream; null when it is of no use any more.
[[nodiscard]] std::shared_ptr<SocketStream> make_socket_stream(boost::asio::io_context& io,
                                                               FileDescriptor socket,
                                                               PortListener& listener);

}  // namespace fieldcast
