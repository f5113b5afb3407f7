// Callbacks of the programming server. On its thread; must not block; may be empty.
#pragma once

#include <functional>
#include <string>

#include "bridge/process/secret.hpp"
#include "core/base/time.hpp"
#include "core/model/status.hpp"

namespace fieldcast::program {

// Verdict on the user of a certificate or of a password.
struct LoginResponse {
  bool allowed = false;
  std::string reason;  // reason for a refusal
};

// One line of the audit.
struct Transmission {
  std::string who;     // the user and the address, or the address alone
  std::string target;  // "press-shop/press-1", or the requested device number
  std::uint64_t bytes_to_device = 0, bytes_from_device = 0;
  std::string result;  // one human-readable line
};

struct Hooks {
  // `done` is called once, on any thread. Only programmers are allowed.
  std::function<void(std::string user, Secret password, std::string address,
                     std::function<void(LoginResponse)> done)>
      login;
  // The same for a user whose certificate was verified. If empty, every certificate is accepted.
  std::function<void(std::string user, std::string address,
                     std::function<void(LoginResponse)> done)>
      certified;
  std::function<void(const Transmission&)> audit;
  std::function<void(const ProgramSessionReport&)> report;
  std::function<void(const ProgramRequestReport&)> requested;
};

}  // namespace fieldcast::program
