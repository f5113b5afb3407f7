// One connection to a database, SQLite or PostgreSQL, in the part of SQL that both speak:
// parameters $1, $2, .. in the order of their first appearance, `on conflict`, `returning`. One
// owner, one thread at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "bridge/store/store_address.hpp"

namespace fieldcast {

// The one exception of this folder: what the database said, where and to what. No secret in it.
class StoreError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The database takes nothing now, whatever it is: it is gone, its disk is full or can only be read.
// It may later.
class StoreAway : public StoreError {
 public:
  using StoreError::StoreError;
};

// A statement took longer than limit() allows.
class StoreTooSlow : public StoreError {
 public:
  using StoreError::StoreError;
};

// The database refuses the values of a row, for example null where a value must be. The same row is
// refused again.
class StoreRowRefused : public StoreError {
 public:
  using StoreError::StoreError;
};

// std::monostate: null.
using SqlValue = std::variant<std::monostate, std::int64_t, double, std::string>;
using SqlRow = std::vector<SqlValue>;

class SqlConnection {
 public:
  enum class Dialect : std::uint8_t { kSqlite, kPostgres };

  virtual ~SqlConnection() = default;
  [[nodiscard]] virtual Dialect dialect() const = 0;

  // Everything below throws StoreError. Statements are prepared once, by their text: few and
  // constant ones only.

  // A script of several statements without parameters; it is not prepared.
  virtual void script(const std::string& sql) = 0;
  // One statement for each row of parameters; the rows that it changed.
  virtual std::uint64_t execute(const std::string& sql, std::span<const SqlRow> rows) = 0;
  // Each row of the answer goes to on_row; false ends the reading.
  virtual void query(const std::string& sql, const SqlRow& parameters,
                     const std::function<bool(const SqlRow&)>& on_row) = 0;

  // From then on statements fail with StoreTooSlow, also one that has begun; with PostgreSQL that
  // one fails after 10 s in all.
  virtual void limit(std::chrono::steady_clock::time_point until) = 0;

  std::uint64_t execute(const std::string& sql, const SqlRow& row) {
    return execute(sql, std::span(&row, 1));
  }
};

// From now on the connection changes nothing in the database: such statements throw StoreError.
void make_read_only(SqlConnection& connection);

// What is done from its construction on happens at its commit, or not at all.
class SqlTransaction {
 public:
  explicit SqlTransaction(SqlConnection& connection);
  ~SqlTransaction();  // without a commit: rolled back
  SqlTransaction(const SqlTransaction&) = delete;
  SqlTransaction& operator=(const SqlTransaction&) = delete;
  void commit();

 private:
  SqlConnection& connection_;
  bool open_ = true;
};

// Connects, and brings the tables to the present version. A file that does not exist is made,
// readable for its owner only, when `create` says so. Bounded: a server that does not answer fails
// within seconds. Throws StoreError.
enum class IfMissing : std::uint8_t { kCreate, kFail };
[[nodiscard]] std::unique_ptr<SqlConnection> open_store(const StoreAddress& address,
                                                        IfMissing missing);

// Parts of the above.
[[nodiscard]] std::unique_ptr<SqlConnection> open_sqlite(const std::string& path,
                                                         IfMissing missing);
[[nodiscard]] std::unique_ptr<SqlConnection> open_postgres(const StoreAddress& address);

// Columns of a row. REQUIRES: the column is of that kind; null is 0 and "".
[[nodiscard]] std::int64_t integer_at(const SqlRow& row, std::size_t column);
[[nodiscard]] std::string text_at(const SqlRow& row, std::size_t column);

}  // namespace fieldcast
