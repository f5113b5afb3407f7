// Assigns the socket of each dialled-in module to the bus configured for its module number. When a
// bus closes, its socket moves to the next bus with the same number, or to the keeper of unassigned
// modules. Any thread.
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

// A module's connection. A later one of the same number has a greater arrival and replaces it.
struct ModuleConnection {
  FileDescriptor socket;
  std::uint64_t arrival = 0;
  // Has the same lifetime as the socket, so the module server sees which modules are connected.
  std::shared_ptr<void> presence{};
};

class DialInRegistry {
 public:
  // Called on the thread on which the module arrived, or inside claim(); must only post.
  using Deliver = std::function<void(ModuleConnection connection)>;

  // Keeps the modules for whose number there is no bus.
  struct Keeper {
    // Any thread; must only post.
    std::function<void(const std::string& number, ModuleConnection connection)> keep;
    // Returns the kept module of this number; the socket is invalid if there is none or it is
    // leased. Called inside expect(): may wait, but not for the thread of a bus.
    std::function<ModuleConnection(const std::string& number)> hand_over;
  };
  void set_keeper(Keeper keeper);

  // Identifies one expectation or claim: a bus withdraws its own, not that of the next bus.
  using Id = std::uint64_t;

  // Registers a bus for this number until forget(); the latest one counts. Gets a kept module.
  [[nodiscard]] Id expect(const std::string& number);
  // Removes the registration. A module that waits moves to the keeper, if there is one.
  void forget(const std::string& number, Id id);

  [[nodiscard]] bool expects(const std::string& number);

  // The bus accepts modules of its number, including one that already waits, until release().
  [[nodiscard]] Id claim(const std::string& number, Deliver deliver);
  void release(const std::string& number, Id id);

  // Offers a new module. Returned if there is no bus for it. If no bus accepts it yet, it waits.
  [[nodiscard]] std::optional<ModuleConnection> offer(const std::string& number,
                                                      FileDescriptor socket,
                                                      std::shared_ptr<void> presence = {});
  // The same for an earlier connection. It is closed if its bus has had a newer one.
  [[nodiscard]] std::optional<ModuleConnection> offer(const std::string& number,
                                                      ModuleConnection connection);
  // A bus or the keeper releases a connection. It moves to the keeper if there is no bus.
  void pass_on(const std::string& number, ModuleConnection connection);

 private:
  struct Entry {
    Id expected = 0;
    Id claimed = 0;
    Deliver deliver;           // of the claim, or empty
    ModuleConnection waiting;  // not accepted yet; an invalid socket if none
    std::uint64_t newest = 0;  // greatest arrival that waited or was delivered
  };
  void keep(const std::string& number, ModuleConnection connection);

  std::mutex mutex_;
  Id last_ = 0;
  std::uint64_t arrivals_ = 0;
  Keeper keeper_;
  std::map<std::string, Entry> entries_;
};

}  // namespace fieldcast
