// `fieldcast user add|list|remove`: who may log in. Opens the store, needs no bridge.
#pragma once

#include <iosfwd>
#include <string>

#include "core/access/role.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/store_source.hpp"

namespace fieldcast::cli {

struct UserOptions {
  enum class Action : unsigned char { kAdd, kList, kRemove };
  StoreSource source;
  Action action = Action::kList;
  std::string name;
  Role role = Role::kViewer;
  // Its first line; empty: asked for, or the first line of `in`. Never an argument: others could
  // read it.
  std::string password_file;
  bool json = false;
};

// kRejected for a user that is there already, kNothing for one that is not. Throws StoreError.
[[nodiscard]] ExitCode user(const UserOptions& options, std::istream& in, std::ostream& out,
                            std::ostream& err);

}  // namespace fieldcast::cli
