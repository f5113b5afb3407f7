// Divides exchanges by operation and finds the columns that have the same role in all. Pure.
#pragma once

#include <vector>

#include "tools/cli/inspect/learn/checksum_search.hpp"
#include "tools/cli/inspect/learn/exchange_pairing.hpp"
#include "tools/cli/inspect/learn/frames.hpp"

namespace fieldcast::learn {

struct Group {
  Frames requests, responses;  // of equal number
};

// Columns of a request, and where the response has the same.
struct Columns {
  std::ptrdiff_t at = -1;
  std::size_t width = 0;  // 0: none
  bool echoed = false;
  Evidence evidence;
  std::string note;
  [[nodiscard]] bool holds(std::ptrdiff_t column) const {
    return column >= at && column < at + static_cast<std::ptrdiff_t>(width);
  }
};

struct Roles {
  bool text = false;
  std::ptrdiff_t shift = 0;  // from a column of the request to that of the response
  Columns address, command, sequence;
  std::int64_t command_plus = 0;  // of the response
  std::optional<FoundChecksum> request_check, response_check;
};

struct Grouping {
  std::vector<Group> groups;
  Roles roles;
};
[[nodiscard]] Grouping group_exchanges(const std::vector<Exchange>& exchanges);

// Whether the response of nearly all exchanges repeats the column.
[[nodiscard]] Evidence echo_of(const Group& group, std::ptrdiff_t column, std::ptrdiff_t shift,
                               std::int64_t plus = 0);

}  // namespace fieldcast::learn
