// What the programming server asks of the rest of the bridge: who may log in, where the audit goes,
// who is told of sessions. Each may be called on the server's thread, must not block, and may be
// missing.
#pragma once

#include <functional>
#include <string>

#include "bridge/base/secret.hpp"
#include "core/base/time.hpp"
#include "core/model/status.hpp"

namespace fieldcast::program {

// Of the user of a certificate or of a password.
struct LoginAnswer {
  bool allowed = false;
  std::string reason;  // why not
};

// One line of the audit.
struct Transmission {
  std::string who;     // the user and the address, or the address alone
  std::string target;  // "press-shop/press-1", or the device number asked for
  std::uint64_t bytes_to_device = 0, bytes_from_device = 0;
  std::string result;  // one line for people
};

struct Hooks {
  // `done` is called once, on any thread. Only programmers are allowed.
  std::function<void(std::string user, Secret password, std::string address,
                     std::function<void(LoginAnswer)> done)>
      login;
  // The same for a user whose certificate was verified. Missing: every certificate will do.
  std::function<void(std::string user, std::string address, std::function<void(LoginAnswer)> done)>
      certified;
  std::function<void(const Transmission&)> audit;
  std::function<void(const ProgramSessionReport&)> report;
};

}  // namespace fieldcast::program
