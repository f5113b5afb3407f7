// Rows that the database refused, with the reason; the newest kMaxKept. Throws StoreError.
#pragma once

#include <string>

#include "bridge/store/sql/sql.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class QuarantineTable {
 public:
  static constexpr std::int64_t kMaxKept = 10'000;

  explicit QuarantineTable(SqlConnection& connection) : connection_(connection) {}

  // `table`: the table that refused the row. `content`: the row as JSON.
  void insert(UtcTime at, const std::string& table, const std::string& content,
              const std::string& reason);
  void remove_oldest();

 private:
  SqlConnection& connection_;
};

}  // namespace fieldcast
