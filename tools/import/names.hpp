// Names that a configuration takes, made from those of other programs. Pure.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace fieldcast::importing {

// Letters, digits, '-', '_', '.' stay; letters with accents lose them; everything else becomes one
// '-'. At most 64 bytes; empty if nothing of the name is left.
[[nodiscard]] std::string plain_name(std::string_view name);

// A text that is cut at `bytes`, between two characters.
[[nodiscard]] std::string cut_text(std::string_view utf8, std::size_t bytes);

// Gives each name once: the second "power" becomes "power-2".
class UniqueNames {
 public:
  [[nodiscard]] std::string unique(std::string name);

 private:
  std::map<std::string, unsigned> given_;
};

}  // namespace fieldcast::importing
