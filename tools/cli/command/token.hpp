// `fieldcast token add|list|remove`: which programs and wall screens may read at a station, until
// when. Opens the store, needs no bridge.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include "tools/cli/exit_code.hpp"
#include "tools/cli/store_source.hpp"

namespace fieldcast::cli {

struct TokenOptions {
  enum class Action : unsigned char { kAdd, kList, kRemove };
  StoreSource source;
  Action action = Action::kList;
  std::string name;
  std::uint32_t days = 0;  // until its end
  bool json = false;
};

// kRejected for a token that is there already, kNothing for one that is not. Throws StoreError.
[[nodiscard]] ExitCode token(const TokenOptions& options, std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
