// How a bus is reached: bytes out, bytes in with the instant of their arrival. The one interface
// between Fieldcast and a line.
//
// A Port belongs to one BusRunner and lives on that runner's io thread; every call and every
// callback happens there. Adding a kind of port is one class and one line in make_port.cpp.
#pragma once

#include <memory>
#include <string>

#include "bridge/base/file_descriptor.hpp"
#include "core/base/bytes.hpp"
#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/model/spec.hpp"

namespace boost::asio {
class io_context;
}

namespace fieldcast {

// Told by a port. Callbacks come from inside poll() or from the io thread itself, never from inside
// open(), write() or close(), and none comes after close() returned.
class PortListener {
 public:
  virtual ~PortListener() = default;
  virtual void on_opened() = 0;
  // `arrival` was read right after the bytes left the kernel. The bytes are valid during the call.
  virtual void on_received(ByteView bytes, Instant arrival) = 0;
  // The port could not be opened or is gone; the reason is one line for people, the cause one of
  // the kPort ones. It is closed: open() may be called again.
  virtual void on_closed(std::string reason, Cause cause) = 0;
};

class Port {
 public:
  virtual ~Port() = default;  // closes
  // Ends in exactly one of on_opened and on_closed. What the line received before is dropped.
  // REQUIRES: not open. The listener outlives the port or its close().
  virtual void open(PortListener& listener) = 0;
  // Sends all bytes; what had been received but not yet delivered is dropped first, so that no
  // stale byte is taken for an answer. Without an open port it does nothing. At most kMaxUnsent
  // bytes wait for a line that takes none; beyond that the port closes.
  virtual void write(ByteView bytes) = 0;
  // At least that many characters are still to come before on_received is of use: the port may
  // sleep for their time on the wire instead of waking for each byte. Bytes are never lost by it,
  // only delivered together. A hint: a port may ignore it.
  virtual void expect(std::uint32_t characters) = 0;
  // Delivers at once what has already arrived. Asked before a timeout is believed: a process that
  // was held up sees the timer, and the bytes that came before it, at the same moment.
  virtual void poll() = 0;
  virtual void close() = 0;
  // The bus ends: close(), but a module that dialled in stays connected, for the next bus of its
  // number.
  virtual void retire() { close(); }

  // Leases the line to a programming session: a second descriptor of it, non-blocking, for a thread
  // of its own. Until end_lease() nothing is delivered and nothing may be written here. Invalid
  // when the port is not open.
  [[nodiscard]] virtual FileDescriptor lease() = 0;
  // The session is over: the line is set up as configured, what it received meanwhile is dropped.
  // No effect unless leased.
  virtual void end_lease() = 0;

  static constexpr std::size_t kMaxUnsent = 4096;
};

class DialInRegistry;

// `modules` outlives the port; it is needed for a port that modules dial in to.
[[nodiscard]] std::unique_ptr<Port> make_port(boost::asio::io_context& io, const PortSpec& spec,
                                              DialInRegistry* modules = nullptr);

}  // namespace fieldcast
