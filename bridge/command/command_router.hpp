// Routes commands from DDS: refuses duplicates and commands that cannot run, and posts the others
// to their bus. Every command ends in exactly one result. Any thread.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "bridge/bus/bus_runner.hpp"
#include "bridge/standby/standby_values.hpp"
#include "bridge/store/command_id_table.hpp"
#include "core/bus/command/command_ledger.hpp"
#include "core/model/command.hpp"

namespace fieldcast {

class CommandRouter {
 public:
  using Identity = CommandIdTable::Verdict;

  // Another bridge has responded; later copies are duplicates. Returns false if it already was one.
  bool completed_elsewhere(const std::string& requester, std::uint64_t request_id, Instant now);
  // Returns true if completed_elsewhere() was called for this command, still in flight, recently.
  [[nodiscard]] bool was_completed_elsewhere(const Command& command, Instant now);

  void add(const std::string& bus, std::shared_ptr<BusRunner> runner);
  void remove(const std::string& bus);

  // Two steps of a command: each returns the result, or `std::nullopt` if the command goes on.

  // Refuses a used request_id. `late`: the reason, if the command has expired already.
  [[nodiscard]] std::optional<CommandResult> deduplicate(const Command& command, Instant now,
                                                         std::string late = {});
  // Returns false for a read, which may run twice. A write is noted before it is routed.
  [[nodiscard]] static bool must_be_noted(const Command& command) {
    return command.operation == Operation::kWrite;
  }
  // Posts the command to its bus. `identity` is kNew for a command that is not noted anywhere.
  [[nodiscard]] std::optional<CommandResult> route(const std::string& bus, const Command& command,
                                                   Identity identity, Instant received);

 private:
  std::mutex mutex_;
  CommandLedger ledger_;
  RecentCommands elsewhere_;
  std::map<std::string, std::shared_ptr<BusRunner>, std::less<>> runners_;
};

}  // namespace fieldcast
