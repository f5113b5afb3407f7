// As much of JSON Schema (draft 2020-12) as config/fieldcast.schema.json uses. A keyword that this
// does not know is a failure, so that the schema cannot say what no test reads.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "config/document.hpp"

namespace fieldcast::config {

// The value that a JSON-minded reader sees in YAML (YAML 1.2 core schema: plain true, false, null
// and numbers are not texts).
[[nodiscard]] nlohmann::json json_of(const Node& node);

// Nothing when the value fits, else the first reason: "/buses/0: unknown key 'x'".
[[nodiscard]] std::string misfit(const nlohmann::json& value, const nlohmann::json& schema,
                                 const nlohmann::json& root, const std::string& path = "");

}  // namespace fieldcast::config
