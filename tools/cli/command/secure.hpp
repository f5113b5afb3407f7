// `fieldcast secure init|add|renew|revoke|show|check`: identities and permissions for DDS Security.
// Works on files alone, needs no bridge.
#pragma once

#include <iosfwd>
#include <string>

#include "bridge/security/authority.hpp"
#include "core/base/time.hpp"
#include "tools/cli/exit_code.hpp"

namespace fieldcast::cli {

struct SecureOptions {
  enum class Action : unsigned char { kInit, kAdd, kRenew, kRevoke, kShow, kCheck };
  Action action = Action::kShow;
  std::string folder = ".";  // of the authority, or with kCheck of a member too
  security::Member member;
  security::Protection protection = security::Protection::kEncrypt;
  Duration life = security::kMemberLife;  // of a certificate
  bool json = false;
};

// kRejected where a folder or a name is, or is not, there; kFound where kCheck finds a fault, or a
// file of one of several members cannot be read or written: the others are done.
[[nodiscard]] ExitCode secure(const SecureOptions& options, UtcTime now, std::ostream& out,
                              std::ostream& err);

}  // namespace fieldcast::cli
