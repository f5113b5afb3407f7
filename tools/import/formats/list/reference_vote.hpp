// Determines whether numbers such as 40001 are references, which count from 1, or plain numbers.
// All valid rows are compared. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/import/points/address.hpp"

namespace fieldcast::importing {

class ReferenceVote {
 public:
  struct Row {
    unsigned line = 0;
    std::string_view cell;                // as in the list
    std::optional<ModbusArea> reference;  // empty: can only be a plain number
    std::optional<ModbusArea> said;       // from the function or table
    bool is_number = false;               // the type is a number, so the area is not a bit area
  };
  void add(const Row& row) { rows_.push_back(row); }

  // True if every row may be a reference. Accepts a few contradictions if more rows in two areas
  // agree; the caller refuses those.
  [[nodiscard]] bool counts_from_one() const;

  // Describes conflicting rows; empty if there are none.
  [[nodiscard]] std::string note() const;

 private:
  enum class Say { kNothing, kConfirms, kContradicts, kIsNone };
  [[nodiscard]] static Say say_of(const Row& row);

  std::vector<Row> rows_;
};

}  // namespace fieldcast::importing
