// Describes the fence of a bus in a standby group, for `--check` and the log. Pure, any thread.
#pragma once

#include <string>

#include "core/model/bus_spec.hpp"

namespace fieldcast {

struct FenceText {
  std::string text;
  bool missing = false;  // two bridges could send at the same time; the text contains the fix
};
[[nodiscard]] FenceText fence_text(const BusSpec& bus);

}  // namespace fieldcast
