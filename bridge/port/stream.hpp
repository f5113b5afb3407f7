// An open line as a stream of bytes, whether a terminal or a connected socket: sends, keeps what
// the line does not take yet, delivers what arrives, and leases itself to a programming session.
//
// Owns the descriptor. Lives on its bus's io thread; shared with the handlers under way, which do
// nothing once it is over. Includes Asio: for the ports alone.
#pragma once

#include <array>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <string>

#include "bridge/port/port.hpp"
#include "bridge/port/readiness.hpp"
#include "bridge/port/unsent.hpp"

namespace fieldcast {

class Stream : public std::enable_shared_from_this<Stream> {
 public:
  // Why a line is gone.
  struct End {
    std::string reason;  // one line for people
    Cause cause = Cause::kPortClosed;
  };

  // The listener gets on_received and on_closed, nothing after close().
  Stream(boost::asio::io_context& io, PortListener& listener, Unsent::Kind kind);
  virtual ~Stream() = default;
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  // Takes over a non-blocking descriptor, once; false when it is of no use.
  [[nodiscard]] bool assign(FileDescriptor descriptor);
  // Delivers what arrives from now on.
  void start();

  // As those of Port.
  void write(ByteView bytes);
  void poll();
  void close();
  [[nodiscard]] FileDescriptor lease();
  void end_lease();
  // Sleeps so long before it waits for more, instead of waking for each byte. Holds until the next
  // bytes were delivered.
  void sleep_for(Duration time) { sleep_ = time; }

  // Closes without closing the descriptor, which goes on elsewhere; invalid when the stream is over
  // or leased.
  [[nodiscard]] FileDescriptor release();
  // Closes and tells the listener.
  void fail(End end);
  // Let go when the descriptor is closed; detach() after release(), for whoever has it then.
  void attach(std::shared_ptr<void> companion) { companion_ = std::move(companion); }
  [[nodiscard]] std::shared_ptr<void> detach() { return std::move(companion_); }

 protected:
  // Sets the line up again after a lease; nothing, or why it is of no use any more.
  [[nodiscard]] virtual std::optional<End> restore(int fd) = 0;
  // What a read that gave no bytes means: `error` is errno, 0 at the end of the stream.
  [[nodiscard]] virtual End end_of(int error) const = 0;
  // Before the descriptor is closed.
  virtual void before_close(int fd) = 0;

 private:
  [[nodiscard]] int fd() const { return descriptor_.get(); }
  [[nodiscard]] bool usable() const { return !over_ && !leased_ && descriptor_.valid(); }
  void push(ByteView bytes);
  void wait_for_bytes();
  void on_readable();
  [[nodiscard]] bool take();
  void sleep();
  void drop_stale();
  void wait_for_space();
  void fail_later(End end);

  PortListener& listener_;
  FileDescriptor descriptor_;
  std::shared_ptr<void> companion_;
  Readiness readiness_;  // of the descriptor
  boost::asio::steady_timer timer_;
  Unsent unsent_;
  Duration sleep_{};
  bool over_ = false;
  bool leased_ = false;
  bool waiting_ = false;  // for bytes
  std::array<std::uint8_t, 4096> buffer_;
};

}  // namespace fieldcast
