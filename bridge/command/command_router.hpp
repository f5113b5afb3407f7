// Takes the commands from DDS: finds the bus, refuses duplicates and commands that no bus can take,
// and posts the others to the bus. Every command ends in exactly one result. Any thread.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "bridge/bus/bus_runner.hpp"
#include "bridge/command/recent_commands.hpp"
#include "core/bus/command_ledger.hpp"
#include "core/model/command.hpp"

namespace fieldcast {

class CommandRouter {
 public:
  enum class Identity : std::uint8_t {
    kNew,       // kept from now on
    kKnown,     // kept before
    kNotKept,   // the store did not take it
    kNotNoted,  // not all bridges of the standby group have noted it, or another one has begun it
  };
  // Keeps the identity of a write so that it outlives this process, then calls `kept` once, on any
  // thread.
  using Keep = std::function<void(const std::string& bus, const std::string& requester,
                                  std::uint64_t request_id, std::function<void(Identity)> kept)>;
  using Refused = std::function<void(const std::string& bus, const CommandResult& result)>;

  // From here on a write runs when its identity is kept and was not before; `refused` is called for
  // the others. A null `keep` ends it; the owner of `keep` makes sure that nothing is called
  // afterwards.
  void keep_identities(Keep keep, Refused refused);

  // Another bridge has answered it: it is a duplicate from here on. False: it was one before.
  bool answered_elsewhere(const std::string& requester, std::uint64_t request_id, Instant now);
  // That was a moment ago: a command that comes now was on its way, and has its result.
  [[nodiscard]] bool was_answered_elsewhere(const Command& command, Instant now);

  // A bus takes commands from here on, until it is removed.
  void add(const std::string& bus, std::shared_ptr<BusRunner> runner);
  void remove(const std::string& bus);

  // Nothing: a bus has the command or will have it, its result follows. Else the result, at once: a
  // duplicate, a full queue, a bus that stops. `late`: it has expired already, and why.
  [[nodiscard]] std::optional<CommandResult> take(const std::string& bus, Command command,
                                                  Instant now, std::string late = {});

 private:
  // REQUIRES: mutex_ held.
  [[nodiscard]] std::optional<CommandResult> post(const std::string& bus, Command command,
                                                  Instant now);
  void on_identity(const std::string& bus, Command command, Identity identity, Instant received);

  std::mutex mutex_;
  CommandLedger ledger_;
  RecentCommands elsewhere_;
  std::map<std::string, std::shared_ptr<BusRunner>, std::less<>> runners_;
  Keep keep_;
  Refused refused_;
};

}  // namespace fieldcast
