// Generates the JSON Schema and the tables of config/README.md from the keys. Pure functions.
#pragma once

#include <string>

namespace fieldcast::config {

// The content of config/fieldcast.schema.json.
[[nodiscard]] std::string schema_text();

// Replaces the tables between the two marks; unchanged if a mark is missing.
[[nodiscard]] std::string with_key_tables(const std::string& readme);

}  // namespace fieldcast::config
