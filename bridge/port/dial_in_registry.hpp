// Where the socket of a module that dialled in goes: to the bus that is configured for its number,
// and from a bus that ends to the next one of that number, or to whoever keeps modules without a
// bus. Any thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast {

// The connection of a module. A later one of the same number has a greater arrival: the module
// dialled in anew, and the earlier one is dead as a rule.
struct ModuleConnection {
  FileDescriptor socket;
  std::uint64_t arrival = 0;
  // Goes along with the socket, whoever has it, and ends with it: so the server of modules sees
  // which are connected.
  std::shared_ptr<void> presence{};
};

class DialInRegistry {
 public:
  // Called on whichever thread the module came in on, or inside claim(); it only posts.
  using Deliver = std::function<void(ModuleConnection connection)>;

  // Keeps the modules whose number no bus is there for.
  struct Keeper {
    // Any thread; only posts.
    std::function<void(const std::string& number, ModuleConnection connection)> keep;
    // The kept module of this number, an invalid socket when there is none or it is leased. Called
    // inside expect(): may wait, but not for the thread of a bus.
    std::function<ModuleConnection(const std::string& number)> hand_over;
  };
  void set_keeper(Keeper keeper);

  // Identifies one expectation or claim. A bus that ends may withdraw its own after the next bus of
  // the same number has begun, and must not withdraw those of that bus.
  using Id = std::uint64_t;

  // A bus is there for this number, from now on until forget(); the latest one counts. A module
  // that was kept is its own at once.
  [[nodiscard]] Id expect(const std::string& number);
  // A module that nobody has taken is kept by the keeper, if there is one.
  void forget(const std::string& number, Id id);

  [[nodiscard]] bool expects(const std::string& number);

  // The bus takes modules of its number, the one that waits already too, until release().
  [[nodiscard]] Id claim(const std::string& number, Deliver deliver);
  void release(const std::string& number, Id id);

  // A module told this number just now. Given back when no bus is there for it; a module that
  // nobody takes yet waits, the newest one.
  [[nodiscard]] std::optional<ModuleConnection> offer(const std::string& number,
                                                      FileDescriptor socket,
                                                      std::shared_ptr<void> presence = {});
  // The same for a connection that has been there for a while. It is closed when its bus has had a
  // newer one: that one stays.
  [[nodiscard]] std::optional<ModuleConnection> offer(const std::string& number,
                                                      ModuleConnection connection);
  // A bus or the keeper gives up a connection. To the keeper when no bus is there.
  void pass_on(const std::string& number, ModuleConnection connection);

 private:
  struct Entry {
    Id expected = 0;           // the latest expectation
    Id claimed = 0;            // the latest claim
    Deliver deliver;           // of the claim, or none
    ModuleConnection waiting;  // that nobody took yet; an invalid socket: none
    std::uint64_t newest = 0;  // arrival of the newest one that waited or was delivered
  };
  void keep(const std::string& number, ModuleConnection connection);

  std::mutex mutex_;
  Id last_ = 0;
  std::uint64_t arrivals_ = 0;
  Keeper keeper_;
  std::map<std::string, Entry> entries_;  // one for each bus with such a port
};

}  // namespace fieldcast
