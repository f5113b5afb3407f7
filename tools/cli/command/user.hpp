// `fieldcast token add|list|remove`: manages read-only tokens for a station. Needs no bridge.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include "core/access/login.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

struct TokenOptions {
  enum class Action : unsigned char { kAdd, kList, kRemove };
  StoreSource source;
  Action action = Action::kList;
  std::string name;
  std::uint32_t days = 0;  // lifetime
  bool json = false;
};

// kRejected if the token exists already, kNothing if it is missing. Throws StoreError.
[[nodiscard]] ExitCode token(const TokenOptions& options, std::ostream& out, std::ostream& err);

// `fieldcast user add|list|remove`: manages the users of the store. Needs no bridge.

struct UserOptions {
  enum class Action : unsigned char { kAdd, kList, kRemove };
  StoreSource source;
  Action action = Action::kList;
  std::string name;
  Role role = Role::kViewer;
  // The password is the first line of this file. If empty: a prompt, or the first line of `in`.
  // Never an argument, which other users could read.
  std::string password_file;
  bool json = false;
};

// kRejected if the user exists already, kNothing if missing. Throws StoreError.
[[nodiscard]] ExitCode user(const UserOptions& options, std::istream& in, std::ostream& out,
                            std::ostream& err);

}  // namespace fieldcast::cli
