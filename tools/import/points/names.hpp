#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tools/import/points/model.hpp"
#include "tools/import/text/tree.hpp"

namespace fieldcast::importing {

// Keeps letters, digits, '-', '_' and '.', removes accents, and replaces the rest by single '-'. At
// most 64 bytes; may be empty.
[[nodiscard]] std::string plain_name(std::string_view name);

// Truncates to `bytes` at a character boundary.
[[nodiscard]] std::string cut_text(std::string_view utf8, std::size_t bytes);

class UniqueNames {
 public:
  [[nodiscard]] std::string unique(std::string name);

 private:
  std::map<std::string, unsigned> given_;
};

class OtherKeys {
 public:
  // `of` describes the map: "a request". `known`: separated by blanks.
  void look(const Node& map, std::string_view of, std::string_view known);
  // A key that is not used. REQUIRES: key and `of` outlive this.
  void add(std::string_view key, std::string_view of, unsigned line);
  void tell(const std::string& file, Found& found) const;

 private:
  struct Other {
    std::string_view key, of;
    unsigned line = 0;
    std::size_t count = 0;
  };
  // at most kMaxOthers; refers to keys of the tree
  std::vector<Other> others_;
};

}  // namespace fieldcast::importing
