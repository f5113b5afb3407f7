// Divides exchanges by operation and finds the columns that have the same role in all. Pure.
#pragma once

#include <span>

#include "tools/cli/inspect/learn/checksum_search.hpp"
#include "tools/cli/inspect/learn/proposal.hpp"

namespace fieldcast::learn {

struct Group {
  Frames requests, responses;  // of equal number
  void add(ByteView request, ByteView response) {
    requests.push_back(request), responses.push_back(response);
  }
};
using Groups = std::vector<Group>;

struct Roles {
  bool text = false;
  std::ptrdiff_t shift = 0;                 // of the most fields that the response repeats
  LearnedField address, command, sequence;  // of the request; of width 0 if there is none
  std::int64_t command_plus = 0;            // of the response
  std::optional<FoundChecksum> request_check, response_check;
};

struct Grouping {
  Groups groups;
  Roles roles;
};
[[nodiscard]] Grouping group_exchanges(const std::vector<Exchange>& exchanges);

// Exchanges whose response has the byte of the request's column, plus `plus`, `shift` later.
[[nodiscard]] Evidence echo_of(std::span<const Group> groups, std::ptrdiff_t column,
                               std::ptrdiff_t shift, std::int64_t plus = 0);

}  // namespace fieldcast::learn
