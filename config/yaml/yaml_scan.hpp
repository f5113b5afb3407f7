// Finds quotes and brackets of a YAML text that the parser rejected: an open one is the cause,
// often lines above. Pure; one pass over the text; never fails.
#pragma once

#include <optional>
#include <vector>

#include "config/document/document.hpp"

namespace fieldcast::config {

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
  std::optional<Quote> quote;         // last one that begins before the parser stopped
  struct Mismatch {
    std::optional<Bracket> open;  // the bracket to close; empty if none was open
    Bracket closing;
  };
  std::optional<Mismatch> mismatch;  // the first one
};

[[nodiscard]] YamlScan scan_yaml(const Source& source, const Position& stopped);

}  // namespace fieldcast::config
