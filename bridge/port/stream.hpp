// An open line, a terminal or a connected socket: sends, buffers unsent bytes, delivers received
// bytes, and leases the line to a programming session.
//
// Owns the descriptor. Lives on its bus's io thread. Pending handlers share ownership and do
// nothing after the end. Includes Asio; only for ports.
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
  void start();

  // See Port.
  void write(ByteView bytes);
  void poll();
  void close();
  [[nodiscard]] FileDescriptor lease();
  void end_lease();
  // Sleeps this long before the next wait for bytes. Applies until the next delivery.
  void sleep_for(Duration time) { sleep_ = time; }

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
  Readiness readiness_;
  boost::asio::steady_timer timer_;
  Unsent unsent_;
  Duration sleep_{};
  bool over_ = false;
  bool leased_ = false;
  bool waiting_ = false;
  std::array<std::uint8_t, 4096> buffer_;
};

}  // namespace fieldcast
