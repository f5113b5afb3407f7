#include "bridge/program/store_hooks.hpp"

namespace fieldcast::program {

void join_store(Hooks& hooks, const StoreDoors& doors) {
  hooks.audit = [&doors](const Transmission& what) {
    if (doors.audit == nullptr) return;
    AuditEntry entry;
    entry.who = what.who;
    entry.what = "program";
    entry.target = what.target;
    entry.bytes_to_device = what.bytes_to_device;
    entry.bytes_from_device = what.bytes_from_device;
    entry.result = what.result;
    doors.audit->append(std::move(entry));
  };
  hooks.login = [&doors](std::string user, std::string password, std::string address, std::function<void(LoginAnswer)> done) {
    if (doors.logins == nullptr) return done({false, "this bridge has no users: its configuration names no store"});
    doors.logins->authenticate({std::move(user), std::move(password), std::move(address)}, [done](const LoginResult& result) {
      if (!result) return done({false, to_text(result.error())});
      if (!may(*result, Role::kProgrammer))
        return done({false, "has the role " + std::string(to_text(*result)) + ", not programmer"});
      done({true, ""});
    });
  };
}

}  // namespace fieldcast::program
