// Joins the programming server to the store: its users may log in, and the audit hears of every transmission.
#pragma once

#include "bridge/program/hooks.hpp"
#include "bridge/store/audit.hpp"
#include "bridge/store/users.hpp"

namespace fieldcast::program {

// Set while a store is open. Changes only while the server is stopped, since it is read on the server's thread.
struct StoreDoors {
  Audit* audit = nullptr;
  Logins* logins = nullptr;
};

// Fills login and audit. The doors outlive the hooks.
void join_store(Hooks& hooks, const StoreDoors& doors);

}  // namespace fieldcast::program
