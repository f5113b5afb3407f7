// `fieldcast user add|list|remove`: manages the users of the store. Needs no bridge.
#pragma once

#include <iosfwd>
#include <string>

#include "core/access/login.hpp"
#include "tools/cli/domain/store_source.hpp"
#include "tools/cli/text/exit_code.hpp"

namespace fieldcast::cli {

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
