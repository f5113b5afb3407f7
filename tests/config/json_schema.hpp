// The part of JSON Schema (draft 2020-12) that config/fieldcast.schema.json uses. An unsupported
// keyword is a failure, so that every part of the schema is tested.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "config/document/document.hpp"

namespace fieldcast::config {

// Converts YAML to JSON (YAML 1.2 core schema: plain true, false, null and numbers are not texts).
[[nodiscard]] nlohmann::json json_of(const Node& node);

// Returns the first reason, for example "/buses/0: unknown key 'x'"; empty if the value fits.
[[nodiscard]] std::string misfit(const nlohmann::json& value, const nlohmann::json& schema,
                                 const nlohmann::json& root, const std::string& path = "");

}  // namespace fieldcast::config
