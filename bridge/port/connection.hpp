// A connected socket as a bus uses it, however it came to be: called (TcpPort) or dialled in
// (DialInPort). Lives on its bus's io thread. Includes Asio: for those two alone.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <memory>
#include <optional>

#include "bridge/port/port.hpp"
#include "bridge/port/unsent.hpp"

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

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  // The listener hears on_received and on_closed, nothing after close().
  Connection(boost::asio::ip::tcp::socket socket, PortListener& listener)
      : listener_(listener), socket_(std::move(socket)) {}

  [[nodiscard]] bool start();  // false: the socket is gone already
  void write(ByteView bytes);
  void poll();
  void close();
  // Closes without closing the socket, which goes on elsewhere; invalid when it is over or lent.
  [[nodiscard]] FileDescriptor release();
  [[nodiscard]] FileDescriptor lend();
  void take_back();
  void fail(std::string reason);

 private:
  void push(ByteView bytes);
  void listen();
  [[nodiscard]] bool take();
  void drop_stale();
  void wait_for_room();
  void fail_later(std::string reason);

  PortListener& listener_;
  boost::asio::ip::tcp::socket socket_;
  Unsent unsent_{Unsent::Kind::kSocket};
  bool over_ = false;  // handlers that still come do nothing
  bool lent_ = false;
  bool listening_ = false;  // a wait is under way
  std::array<std::uint8_t, 4096> buffer_;
};

}  // namespace fieldcast
