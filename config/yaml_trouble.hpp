// What a text that is no YAML lacks, in words, and where. The parser says where it gave up and what
// it looked for there; the cause (a quote, a bracket, an indentation) is often lines above. Pure.
#pragma once

#include <string>
#include <string_view>

#include "config/document.hpp"

namespace fieldcast::config {

struct YamlTrouble {
  Position position;       // of the cause
  std::string what;        // "a value cannot begin with '%'"
  std::string allowed;     // "a text in quotes"; may be empty
  std::string suggestion;  // "\"%\""; may be empty
};

// `stopped` and `message` are the parser's.
[[nodiscard]] YamlTrouble explain_yaml_error(const Source& source, const Position& stopped,
                                             std::string_view message);

// A second document began at `position` without "---", since the first one ended early.
[[nodiscard]] YamlTrouble explain_second_document(const Source& source, const Position& position);

}  // namespace fieldcast::config
