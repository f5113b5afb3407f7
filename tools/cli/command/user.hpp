#pragma once

#include <cstdint>
#include <string>

#include "core/access/login.hpp"
#include "tools/cli/command/base/command.hpp"
#include "tools/cli/domain/connection.hpp"

namespace fieldcast::cli {

enum class AccessAction : unsigned char { kAdd, kList, kRemove };

struct AccessOptions {
  StoreSource source;
  AccessAction action = AccessAction::kList;
  std::string name;
  bool json = false;
};
struct TokenOptions : AccessOptions {
  std::uint32_t days = 0;  // lifetime
};
struct UserOptions : AccessOptions {
  Role role = Role::kViewer;
  // The password is the first line of this file. If empty: a prompt, or the first line of `in`.
  // Never an argument, which other users could read.
  std::string password_file;
};

// Return kRejected if the user or token exists already, kNothing if missing. Throw StoreError.
[[nodiscard]] ExitCode token(const TokenOptions& options, const Streams& to);
[[nodiscard]] ExitCode user(const UserOptions& options, const Streams& to);

}  // namespace fieldcast::cli
