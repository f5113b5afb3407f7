// An open line, a terminal or a connected socket: sends, buffers, delivers received bytes, and
// leases the line. Owns the descriptor. On its bus's io thread; pending handlers share ownership
// and do nothing after the end. Includes Asio; only for ports.
#pragma once

#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <optional>
#include <string>

#include "bridge/base/clock.hpp"
#include "bridge/net/tls_engine.hpp"
#include "bridge/port/device_watch.hpp"
#include "bridge/port/port.hpp"

namespace fieldcast {

class Stream : public std::enable_shared_from_this<Stream> {
 public:
  struct End {
    std::string reason;  // one human-readable line
    Cause cause = Cause::kPortClosed;
  };

  // The listener gets on_received and on_closed, nothing after close().
  Stream(boost::asio::io_context& io, PortListener& listener, Unsent::Kind kind);
  virtual ~Stream() = default;
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  // Takes over a non-blocking descriptor, once. Returns false if it is not usable.
  [[nodiscard]] bool assign(FileDescriptor descriptor);
  // From now on the socket carries TLS, after its handshake. Such a line cannot be leased.
  void use(std::unique_ptr<TlsEngine> tls) { tls_ = std::move(tls); }
  void start();

  // See Port.
  void write(ByteView bytes);
  void write_more(ByteView bytes);
  void poll();
  void close();
  [[nodiscard]] FileDescriptor lease();
  void end_lease();
  [[nodiscard]] bool wait(Instant until, int wake);
  void watch();
  // Sleeps this long before the next wait for bytes. Applies until the next delivery or write().
  void sleep_for(Duration time) {
    sleep_ = time;
    sleep_until_ = steady_now() + time;
  }

  // Ends the stream and returns the open descriptor. Invalid if the stream has ended or is leased.
  [[nodiscard]] FileDescriptor release();
  // Closes and notifies the listener.
  void fail(End end);
  // Released when the descriptor is closed. After release(), detach() returns it for the new owner.
  void attach(std::shared_ptr<void> companion) { companion_ = std::move(companion); }
  [[nodiscard]] std::shared_ptr<void> detach() { return std::move(companion_); }

 protected:
  // Restores the settings after a lease. Returns the reason if the line is no longer usable.
  [[nodiscard]] virtual std::optional<End> restore(int fd) = 0;
  // Returns the reason for a read without bytes. `error` is errno, or 0 at the end of the stream.
  [[nodiscard]] virtual End end_of(int error) const = 0;
  virtual void before_close(int fd) = 0;
  // Before a write that is a request, and before a lease.
  virtual void before_write(int) {}
  // Before bytes are read outside of a wait: moves those that have arrived to the descriptor. Must
  // not call the listener.
  virtual void fetch() {}
  // After received bytes, and what was sent because of them.
  virtual void acknowledge(int) {}
  // False while a timer of the io_context must be exact.
  [[nodiscard]] virtual bool can_wait() const { return true; }
  // Each read is a datagram, which may be empty.
  [[nodiscard]] virtual bool datagrams() const { return false; }

  [[nodiscard]] int fd() const { return descriptor_.get(); }
  [[nodiscard]] bool usable() const { return !over_ && !leased_ && descriptor_.valid(); }
  void fail_later(End end);

 private:
  void push(ByteView bytes);
  void push_raw(ByteView bytes);
  [[nodiscard]] bool decrypt(ByteView bytes, Bytes& plain);
  void wait_for_bytes();
  void on_readable();
  [[nodiscard]] bool take();
  void sleep();
  void drop_stale();
  void wait_for_space();

  PortListener& listener_;
  FileDescriptor descriptor_;
  std::shared_ptr<void> companion_;
  std::unique_ptr<TlsEngine> tls_;  // null: the bytes of the socket are those of the line
  Readiness readiness_;
  boost::asio::steady_timer timer_;
  Unsent unsent_;
  Duration sleep_{};
  Instant sleep_until_{};
  Instant empty_at_ = kLongAgo;  // wait() found no bytes
  bool decrypted_ = false;       // any byte of the line, by TLS
  bool over_ = false;
  bool leased_ = false;
  bool waiting_ = false;   // for the io_context
  bool attended_ = false;  // by wait(), since the last watch()
  std::array<std::uint8_t, 4096> buffer_;
};

// A connected socket as the line of a bus (TcpPort, DialInPort). On its bus's io thread.

// A vanished peer is detected within 20 s. `unacknowledged`: how long bytes may wait for it.
inline constexpr Duration kUnacknowledged = std::chrono::seconds{10};
// For a server with one client: until this connection closes, no other bridge can serve the bus.
inline constexpr Duration kUnacknowledgedByOne = std::chrono::seconds{3};
void tune_socket(int fd, Duration unacknowledged = kUnacknowledged);

// A peer with Nagle's algorithm sends the next part only after the last one was acknowledged, which
// the kernel may delay by 40 ms.
void acknowledge_now(int fd);

// Returns the socket as an Asio socket, or `std::nullopt` if it is no longer usable.
[[nodiscard]] std::optional<boost::asio::ip::tcp::socket> adopt_socket(boost::asio::io_context& io,
                                                                       FileDescriptor fd);

// Returns false if the peer has not acknowledged sent bytes for too long. A peer without a window,
// because its line is slow, is present. True for other descriptors.
[[nodiscard]] bool peer_responds(int fd);

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
  void acknowledge(int fd) override { acknowledge_now(fd); }

  const Clients clients_;
  const Instant began_;
};

// A connected UDP socket: datagrams of other senders are not received.
class DatagramStream final : public Stream {
 public:
  DatagramStream(boost::asio::io_context& io, PortListener& listener)
      : Stream(io, listener, Unsent::Kind::kSocket) {}
  ~DatagramStream() override { close(); }

 private:
  std::optional<End> restore(int) override { return std::nullopt; }
  End end_of(int error) const override;
  void before_close(int) override {}
  [[nodiscard]] bool datagrams() const override { return true; }
};

// Returns null if the socket is no longer usable.
[[nodiscard]] std::shared_ptr<SocketStream> make_socket_stream(boost::asio::io_context& io,
                                                               FileDescriptor socket,
                                                               PortListener& listener,
                                                               Clients clients = Clients::kMany);

}  // namespace fieldcast
