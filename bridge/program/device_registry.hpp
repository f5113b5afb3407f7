// Which device is whose: finds what a number stands for, a device of a bus or a module without one,
// and leases it to one engineer at a time. Lives on the server's io thread; buses are added and
// removed from any.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/bus/bus_runner.hpp"
#include "bridge/program/leased_device.hpp"
#include "bridge/program/module_server.hpp"
#include "bridge/program/relay_end.hpp"
#include "core/program/frame.hpp"

namespace fieldcast::program {

struct Refusal {
  Reply why = Reply::kNotOnline;
  std::string reason;
};

// One device leased, or about to be. Whoever has it gives it back once, after closing the
// descriptor.
struct DeviceLease {
  std::string number, who;
  std::string bus, device;             // names; a module without a bus: "dial-in" and its number
  std::optional<LineFormat> settings;  // of a serial port
  std::shared_ptr<BusRunner> runner;   // none: a module without a bus
  std::uint64_t bus_lease = 0;         // the number of it, where a bus grants it
  std::weak_ptr<RelayEnd> leaving;  // what is still to be sent: goes no further when it is revoked
  bool granted = false, over = false;
};

// Shared with the answers of buses that are still to come.
class DeviceRegistry : public std::enable_shared_from_this<DeviceRegistry> {
 public:
  static constexpr std::size_t kMaxParked = 64;  // one more is told that the device is in use

  // Each called at most once and on the io thread, not after give_back().
  struct Handlers {
    std::function<void(FileDescriptor)> granted;
    std::function<void(Refusal)> refused;  // the lease is over
    std::function<void(std::string reason)> revoked;
  };

  // `modules` may be null. The io_context outlives every bus that is added.
  DeviceRegistry(boost::asio::io_context& io, std::shared_ptr<ModuleServer> modules)
      : io_(io), modules_(std::move(modules)) {}

  void add(const BusSpec& bus, const std::shared_ptr<BusRunner>& runner);
  void remove(const std::string& bus);

  std::shared_ptr<DeviceLease> take(const std::string& number, const std::string& who,
                                    Handlers handlers);
  // `lost`: why the line is of no use any more.
  void give_back(const std::shared_ptr<DeviceLease>& lease, std::optional<std::string> lost);
  // Those leased, or asked for, or to which the last bytes still leave.
  [[nodiscard]] std::vector<LeasedDevice> leased() const;

 private:
  struct Target {
    std::string bus, device;
    std::shared_ptr<BusRunner> runner;
  };
  [[nodiscard]] std::optional<Target> find(const std::string& number) const;
  void try_take(const std::shared_ptr<DeviceLease>& lease, Handlers handlers);
  void free(const std::shared_ptr<DeviceLease>& lease);
  void ask_bus(const std::shared_ptr<DeviceLease>& lease,
               const std::shared_ptr<Handlers>& handlers);

  boost::asio::io_context& io_;
  const std::shared_ptr<ModuleServer> modules_;
  mutable std::mutex mutex_;                                    // of targets_
  std::map<std::string, Target> targets_;                       // by number
  std::map<std::string, std::shared_ptr<DeviceLease>> leases_;  // by number
  // For numbers about to be free.
  std::vector<std::pair<std::shared_ptr<DeviceLease>, Handlers>> parked_;
};

}  // namespace fieldcast::program
