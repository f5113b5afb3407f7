// Location of a store: a SQLite file, or a PostgreSQL server given by its connection string.
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

namespace fieldcast {

class StoreAddress {
 public:
  StoreAddress() = default;
  // "postgresql://.." or "postgres://.." is a server, anything else a file.
  explicit StoreAddress(std::string text) : text_(std::move(text)) {}

  [[nodiscard]] bool is_server() const;
  // Contains the password; never log it.
  [[nodiscard]] const std::string& text() const { return text_; }
  // For logs: passwords are shown as ***.
  [[nodiscard]] std::string masked() const;
  // True if the password contains '/' or '@' unescaped: libpq would show a part of it as the host.
  [[nodiscard]] bool is_ambiguous() const;

 private:
  std::string text_;
};

// One connection to SQLite or PostgreSQL with common SQL: parameters $1, $2, .., `on conflict`,
// `returning`. One owner, one thread at a time.

// Base of all exceptions of this folder: error of the database and place, without secrets.
class StoreError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The database cannot write now: not available, read-only, or its disk is full.
class StoreAway : public StoreError {
 public:
  using StoreError::StoreError;
};

// Another connection holds a lock for too long.
class StoreBusy : public StoreError {
 public:
  using StoreError::StoreError;
};

// A statement exceeded limit().
class StoreTooSlow : public StoreError {
 public:
  using StoreError::StoreError;
};

// The database refuses the values of a row, for example null in a mandatory column, every time.
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

  // All functions below throw StoreError. Statements are prepared once and identified by their
  // text: use only few, constant texts.

  // Runs several statements without parameters; they are not prepared.
  virtual void script(const std::string& sql) = 0;
  // Runs one statement for each row of parameters. Returns the number of changed rows.
  virtual std::uint64_t execute(const std::string& sql, std::span<const SqlRow> rows) = 0;
  // Calls on_row for each row of the result until it returns false.
  virtual void query(const std::string& sql, const SqlRow& parameters,
                     const std::function<bool(const SqlRow&)>& on_row) = 0;

  // From `until` on, statements fail with StoreTooSlow, also a running one; with PostgreSQL, a
  // running one fails after 10 s in total.
  virtual void limit(std::chrono::steady_clock::time_point until) = 0;

  std::uint64_t execute(const std::string& sql, const SqlRow& row) {
    return execute(sql, std::span(&row, 1));
  }
};

// Makes the connection read-only: writing statements then throw StoreError.
void make_read_only(SqlConnection& connection);

// A transaction; everything until commit() takes effect together or not at all.
class SqlTransaction {
 public:
  explicit SqlTransaction(SqlConnection& connection);
  ~SqlTransaction();  // rolls back without a commit
  SqlTransaction(const SqlTransaction&) = delete;
  SqlTransaction& operator=(const SqlTransaction&) = delete;
  void commit();

 private:
  SqlConnection& connection_;
  bool open_ = true;
};

// Connects and upgrades the tables. With kCreate, creates a missing file that only its owner can
// read. A server that does not respond fails within seconds. Throws StoreError.
enum class IfMissing : std::uint8_t { kCreate, kFail };
[[nodiscard]] std::unique_ptr<SqlConnection> open_store(const StoreAddress& address,
                                                        IfMissing missing);

[[nodiscard]] std::unique_ptr<SqlConnection> open_sqlite(const std::string& path,
                                                         IfMissing missing);
[[nodiscard]] std::unique_ptr<SqlConnection> open_postgres(const StoreAddress& address);

// Columns of a row. Null is returned as 0 or "". REQUIRES: the column has that type.
[[nodiscard]] std::int64_t integer_at(const SqlRow& row, std::size_t column);
[[nodiscard]] std::string text_at(const SqlRow& row, std::size_t column);

}  // namespace fieldcast
