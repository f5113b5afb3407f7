// Runs one BusEngine: a port, a clock and a sink around on_event(event, now) -> actions.
//
// The engine and the port live on the io thread given; the functions here may be called from any
// thread and only post to it.
#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/bus/bus_sink.hpp"
#include "core/bus/event.hpp"
#include "core/model/inheritance.hpp"
#include "core/model/spec.hpp"

namespace boost::asio {
class io_context;
}

namespace fieldcast {

class CaptureTap;
class DialInRegistry;
class MasterLease;

// A bus's line in the hands of a programming session.
struct LeasedLine {
  std::uint64_t lease = 0;             // which one, for end_lease()
  FileDescriptor line;                 // non-blocking, the session's own
  std::optional<LineFormat> settings;  // of a serial port: what may be changed
};
struct LeaseRefused {
  bool in_use = false;  // by another session; else the port is not open
  std::string reason;
};

class BusRunner {
 public:
  // Commands that may wait for the io thread. More are refused; the engine's own queue has its own
  // limit.
  static constexpr std::size_t kMaxWaiting = 1024;

  // `plans`: where plans are made, which takes too long for the bus's own thread; may end after the
  // bus, or before. The sink must outlive the runner's stop(), and so must the registry, which a
  // dial-in port needs. Nothing is sent while the lease does not hold, which outlives the bus;
  // null: it always holds. REQUIRES: spec is as the loader makes it.
  BusRunner(boost::asio::io_context& io, boost::asio::io_context& plans, const BusSpec& spec,
            BusSink& sink, DialInRegistry* modules = nullptr, const MasterLease* lease = nullptr);
  ~BusRunner();  // REQUIRES: stop() was waited for, or start() never called
  BusRunner(const BusRunner&) = delete;
  BusRunner& operator=(const BusRunner&) = delete;

  // Opens the port, again and again until it opens. Before that it takes over what another bridge
  // knew of the bus.
  void start(BusInheritance inherited = {});

  // False: too many wait (the caller answers kQueueFull). A command taken ends in exactly one
  // BusSink::complete().
  [[nodiscard]] bool post(Command command);
  void post(std::vector<InterestChanged> interests);
  // Samples count on from above this number, as CountAbove says.
  void count_above(std::uint64_t number);
  // Wire trace on stdout.
  void set_trace(bool on);
  // What passes on the wire goes into the tap while that is wanted. Before start().
  void set_capture(std::shared_ptr<CaptureTap> tap);

  // Leases the bus to `who`: its acquisition rests until end_lease(). `granted` is called once;
  // `revoked`, after a grant, when the port is lost or the bus stops before the lease ended. Both
  // on the io thread, where they only post.
  using Granted = std::function<void(tl::expected<LeasedLine, LeaseRefused>)>;
  using Revoked = std::function<void(std::string reason)>;
  void lease(std::string who, Granted granted, Revoked revoked);
  // The session's descriptor is closed. `lost`: why the line is of no use any more; then it is
  // opened anew. A lease that was revoked is over already.
  void end_lease(std::uint64_t lease, std::optional<std::string> lost);

  // When the io thread last came round to the report of each second: older than some seconds, it
  // hangs in a driver.
  [[nodiscard]] Instant last_turn() const;

  // Answers every pending command with kShutdown, reports the bus as stopped and closes the port.
  // Ready when nothing of this bus will happen any more. Once.
  [[nodiscard]] std::future<void> stop();

 private:
  class Loop;
  std::shared_ptr<Loop> loop_;  // shared with the handlers under way
};

}  // namespace fieldcast
