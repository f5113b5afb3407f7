// Interface to a line: sends bytes and delivers received bytes with their arrival times. A Port
// lives on the io thread of its BusRunner. To add a kind, add one class and one line in
// make_port.cpp.
#pragma once

#include <sys/types.h>

#include <functional>
#include <memory>
#include <string>

#include "bridge/base/file_descriptor.hpp"
#include "core/base/bytes.hpp"
#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/model/bus_spec.hpp"
#include "core/telnet/com_port.hpp"

namespace boost::asio {
class io_context;
}

namespace fieldcast {

// Callbacks of a port. They are called inside poll() or by the io thread itself, never inside
// open(), write() or close(), and not after close() has returned.
class PortListener {
 public:
  virtual ~PortListener() = default;
  virtual void on_opened() = 0;
  // `arrival` was read right after the bytes left the kernel. The bytes are valid during the call.
  virtual void on_received(ByteView bytes, Instant arrival) = 0;
  // The port could not be opened or was lost. `reason`: one line; `cause`: one of the kPort causes.
  virtual void on_closed(std::string reason, Cause cause) = 0;
};

class Port {
 public:
  virtual ~Port() = default;
  // Ends in one on_opened or on_closed. REQUIRES: not open. The listener must live until close().
  virtual void open(PortListener& listener) = 0;
  // Sends all bytes; drops received bytes that were not delivered, so that none is parsed as the
  // response. No effect if not open. Closes if more than kMaxUnsent bytes wait for a blocked line.
  virtual void write(ByteView bytes) = 0;
  // The same, but received bytes are delivered: responses to earlier requests may be among them.
  virtual void write_more(ByteView bytes) = 0;
  // Call after write(): behind its `characters` the line has this baud rate, until the next
  // write(). REQUIRES: the loader allows the port such protocols.
  virtual void receive_at([[maybe_unused]] std::uint32_t baud,
                          [[maybe_unused]] std::size_t characters) {}
  // A hint after write() or on_received(): bytes need no delivery before this time.
  virtual void sleep_until([[maybe_unused]] Instant until) {}
  // Delivers arrived bytes. Call before a timeout is handled, as the process may have been delayed.
  virtual void poll() = 0;
  // Waits for bytes on the calling thread, until `until` or until `wake` is readable, and delivers
  // those that arrive. This needs fewer system calls than a wait by the io_context, which does not
  // watch the line until watch() is called. Returns false, without a wait, if that is not possible.
  [[nodiscard]] virtual bool wait([[maybe_unused]] Instant until, [[maybe_unused]] int wake) {
    return false;
  }
  virtual void watch() {}
  virtual void close() = 0;
  // The bus ends: close(), but a dialled-in module stays connected for the next bus.
  virtual void retire() { close(); }

  // Leases the line: returns a second, non-blocking descriptor for another thread; invalid if not
  // open. Until end_lease(), nothing is delivered and write() must not be called.
  [[nodiscard]] virtual FileDescriptor lease() = 0;
  // Restores the configured settings and drops bytes received meanwhile. No effect unless leased.
  virtual void end_lease() = 0;
  // Of a leased line whose settings a server has. `done` is called once, perhaps inside the call.
  virtual void change_line([[maybe_unused]] const telnet::LineChange& change,
                           const telnet::LineChangeDone& done) {
    done({});
  }

  static constexpr std::size_t kMaxUnsent = 4096;
};

class DialInRegistry;

// `modules` outlives the port; required for a dial-in port.
[[nodiscard]] std::unique_ptr<Port> make_port(boost::asio::io_context& io, const PortSpec& spec,
                                              DialInRegistry* modules = nullptr);

}  // namespace fieldcast

namespace fieldcast {

// Writes to a non-blocking descriptor, usually with one system call, and buffers the rest.
class Unsent {
 public:
  enum class Kind { kTerminal, kSocket };
  enum class Outcome { kAllSent, kBlocked, kFailed, kFull };

  explicit Unsent(Kind kind) : kind_(kind) {}

  // Appends bytes and writes as many as the descriptor accepts. kBlocked: call again without bytes
  // when writable. kFailed: see errno. kFull: more than Port::kMaxUnsent bytes would wait.
  Outcome write(int fd, ByteView bytes);
  [[nodiscard]] bool empty() const { return rest_.empty(); }

 private:
  [[nodiscard]] ssize_t write_some(int fd, ByteView bytes) const;

  Kind kind_;
  Bytes rest_;
};

}  // namespace fieldcast
