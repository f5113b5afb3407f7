// Which device is whose: finds what a number stands for, a device of a bus or a module without one, and lends it to one engineer
// at a time. Lives on the server's io thread; buses are added and removed from any.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <tl/expected.hpp>

#include "bridge/bus_runner.hpp"
#include "bridge/program/module_desk.hpp"
#include "core/program/frame.hpp"

namespace fieldcast::program {

struct Refusal {
  Reply why = Reply::kNotOnline;
  std::string reason;
};

// One device lent, or about to be. Whoever has it gives it back once, after closing the descriptor.
struct Hold {
  std::string number, who;
  std::string bus, device;             // names; a module without a bus: "dial-in" and its number
  std::optional<LineFormat> settings;  // of a serial port
  std::shared_ptr<BusRunner> runner;   // none: a module without a bus
  std::uint64_t lease = 0;
  bool granted = false, over = false;
};

// Shared with the answers of buses that are still to come.
class DeviceBook : public std::enable_shared_from_this<DeviceBook> {
 public:
  // Each called at most once and on the io thread, not after give_back().
  struct Handlers {
    std::function<void(FileDescriptor)> granted;
    std::function<void(Refusal)> refused;  // the hold is over
    std::function<void(std::string reason)> revoked;
  };

  // `modules` may be null. The io_context outlives every bus that is added.
  DeviceBook(boost::asio::io_context& io, std::shared_ptr<ModuleDesk> modules) : io_(io), modules_(std::move(modules)) {}

  void add(const BusSpec& bus, const std::shared_ptr<BusRunner>& runner);
  void remove(const std::string& bus);

  std::shared_ptr<Hold> take(const std::string& number, const std::string& who, Handlers handlers);
  // `lost`: why the line is of no use any more.
  void give_back(Hold& hold, std::optional<std::string> lost);

 private:
  struct Target {
    std::string bus, device;
    std::shared_ptr<BusRunner> runner;
  };
  [[nodiscard]] std::optional<Target> find(const std::string& number) const;
  void ask_bus(const std::shared_ptr<Hold>& hold, const std::shared_ptr<Handlers>& handlers);

  boost::asio::io_context& io_;
  const std::shared_ptr<ModuleDesk> modules_;
  mutable std::mutex mutex_;                 // of targets_
  std::map<std::string, Target> targets_;    // by number
  std::map<std::string, std::string> held_;  // number -> who
};

}  // namespace fieldcast::program
