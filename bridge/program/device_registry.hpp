// Finds the device of a number, of a bus or a module without one, and leases it to one engineer at
// a time. Runs on the server's io thread; any thread may add and remove buses.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/bus/bus_runner.hpp"
#include "bridge/program/module/module_server.hpp"
#include "bridge/program/module/relay_end.hpp"
#include "bridge/program/server.hpp"
#include "core/program/device_list.hpp"
#include "core/program/frame.hpp"
#include "core/program/last_request.hpp"

namespace fieldcast::program {

struct Refusal {
  Reply why = Reply::kNotOnline;
  std::string reason;
};

// A leased or requested device. The holder gives it back once, after it has closed the descriptor.
struct DeviceLease {
  std::string number, who;
  std::string bus, device;             // names; a module without a bus: "dial-in" and its number
  LineFormat format;                   // in force, as far as known
  std::optional<LineFormat> settings;  // of a serial port
  bool at_server = false;              // the bus changes the settings (BusRunner::change_line)
  std::shared_ptr<CaptureTap> tap;     // of the bus; null: a module without a bus
  std::size_t index = 0;               // of the device in its bus
  LastRequest last_request;
  std::shared_ptr<BusRunner> runner;  // null: a module without a bus
  std::uint64_t bus_lease = 0;        // number of the lease, if a bus grants it
  // the end that sends the last bytes; closed when the lease is revoked
  std::weak_ptr<RelayEnd> leaving;
  bool granted = false, over = false;
};

// Shared with pending responses of buses.
class DeviceRegistry : public std::enable_shared_from_this<DeviceRegistry> {
 public:
  static constexpr std::size_t kMaxParked = 64;  // further requests are refused as "in use"

  // Each is called at most once, on the io thread, and not after give_back().
  struct Handlers {
    std::function<void(FileDescriptor)> granted;
    std::function<void(Refusal)> refused;  // the lease has ended
    std::function<void(std::string reason)> revoked;
  };

  // `modules` may be null. The io_context must outlive every added bus.
  DeviceRegistry(boost::asio::io_context& io, std::shared_ptr<ModuleServer> modules)
      : io_(io), modules_(std::move(modules)) {}

  void add(const BusSpec& bus, const std::shared_ptr<BusRunner>& runner);
  void remove(const std::string& bus);

  std::shared_ptr<DeviceLease> take(const std::string& number, const std::string& who,
                                    Handlers handlers);
  // `lost` is the reason why the line can no longer be used.
  void give_back(const std::shared_ptr<DeviceLease>& lease, std::optional<std::string> lost);
  // All devices that can be requested now or when their module dials in, by number. A device is in
  // use also while its bus is leased for another device.
  [[nodiscard]] std::vector<ListedDevice> devices() const;
  // Devices that are leased or requested, or whose last bytes are being sent.
  [[nodiscard]] std::vector<LeasedDevice> leased() const;

 private:
  struct Target {
    std::string bus, device;
    std::shared_ptr<BusRunner> runner;
    std::size_t index = 0;     // of the device in its bus
    std::string dial_in{};     // number of the bus's module; empty: the bus opens its line itself
    LastRequest last_request;  // of no session yet
  };
  [[nodiscard]] ListedDevice listed(const std::string& number, const Target& target) const;
  [[nodiscard]] std::optional<Target> find(const std::string& number) const;
  void try_take(const std::shared_ptr<DeviceLease>& lease, Handlers handlers);
  void free(const std::shared_ptr<DeviceLease>& lease);
  void ask_bus(const std::shared_ptr<DeviceLease>& lease,
               const std::shared_ptr<Handlers>& handlers);

  boost::asio::io_context& io_;
  const std::shared_ptr<ModuleServer> modules_;
  mutable std::mutex mutex_;                                    // protects targets_
  std::map<std::string, Target> targets_;                       // by number
  std::map<std::string, std::shared_ptr<DeviceLease>> leases_;  // by number
  // Requests for numbers that will soon be free.
  std::vector<std::pair<std::shared_ptr<DeviceLease>, Handlers>> parked_;
};

}  // namespace fieldcast::program
