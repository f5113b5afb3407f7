// Reports unknown keys of a file, each once. Pure.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "tools/import/points/model.hpp"
#include "tools/import/text/tree.hpp"

namespace fieldcast::importing {

class OtherKeys {
 public:
  // `of` describes the map: "a request".
  void look(const Node& map, std::string_view of, std::initializer_list<std::string_view> known);
  // A key that is not used. REQUIRES: key and `of` outlive this.
  void add(std::string_view key, std::string_view of, unsigned line);
  // A note for each key, with the line where it stands first.
  void tell(const std::string& file, Found& found) const;

 private:
  struct Other {
    std::string_view key, of;
    unsigned line = 0;
    std::size_t count = 0;
  };
  // at most kMaxOthers; refers to keys of the tree, which must outlive it
  std::vector<Other> others_;
};

}  // namespace fieldcast::importing
