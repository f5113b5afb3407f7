// Quotes and brackets of a YAML text, followed by a scanner that never gives up. It serves texts
// that the parser refused: what was left open is the cause, and often lines above the position
// where the parser stopped. Pure; one pass over the text.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "config/document.hpp"

namespace fieldcast::config {

// Before or after in the text.
[[nodiscard]] bool is_before(const Position& a, const Position& b);

struct Quote {
  char sign = '"';
  Position begin;  // of the opening sign
  Position end;    // of the closing sign, or of the end of the text
  bool closed = true;
};

struct Bracket {
  char sign = '[';
  Position position;
};

struct YamlScan {
  std::vector<Bracket> open;          // where the parser stopped
  std::vector<Bracket> never_closed;  // at the end of the text
  std::optional<Quote> quote;         // the last one that begins before the parser stopped
  struct Mismatch {
    std::optional<Bracket> open;  // what should have been closed; nothing: nothing was open
    Bracket closing;
  };
  std::optional<Mismatch> mismatch;  // the first one
};

[[nodiscard]] YamlScan scan_yaml(const Source& source, const Position& stopped);

// The quoted text that begins at `begin`; nothing when no quote stands there.
[[nodiscard]] std::optional<Quote> quote_at(const Source& source, const Position& begin);

}  // namespace fieldcast::config
