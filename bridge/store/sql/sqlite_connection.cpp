// SQLite in WAL mode. A commit reaches the kernel, so a crash of the process loses nothing. The
// disk is synchronized at checkpoints: a power failure may lose seconds (sqlite.org/pragma.html).
#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cerrno>
#include <map>
#include <mutex>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/store/sql/sql.hpp"

namespace fieldcast {
namespace {

// Steps of SQLite's virtual machine between two checks of the clock: about 1 ms.
constexpr int kStepsBetweenLooks = 20'000;
// Wait while another process writes: a command line, a backup.
constexpr int kBusyMilliseconds = 5000;
// auto_vacuum must come first: it applies only to a file without tables.
constexpr const char* kSettings =
    "pragma auto_vacuum = incremental; pragma journal_mode = wal; pragma synchronous = normal; "
    "pragma wal_autocheckpoint = 4000; "
    "pragma journal_size_limit = "
    "67108864;"
    "pragma cache_size = -16384";

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
struct FinalizeStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, FinalizeStatement>;

class SqliteConnection final : public SqlConnection {
 public:
  SqliteConnection(std::string path, Database database)
      : path_(std::move(path)), database_(std::move(database)) {
    sqlite3_busy_timeout(database_.get(), kBusyMilliseconds);
    script(kSettings);
  }

  Dialect dialect() const override { return Dialect::kSqlite; }

  void limit(std::chrono::steady_clock::time_point until) override {
    until_ = until;
    const auto is_late = [](void* self) {
      const auto now = std::chrono::steady_clock::now();
      return now < static_cast<const SqliteConnection*>(self)->until_ ? 0 : 1;
    };
    sqlite3_progress_handler(database_.get(), kStepsBetweenLooks, is_late, this);
  }

  void script(const std::string& sql) override {
    if (sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
  }

  std::uint64_t execute(const std::string& sql, std::span<const SqlRow> rows) override {
    sqlite3_stmt* statement = prepared(sql);
    std::uint64_t changed = 0;
    for (const SqlRow& row : rows) {
      const Reset reset{statement};
      bind(statement, row);
      int step = 0;
      while ((step = sqlite3_step(statement)) == SQLITE_ROW) {}
      if (step != SQLITE_DONE) fail();
      changed += static_cast<std::uint64_t>(sqlite3_changes(database_.get()));
    }
    return changed;
  }

  void query(const std::string& sql, const SqlRow& parameters,
             const std::function<bool(const SqlRow&)>& on_row) override {
    if (std::chrono::steady_clock::now() >= until_)
      throw StoreTooSlow("store " + path_ + ": it takes too long");
    sqlite3_stmt* statement = prepared(sql);
    const Reset reset{statement};
    bind(statement, parameters);
    SqlRow row(static_cast<std::size_t>(sqlite3_column_count(statement)));
    for (;;) {
      const int step = sqlite3_step(statement);
      if (step == SQLITE_DONE) return;
      if (step != SQLITE_ROW) fail();
      for (std::size_t i = 0; i < row.size(); ++i) row[i] = column(statement, static_cast<int>(i));
      if (!on_row(row)) return;
    }
  }

 private:
  struct Reset {
    sqlite3_stmt* statement;
    ~Reset() { sqlite3_reset(statement); }
  };

  [[noreturn]] void fail() const {
    const std::string text = "store " + path_ + ": " + sqlite3_errmsg(database_.get());
    const int code = sqlite3_errcode(database_.get());
    if (code == SQLITE_FULL || code == SQLITE_READONLY || code == SQLITE_IOERR)
      throw StoreAway(text);
    if (code == SQLITE_BUSY) throw StoreBusy(text);
    if (code == SQLITE_INTERRUPT) throw StoreTooSlow(text);
    if (code == SQLITE_CONSTRAINT || code == SQLITE_MISMATCH || code == SQLITE_TOOBIG)
      throw StoreRowRefused(text);
    throw StoreError(text);
  }

  sqlite3_stmt* prepared(const std::string& sql) {
    Statement& statement = statements_[sql];
    if (!statement) {
      sqlite3_stmt* made = nullptr;
      if (sqlite3_prepare_v3(database_.get(), sql.c_str(), -1, SQLITE_PREPARE_PERSISTENT, &made,
                             nullptr) != SQLITE_OK)
        fail();
      statement.reset(made);
    }
    return statement.get();
  }

  void bind(sqlite3_stmt* statement, const SqlRow& row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const int at = static_cast<int>(i) + 1;
      int done = SQLITE_OK;
      if (const auto* integer = std::get_if<std::int64_t>(&row[i])) {
        done = sqlite3_bind_int64(statement, at, *integer);
      } else if (const auto* real = std::get_if<double>(&row[i])) {
        done = sqlite3_bind_double(statement, at, *real);
      } else if (const auto* text = std::get_if<std::string>(&row[i])) {
        done = sqlite3_bind_text64(statement, at, text->data(), text->size(), SQLITE_STATIC,
                                   SQLITE_UTF8);
      } else {
        done = sqlite3_bind_null(statement, at);
      }
      if (done != SQLITE_OK) fail();
    }
  }

  static SqlValue column(sqlite3_stmt* statement, int at) {
    switch (sqlite3_column_type(statement, at)) {
      case SQLITE_INTEGER: return static_cast<std::int64_t>(sqlite3_column_int64(statement, at));
      case SQLITE_FLOAT: return sqlite3_column_double(statement, at);
      case SQLITE_NULL: return std::monostate{};
      default: {
        const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, at));
        return std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(statement, at)));
      }
    }
  }

  const std::string path_;
  std::chrono::steady_clock::time_point until_ = std::chrono::steady_clock::time_point::max();
  Database database_;
  // Destroyed before the database.
  std::map<std::string, Statement> statements_;
};

// SQLite gives its own files the permissions of the database's: all contain hashes of passwords. An
// existing file is not opened here: closing it would remove the locks of all connections of this
// process (sqlite.org/howtocorrupt.html, 2.2), and another process could delete the log. The mutex
// prevents that another thread opens a new file before this one has closed it.
void make_private_file(const std::string& path) {
  static std::mutex one;
  const std::lock_guard lock(one);
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file >= 0) return void(::close(file));
  if (errno == EEXIST && ::access(path.c_str(), R_OK | W_OK) == 0) return;
  throw StoreError("store " + path + ": cannot be opened for writing (" + errno_text(errno) +
                   "); the folder must exist, and its owner must be who runs this program");
}

}  // namespace

std::unique_ptr<SqlConnection> open_sqlite(const std::string& path, IfMissing missing) {
  if (missing == IfMissing::kFail && ::access(path.c_str(), F_OK) != 0) {
    throw StoreError(
        "store " + path +
        ": there is no such file; the bridge makes it when it first runs with this store");
  }
  make_private_file(path);
  sqlite3* made = nullptr;
  const int opened =
      sqlite3_open_v2(path.c_str(), &made, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, nullptr);
  Database database(made);
  if (opened != SQLITE_OK) throw StoreError("store " + path + ": " + sqlite3_errstr(opened));
  return std::make_unique<SqliteConnection>(path, std::move(database));
}

}  // namespace fieldcast
