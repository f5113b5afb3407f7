// `fieldcast token add|list|remove`: manages read-only tokens for a station. Needs no bridge.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include "tools/cli/domain/store_source.hpp"
#include "tools/cli/text/exit_code.hpp"

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

}  // namespace fieldcast::cli
