// The part of JSON Schema (draft 2020-12) that config/fieldcast.schema.json uses. An unknown
// keyword is a failure, so that every rule of the schema is tested.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "config/document.hpp"

namespace fieldcast::config {

// Converts YAML to JSON by the YAML 1.2 core schema: plain true, false, null and numbers are not
// texts.
[[nodiscard]] nlohmann::json json_of(const Node& node);

// Returns the first reason why the value does not fit: "/buses/0: unknown key 'x'"; empty if it
// fits.
[[nodiscard]] std::string misfit(const nlohmann::json& value, const nlohmann::json& schema,
                                 const nlohmann::json& root, const std::string& path = "");

}  // namespace fieldcast::config
