#pragma once

#include <string>

#include "bridge/security/authority.hpp"
#include "core/base/time.hpp"
#include "tools/cli/command/base/command.hpp"

namespace fieldcast::cli {

struct SecureOptions {
  enum class Action : unsigned char { kInit, kAdd, kRenew, kRevoke, kShow, kCheck };
  Action action = Action::kShow;
  std::string folder = ".";  // of the authority; with kCheck also of a member
  security::Member member;
  security::Protection protection = security::Protection::kEncrypt;
  Duration life = security::kMemberLife;  // of a certificate
  bool json = false;
};

// kRejected if a directory or name exists or is missing unexpectedly; kFound if kCheck finds a
// fault, or if files of one of several members fail.
[[nodiscard]] ExitCode secure(const SecureOptions& options, UtcTime now, const Streams& to);

}  // namespace fieldcast::cli
