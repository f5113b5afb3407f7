#pragma once

#include <map>
#include <string>
#include <string_view>

namespace fieldcast::importing {

// Keeps letters, digits, '-', '_' and '.', removes accents, and replaces the rest by single '-'. At
// most 64 bytes; may be empty.
[[nodiscard]] std::string plain_name(std::string_view name);

// Truncates to `bytes` at a character boundary.
[[nodiscard]] std::string cut_text(std::string_view utf8, std::size_t bytes);

// Makes names unique: the second "power" becomes "power-2".
class UniqueNames {
 public:
  [[nodiscard]] std::string unique(std::string name);

 private:
  std::map<std::string, unsigned> given_;
};

}  // namespace fieldcast::importing
