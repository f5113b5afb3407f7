// Explains a YAML syntax error; its cause is often lines above the position where the parser
// stopped.
#pragma once

#include <string>
#include <string_view>

#include "config/document/document.hpp"

namespace fieldcast::config {

struct YamlError {
  Position position;       // of the cause
  std::string what;        // "a value cannot begin with '%'"
  std::string allowed;     // "a text in quotes"; may be empty
  std::string suggestion;  // "\"%\""; may be empty
};

// As the parser reports it.
struct YamlProblem {
  Position stopped;
  std::string_view message;  // "did not find expected key"
  Position begin;            // of what the parser was reading
  std::string_view reading;  // "while parsing a block mapping"; may be empty
};
[[nodiscard]] YamlError explain_yaml_error(const Source& source, const YamlProblem& problem);

// A second document began without "---", because the first one ended early.
[[nodiscard]] YamlError explain_second_document(const Source& source, const Position& position);

}  // namespace fieldcast::config
