// Routes commands from DDS: refuses duplicates and commands that cannot run, and posts the others
// to their bus. Every command ends in exactly one result. Any thread.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "bridge/bus/bus_runner.hpp"
#include "bridge/standby/standby_values.hpp"
#include "core/bus/command/command_ledger.hpp"
#include "core/model/command.hpp"

namespace fieldcast {

class CommandRouter {
 public:
  enum class Identity : std::uint8_t {
    kNew,
    kKnown,
    kNotKept,  // the store did not save it
    // Not all bridges of the group have noted it, or another bridge has begun the command.
    kNotNoted,
  };
  // Saves the identity of a write permanently, then calls `kept` once, on any thread.
  using Keep = std::function<void(const std::string& bus, const std::string& requester,
                                  std::uint64_t request_id, std::function<void(Identity)> kept)>;
  using Refused = std::function<void(const std::string& bus, const CommandResult& result)>;

  // From now on a write runs only if its identity is saved and is new; otherwise calls `refused`.
  // Null ends this; the owner of `keep` must ensure that no callback follows.
  void keep_identities(Keep keep, Refused refused);

  // Another bridge has responded; later copies are duplicates. Returns false if it already was one.
  bool answered_elsewhere(const std::string& requester, std::uint64_t request_id, Instant now);
  // Returns true if answered_elsewhere() was called for this command in the last seconds: the
  // command was still in flight and has its result.
  [[nodiscard]] bool was_answered_elsewhere(const Command& command, Instant now);

  void add(const std::string& bus, std::shared_ptr<BusRunner> runner);
  void remove(const std::string& bus);

  // Returns `std::nullopt` if a bus gets the command; its result follows. Otherwise returns the
  // result. `late`: the command has expired already; the text is the reason.
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
