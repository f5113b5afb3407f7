// PostgreSQL with libpq. Rows are sent as a pipeline: one round trip per batch.
#include <libpq-fe.h>
#include <poll.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <map>

#include "bridge/store/sql/sql.hpp"

namespace fieldcast {
namespace {

// Rows in one pipeline: the responses fit in the socket's buffer while libpq still sends.
constexpr std::size_t kPipelined = 256;

// Longer than the server's own statement_timeout, so that its error message arrives first.
constexpr std::chrono::seconds kPatience{12};

// From pg_type.dat: the column types of the store's tables.
constexpr Oid kInt8 = 20, kInt2 = 21, kInt4 = 23, kFloat8 = 701;

struct FinishConnection {
  void operator()(PGconn* connection) const { PQfinish(connection); }
};
struct ClearResult {
  void operator()(PGresult* result) const { PQclear(result); }
};
using Connection = std::unique_ptr<PGconn, FinishConnection>;
using Result = std::unique_ptr<PGresult, ClearResult>;

// libpq ends its messages with a line break, and uses several lines if it tried several addresses.
std::string one_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

// Replaces invalid UTF-8 and zeros, which the server rejects; a device may send any bytes.
std::string plain_text(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80                   ? 1
                               : lead >= 0xC2 && lead < 0xE0 ? 2
                               : lead >= 0xE0 && lead < 0xF0 ? 3
                               : lead >= 0xF0 && lead < 0xF5 ? 4
                                                             : 0;
    bool good = length > 0 && lead != 0 && i + length <= text.size();
    for (std::size_t k = 1; good && k < length; ++k)
      good = (static_cast<unsigned char>(text[i + k]) & 0xC0) == 0x80;
    if (good && length > 2) {  // over-long forms, surrogates, beyond U+10FFFF
      const auto second = static_cast<unsigned char>(text[i + 1]);
      good = !(lead == 0xE0 && second < 0xA0) && !(lead == 0xED && second > 0x9F) &&
             !(lead == 0xF0 && second < 0x90) && !(lead == 0xF4 && second > 0x8F);
    }
    plain += good ? std::string(text.substr(i, length)) : "?";
    i += good ? length : 1;
  }
  return plain;
}

std::string spelled(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "Infinity" : "-Infinity";
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// The texts of a row, and pointers to them as libpq requires.
class Parameters {
 public:
  explicit Parameters(const SqlRow& row) : texts_(row.size()), pointers_(row.size(), nullptr) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (std::holds_alternative<std::monostate>(row[i])) continue;
      if (const auto* integer = std::get_if<std::int64_t>(&row[i]))
        texts_[i] = std::to_string(*integer);
      if (const auto* real = std::get_if<double>(&row[i])) texts_[i] = spelled(*real);
      if (const auto* text = std::get_if<std::string>(&row[i])) texts_[i] = plain_text(*text);
      pointers_[i] = texts_[i].c_str();
    }
  }
  [[nodiscard]] int count() const { return static_cast<int>(pointers_.size()); }
  [[nodiscard]] const char* const* data() const { return pointers_.data(); }

 private:
  std::vector<std::string> texts_;
  std::vector<const char*> pointers_;
};

SqlValue column(const PGresult* result, int row, int at) {
  if (PQgetisnull(result, row, at)) return std::monostate{};
  const std::string_view text(PQgetvalue(result, row, at),
                              static_cast<std::size_t>(PQgetlength(result, row, at)));
  const Oid type = PQftype(result, at);
  if (type == kInt2 || type == kInt4 || type == kInt8) {
    std::int64_t integer = 0;
    std::from_chars(text.data(), text.data() + text.size(), integer);
    return integer;
  }
  if (type == kFloat8) {
    double real = 0;
    std::from_chars(text.data(), text.data() + text.size(), real);
    return real;
  }
  return std::string(text);
}

class PostgresConnection final : public SqlConnection {
 public:
  PostgresConnection(std::string masked_address, Connection connection)
      : masked_address_(std::move(masked_address)), connection_(std::move(connection)) {
    // Drops notices such as "table exists".
    PQsetNoticeProcessor(
        connection_.get(), [](void*, const char*) {}, nullptr);
  }

  Dialect dialect() const override { return Dialect::kPostgres; }

  // The server's statement_timeout ends statements that have begun.
  void limit(std::chrono::steady_clock::time_point until) override { until_ = until; }

  void script(const std::string& sql) override {
    if (PQsendQuery(connection_.get(), sql.c_str()) != 1) fail();
    read_results();
  }

  std::uint64_t execute(const std::string& sql, std::span<const SqlRow> rows) override {
    if (rows.empty()) return 0;
    const std::string& name = prepared(sql);
    if (rows.size() == 1) {
      const Parameters parameters(rows[0]);
      if (PQsendQueryPrepared(connection_.get(), name.c_str(), parameters.count(),
                              parameters.data(), nullptr, nullptr, 0) != 1)
        fail();
      return read_results();
    }
    std::uint64_t changed = 0;
    for (std::size_t at = 0; at < rows.size(); at += kPipelined) {
      changed += pipeline(name, rows.subspan(at, std::min(kPipelined, rows.size() - at)));
    }
    return changed;
  }

  void query(const std::string& sql, const SqlRow& parameters,
             const std::function<bool(const SqlRow&)>& on_row) override {
    if (std::chrono::steady_clock::now() >= until_)
      throw StoreTooSlow("store " + masked_address_ + ": it takes too long");
    const std::string& name = prepared(sql);
    const Parameters texts(parameters);
    if (PQsendQueryPrepared(connection_.get(), name.c_str(), texts.count(), texts.data(), nullptr,
                            nullptr, 0) != 1)
      fail();
    PQsetSingleRowMode(connection_.get());  // a large result is never held completely
    bool wanted = true;
    Problem problem;
    SqlRow row;
    while (const Result result = next()) {
      const ExecStatusType status = PQresultStatus(result.get());
      if (status != PGRES_SINGLE_TUPLE && status != PGRES_TUPLES_OK) note(problem, result.get());
      for (int i = 0; wanted && i < PQntuples(result.get()); ++i) {
        row.resize(static_cast<std::size_t>(PQnfields(result.get())));
        for (std::size_t k = 0; k < row.size(); ++k)
          row[k] = column(result.get(), i, static_cast<int>(k));
        wanted = on_row(row);
      }
    }
    raise_if_any(problem);
  }

 private:
  [[noreturn]] void fail() const {
    const std::string text =
        "store " + masked_address_ + ": " + one_line(PQerrorMessage(connection_.get()));
    if (is_lost()) throw StoreAway(text);
    throw StoreError(text);
  }
  [[nodiscard]] bool is_lost() const { return PQstatus(connection_.get()) != CONNECTION_OK; }
  std::string text_of(const PGresult* result) const {
    return "store " + masked_address_ + ": " + one_line(PQresultErrorMessage(result));
  }

  // From the appendix of error codes: lock_not_available.
  static constexpr std::string_view kLockTimeout = "55P03";

  // The first error in a response.
  struct Problem {
    std::string text;
    bool away = false;
    bool too_slow = false;
    bool refused = false;
    bool busy = false;
  };
  void note(Problem& problem, const PGresult* result) const {
    if (problem.text.empty())
      problem = {text_of(result), is_away(result), state_of(result) == "57014",
                 is_refused(state_of(result)), state_of(result) == kLockTimeout};
  }
  // postgresql.org/docs/current/errcodes-appendix.html: classes 22, data exception, 23, integrity
  // constraint violation, and 54, program limit exceeded.
  static bool is_refused(std::string_view state) {
    return state.starts_with("22") || state.starts_with("23") || state.starts_with("54");
  }
  static void raise_if_any(const Problem& problem) {
    if (problem.too_slow) throw StoreTooSlow(problem.text);
    if (problem.away) throw StoreAway(problem.text);
    if (problem.busy) throw StoreBusy(problem.text);
    if (problem.refused) throw StoreRowRefused(problem.text);
    if (!problem.text.empty()) throw StoreError(problem.text);
  }
  // postgresql.org/docs/current/errcodes-appendix.html: classes 53, insufficient resources (a full
  // disk), and 58, system error; 25006, a read-only server.
  bool is_away(const PGresult* result) const {
    const std::string_view state = state_of(result);
    return is_lost() || state.starts_with("53") || state.starts_with("58") || state == "25006";
  }

  static std::string_view state_of(const PGresult* result) {
    const char* const code = PQresultErrorField(result, PG_DIAG_SQLSTATE);
    return code == nullptr ? "" : code;
  }

  // Returns the next result, or null at the end of a response.
  Result next() {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (PQisBusy(connection_.get()) == 1) {
      const auto left =
          std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
      pollfd socket{PQsocket(connection_.get()), POLLIN, 0};
      if (left.count() <= 0 || ::poll(&socket, 1, static_cast<int>(left.count())) == 0) {
        throw StoreAway("store " + masked_address_ + ": the server does not respond");
      }
      if (PQconsumeInput(connection_.get()) != 1) fail();
    }
    return Result(PQgetResult(connection_.get()));
  }

  std::uint64_t read_results() {
    std::uint64_t changed = 0;
    Problem problem;
    while (const Result result = next()) {
      const ExecStatusType status = PQresultStatus(result.get());
      if (status != PGRES_COMMAND_OK && status != PGRES_TUPLES_OK && status != PGRES_EMPTY_QUERY) {
        note(problem, result.get());
        if (PQstatus(connection_.get()) != CONNECTION_OK) break;
      }
      changed += changed_by(result.get());
    }
    raise_if_any(problem);
    return changed;
  }

  static std::uint64_t changed_by(PGresult* result) {
    const std::string_view text = PQcmdTuples(result);
    std::uint64_t changed = 0;
    std::from_chars(text.data(), text.data() + text.size(), changed);
    return changed;
  }

  const std::string& prepared(const std::string& sql) {
    const auto found = statements_.find(sql);
    if (found != statements_.end()) return found->second;
    const std::string name = "s" + std::to_string(statements_.size());
    if (PQsendPrepare(connection_.get(), name.c_str(), sql.c_str(), 0, nullptr) != 1) fail();
    read_results();
    return statements_.emplace(sql, name).first->second;
  }

  std::uint64_t pipeline(const std::string& name, std::span<const SqlRow> rows) {
    PGconn* const to = connection_.get();
    if (PQenterPipelineMode(to) != 1) fail();
    for (const SqlRow& row : rows) {
      const Parameters parameters(row);
      if (PQsendQueryPrepared(to, name.c_str(), parameters.count(), parameters.data(), nullptr,
                              nullptr, 0) != 1)
        fail();
    }
    if (PQpipelineSync(to) != 1) fail();
    std::uint64_t changed = 0;
    Problem problem;
    for (bool synced = false; !synced;) {
      const Result result = next();
      if (!result) {  // end of one statement's response, or of all if the connection is lost
        if (PQstatus(to) != CONNECTION_OK) fail();
        continue;
      }
      const ExecStatusType status = PQresultStatus(result.get());
      synced = status == PGRES_PIPELINE_SYNC;
      if (status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK)
        changed += changed_by(result.get());
      if (status == PGRES_FATAL_ERROR) note(problem, result.get());
      if (status == PGRES_FATAL_ERROR && PQstatus(to) != CONNECTION_OK) break;
    }
    PQexitPipelineMode(to);
    raise_if_any(problem);
    return changed;
  }

  const std::string masked_address_;
  std::chrono::steady_clock::time_point until_ = std::chrono::steady_clock::time_point::max();
  Connection connection_;
  std::map<std::string, std::string> statements_;
};

}  // namespace

std::unique_ptr<SqlConnection> open_postgres(const StoreAddress& address) {
  if (address.is_ambiguous()) {
    throw StoreError("store " + address.masked() +
                     ": a '/' or '@' in the password must be escaped, as %2F or %40");
  }
  // The connection string overrides these values. Generic plans: planning a query over all days
  // again for each channel would be slower than the query.
  const char* const keys[] = {"connect_timeout", "tcp_user_timeout", "application_name",
                              "options",         "dbname",           nullptr};
  const char* const values[] = {"5",
                                "10000",
                                "fieldcast",
                                "-c statement_timeout=10s -c lock_timeout=8s "
                                "-c plan_cache_mode=force_generic_plan",
                                address.text().c_str(),
                                nullptr};
  Connection connection(PQconnectdbParams(keys, values, 1));
  const std::string masked_address = address.masked();
  if (!connection) throw StoreError("store " + masked_address + ": no memory");
  if (PQstatus(connection.get()) != CONNECTION_OK) {
    // If a string cannot be parsed, libpq's message contains it with the password.
    const char* const user = PQuser(connection.get());
    throw StoreError(
        "store " + masked_address + ": " +
        (user == nullptr
             ? "the connection string cannot be understood; postgresql://USER@HOST:PORT/DATABASE"
             : one_line(PQerrorMessage(connection.get()))));
  }
  PQsetClientEncoding(connection.get(), "UTF8");
  return std::make_unique<PostgresConnection>(masked_address, std::move(connection));
}

}  // namespace fieldcast
