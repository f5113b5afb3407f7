#include "bridge/store/sql/sql.hpp"

#include "bridge/store/sql/schema.hpp"

namespace fieldcast {

namespace {

// Masks from the first ':' after the scheme to the last '@': a password may contain any of "/?@".
std::string without_userinfo_password(std::string text) {
  const std::size_t begin = text.find("://") + 3;
  const std::size_t at = text.rfind('@');
  const std::size_t colon = text.find(':', begin);
  if (at == std::string::npos || colon == std::string::npos || colon > at) return text;
  return text.replace(colon + 1, at - colon - 1, "***");
}

// ?password=..&sslpassword=..
std::string without_parameter(std::string text, std::string_view name) {
  for (std::size_t at = 0; (at = text.find(name, at)) != std::string::npos;) {
    at += name.size();
    const std::size_t end = text.find('&', at);
    text.replace(at, end == std::string::npos ? std::string::npos : end - at, "***");
  }
  return text;
}

}  // namespace

bool StoreAddress::is_server() const {
  return text_.starts_with("postgresql://") || text_.starts_with("postgres://");
}

bool StoreAddress::is_ambiguous() const {
  if (!is_server()) return false;
  const std::string address = text_.substr(0, text_.find('?')).substr(text_.find("://") + 3);
  const std::size_t at = address.rfind('@');
  return at != std::string::npos && address.find_first_of("/@") < at;
}

std::string StoreAddress::masked() const {
  return is_server() ? without_parameter(without_userinfo_password(text_), "password=") : text_;
}

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
