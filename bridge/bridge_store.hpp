// The store of a bridge with the tables that are open beside it: logins, and the identities of
// writes. Without `store` in the configuration, all of them are closed.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "bridge/alarm/alarm_table.hpp"
#include "bridge/store/command_id_table.hpp"
#include "bridge/store/store.hpp"
#include "bridge/store/users/authenticator.hpp"
#include "core/model/store_spec.hpp"

namespace fieldcast {

class BridgeStore {
 public:
  // Main thread, with the buses stopped. `alarms` get the state of the previous run, and store
  // their changes until close().
  void open(const StoreSpec& spec, AlarmTable& alarms);
  [[nodiscard]] Store* store() { return store_.get(); }                     // null if closed
  [[nodiscard]] CommandIdTable* identities() { return identities_.get(); }  // null if closed
  [[nodiscard]] Logins* logins() { return logins_.get(); }                  // null if closed
  void close_logins() { logins_.reset(); }
  void close(AlarmTable& alarms);  // writes the pending data

  // Any thread; no effect if closed.
  void append(AuditEntry entry);
  [[nodiscard]] std::optional<StoreCounters> counters() const;
  void save(Duration limit);

 private:
  // Guards the pointer: modules can connect, and a hanging stop can save, at any time.
  mutable std::mutex mutex_;
  std::unique_ptr<Store> store_;
  std::unique_ptr<Authenticator> logins_;
  std::unique_ptr<CommandIdTable> identities_;
};

}  // namespace fieldcast
