// Where commands from DDS come in: finds the bus, turns away duplicates and what nobody can take, hands the rest to the bus.
// Every command ends in exactly one result. Any thread.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "bridge/bus_runner.hpp"
#include "core/bus/command_ledger.hpp"
#include "core/model/command.hpp"

namespace fieldcast {

class CommandDesk {
 public:
  // A bus takes commands from here on, until it is removed.
  void add(const std::string& bus, std::shared_ptr<BusRunner> runner);
  void remove(const std::string& bus);

  // Nothing: a bus has the command, its result follows. Else the result, at once: a duplicate, a full queue, a bus that stops.
  [[nodiscard]] std::optional<CommandResult> take(const std::string& bus, Command command, Instant now);

 private:
  std::mutex mutex_;
  CommandLedger ledger_;
  std::map<std::string, std::shared_ptr<BusRunner>, std::less<>> runners_;
};

}  // namespace fieldcast
