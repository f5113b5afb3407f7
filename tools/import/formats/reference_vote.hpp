// Whether numbers such as 40001 of a list are references, which count from 1 and name their area by
// the first digit, or plain numbers. No row decides for the others alone: all rows that are
// understood have a say, and where they disagree the list is told which ones. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/import/address.hpp"

namespace fieldcast::importing {

class ReferenceVote {
 public:
  struct Row {
    unsigned line = 0;
    std::string_view cell;                // as the list has it
    std::optional<ModbusArea> reference;  // nothing: it can be a plain number only
    std::optional<ModbusArea> said;       // by the function or the table
    bool is_number = false;               // its type is one, so it is in no area of bits
  };
  void add(const Row& row) { rows_.push_back(row); }

  // True if every row may be a reference, and their functions agree with the first digits; of a few
  // rows whose function contradicts, while more in two areas agree, the caller makes refusals.
  [[nodiscard]] bool counts_from_one() const;

  // What to tell where the rows disagree; empty: they agree.
  [[nodiscard]] std::string note() const;

 private:
  enum class Say { kNothing, kConfirms, kContradicts, kIsNone };
  [[nodiscard]] static Say say_of(const Row& row);

  std::vector<Row> rows_;
};

}  // namespace fieldcast::importing
