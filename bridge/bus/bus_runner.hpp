// Destination of a bus's samples, results and reports. Called only on the bus's io thread.
#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/base/file_descriptor.hpp"
#include "core/base/time.hpp"
#include "core/bus/command/device_probe.hpp"
#include "core/bus/setup/event.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/command.hpp"
#include "core/model/sample.hpp"
#include "core/model/status.hpp"
#include "core/plan/read_plan.hpp"
#include "core/telnet/com_port.hpp"

namespace fieldcast {

// A bus that measures its devices changes its plan often in its first seconds.
inline constexpr Duration kPlanReportGap = std::chrono::seconds{5};

class BusSink {
 public:
  virtual ~BusSink() = default;
  virtual void publish(std::vector<Sample> samples, const UtcMapping& mapping) = 0;
  virtual void promise(ChannelIndex channel, std::optional<Duration> gap) = 0;
  virtual void complete(const CommandResult& result, const UtcMapping& mapping) = 0;
  virtual void report(const BusReport& report, UtcTime at) = 0;
  virtual void report(std::string_view device, const DeviceReport& report, UtcTime at) = 0;
  // A new plan is in use. Called once for the first plan, then at most every kPlanReportGap.
  virtual void report(PlanReport plan, UtcTime at) = 0;
};

}  // namespace fieldcast

// Runs one BusEngine: connects it with a port, a clock and a sink. Engine and port live on the
// given io thread. Any thread may call the functions here; they only post to it.

namespace boost::asio {
class io_context;
}

namespace fieldcast {

class CaptureTap;
class DialInRegistry;
class IoThread;
class MasterLease;

struct LeasedLine {
  std::uint64_t lease = 0;             // number for end_lease()
  FileDescriptor line;                 // non-blocking, owned by the session
  LineFormat format{};                 // of the line, as configured
  std::optional<LineFormat> settings;  // of a serial port: the settings that may be changed
  bool at_server = false;              // BusRunner::change_line() changes the settings
  std::shared_ptr<CaptureTap> tap{};   // for the bytes of the session; may be null
};
struct LeaseRefused {
  bool in_use = false;  // by another session; false: the port is not open
  std::string reason;
};

class BusRunner {
 public:
  // Limit of commands that wait for the io thread. The engine's queue has its own limit.
  static constexpr std::size_t kMaxWaiting = 1024;

  // `plans`: makes plans, too slow for the bus's thread. The sink and the registry (for a dial-in
  // port) must outlive stop(). The lease outlives the bus; nothing is sent while it is not held;
  // null: always held. REQUIRES: spec is as the loader makes it.
  BusRunner(IoThread& io, boost::asio::io_context& plans, const BusSpec& spec, BusSink& sink,
            DialInRegistry* modules = nullptr, const MasterLease* lease = nullptr);
  ~BusRunner() = default;  // REQUIRES: stop() was waited for, or start() never called
  BusRunner(const BusRunner&) = delete;
  BusRunner& operator=(const BusRunner&) = delete;

  [[nodiscard]] const BusSpec& spec() const;  // any thread

  // Opens the port, and retries until it opens. First takes over the state `inherited`.
  void start(BusInheritance inherited = {});

  // Returns false if too many commands wait. An accepted command ends in one BusSink::complete().
  [[nodiscard]] bool post(Command command);
  void post(std::vector<InterestChanged> interests);
  // Runs the probe in spare time of the bus. `done` is called once, on the io thread, and must only
  // post; without devices if another probe runs. Returns false if the bus has stopped.
  using Probed = std::function<void(const std::vector<ProbedDevice>&, const UtcMapping&)>;
  [[nodiscard]] bool probe(DeviceProbe probe, Probed done);
  // Inputs of calculated channels; `fetch` is called on the io thread.
  void post_inputs(std::function<std::vector<InputSample>()> fetch);
  // Sample numbers continue above this number (see CountAbove).
  void count_above(std::uint64_t number);
  // Switches the wire trace on stdout.
  void set_trace(bool on);
  // Copies the traffic of the wire to the tap while the capture is active. Call before start().
  void set_capture(std::shared_ptr<CaptureTap> tap);

  // Leases the bus to `who`; its acquisition pauses until end_lease(). `granted` is called once.
  // After a grant, `revoked` is called if the port is lost or the bus stops before the lease ends.
  // Both are called on the io thread and must only post.
  using Granted = std::function<void(tl::expected<LeasedLine, LeaseRefused>)>;
  using Revoked = std::function<void(std::string reason)>;
  void lease(std::string who, Granted granted, Revoked revoked);
  // See Port::change_line(). `done` is called on the io thread and must only post.
  void change_line(std::uint64_t lease, const telnet::LineChange& change,
                   telnet::LineChangeDone done);
  // Call when the session's descriptor is closed. `lost`: reason why the line is no longer usable;
  // the port is then reopened. Has no effect on a lease that was revoked.
  void end_lease(std::uint64_t lease, std::optional<std::string> lost);

  // Last report of the io thread, which reports each second; if old, it hangs in a driver.
  [[nodiscard]] Instant last_turn() const;

  // Responds to every pending command with kShutdown, reports the bus as stopped and closes the
  // port. The future is ready when no handler of this bus can run any more. Call once.
  [[nodiscard]] std::future<void> stop();

 private:
  class Loop;
  // The session of an engineer may hold the runner after its bus and thread have ended.
  const std::shared_ptr<boost::asio::io_context> context_;
  const std::shared_ptr<Loop> loop_;  // shared with pending handlers
};

}  // namespace fieldcast
