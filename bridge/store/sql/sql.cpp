#include "bridge/store/sql/sql.hpp"

#include "bridge/store/sql/schema.hpp"

namespace fieldcast {

SqlTransaction::SqlTransaction(SqlConnection& connection) : connection_(connection) {
  // SQLite: locked for writing from the start, it cannot fail half-way with a lock conflict.
  connection_.script(connection_.dialect() == SqlConnection::Dialect::kSqlite ? "begin immediate"
                                                                              : "begin");
}

SqlTransaction::~SqlTransaction() {
  if (!open_) return;
  try {
    connection_.script("rollback");
  } catch (const StoreError&) {}  // the connection is lost, and with it the transaction
}

void SqlTransaction::commit() {
  connection_.script("commit");
  open_ = false;
}

void make_read_only(SqlConnection& connection) {
  connection.script(connection.dialect() == SqlConnection::Dialect::kSqlite
                        ? "pragma query_only = 1"
                        : "set session characteristics as transaction read only");
}

std::unique_ptr<SqlConnection> open_store(const StoreAddress& address, IfMissing missing) {
  auto connection =
      address.is_server() ? open_postgres(address) : open_sqlite(address.text(), missing);
  bring_to_present(*connection, address.masked());
  return connection;
}

std::int64_t integer_at(const SqlRow& row, std::size_t column) {
  const auto* value = std::get_if<std::int64_t>(&row.at(column));
  return value == nullptr ? 0 : *value;
}

std::string text_at(const SqlRow& row, std::size_t column) {
  const auto* value = std::get_if<std::string>(&row.at(column));
  return value == nullptr ? std::string() : *value;
}

}  // namespace fieldcast
