// Which fence a bus of a standby group has, in words, and whether that keeps two masters apart:
// what `--check` and the log say. Pure, any thread.
#pragma once

#include <string>

#include "core/model/spec.hpp"

namespace fieldcast {

struct FenceText {
  std::string text;      // "listening: nothing is sent before the wire was silent for 420ms .."
  bool missing = false;  // two bridges could send into each other; the text says what to do
};
[[nodiscard]] FenceText fence_text(const BusSpec& bus);

}  // namespace fieldcast
