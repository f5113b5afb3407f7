#include "bridge/store/quarantine_table.hpp"

namespace fieldcast {

void QuarantineTable::insert(UtcTime at, const std::string& table, const std::string& content,
                             const std::string& reason) {
  connection_.execute(
      "insert into quarantine (at, table_name, content, reason) values ($1, $2, $3, $4)",
      SqlRow{at.nanoseconds, table, content, reason});
}

void QuarantineTable::remove_oldest() {
  connection_.execute("delete from quarantine where id <= (select max(id) from quarantine) - $1",
                      SqlRow{kMaxKept});
}

}  // namespace fieldcast
