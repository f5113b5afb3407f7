// The JSON Schema of the format and the tables of config/README.md, made from the rows of the keys.
// Pure functions.
#pragma once

#include <string>

namespace fieldcast::config {

// The whole text of config/fieldcast.schema.json.
[[nodiscard]] std::string schema_text();

// The text of config/README.md with the tables between its two marks made anew; the text as it is
// when a mark is missing.
[[nodiscard]] std::string with_key_tables(const std::string& readme);

}  // namespace fieldcast::config
