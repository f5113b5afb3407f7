// Fuzzes login data: password files, names, passwords and tokens of users, and a store with foreign
// tables of users and tokens. A fault must be one line without a word of the secret. An unknown
// role must prevent the login. A hash that needs more memory than the machine has must be refused.
//
// Input: kind(1), then the text; for a store, values separated by zero bytes.
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "bridge/process/secret.hpp"
#include "bridge/store/users/authenticator.hpp"
#include "bridge/store/users/user_table.hpp"
#include "core/base/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace fieldcast {
namespace {

using fuzz::is_one_line;
using fuzz::require;

void read_password_file(const std::string& text) {
  static const int fd = ::memfd_create("password", MFD_CLOEXEC);
  require(fd >= 0 && ::fchmod(fd, 0600) == 0 && ::ftruncate(fd, 0) == 0 &&
          ::pwrite(fd, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size()));
  const auto line = read_secret_line("/proc/self/fd/" + std::to_string(fd), Readers::kOwner);
  if (!line) return require(is_one_line(line.error()));
  require(!line->empty() && text.starts_with(line->text()) &&
          line->text().find('\n') == std::string_view::npos);
}

void read_names(const std::string& text) {
  if (fault_of_user_name(text).empty()) {
    require(!text.empty() && text.size() <= Logins::kMaxUserBytes);
    for (const char c : text) require(c > ' ' && c < 0x7f && c != '/' && c != ':' && c != '"');
  }
  if (fault_of_password(text).empty()) require(text.size() >= Logins::kMinPasswordBytes);
  if (looks_like_token(text)) require(text.size() == 47);
  (void)role_from(text);
}

void read_hash(const std::string& text) {
  const auto limits = password_limits(text);
  if (!limits) return require(!password_fits(text, "wrong password"));
  // Checks a valid hash only if that is quick.
  if (limits->kibibytes <= 64 && limits->passes == 1) (void)password_fits(text, "wrong password");
}

struct Folder {
  Folder() { require(::mkdtemp(path.data()) != nullptr); }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  std::string path = (std::filesystem::temp_directory_path() / "fieldcast-fuzz-XXXXXX").string();
};

SqlConnection& store() {
  static const Folder folder;
  static const auto connection =
      open_store(StoreAddress(folder.path + "/users.db"), IfMissing::kCreate);
  return *connection;
}

// Returns a number if the text is one, so that columns have values of other types.
SqlValue value_of(const std::string& text) {
  if (text == "null") return {};
  if (!text.empty() && text.size() < 18 &&
      std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; }))
    return std::int64_t{std::stoll(text)};
  if (!text.empty() && text.back() == '%') return double(text.size());
  return text;
}

// Missing values are empty texts.
SqlRow row_of(const std::vector<std::string>& values, std::size_t first) {
  SqlRow row;
  for (std::size_t i = 0; i < 4; ++i)
    row.push_back(first + i < values.size() ? value_of(values[first + i]) : std::string());
  return row;
}

void fill(SqlConnection& into, const std::string& sql, const SqlRow& row) {
  try {
    (void)into.execute(sql, row);
  } catch (const StoreError&) {}  // a table that rejects this value
}

void read_store(const std::string& text) {
  std::vector<std::string> values(1);
  for (const char c : text) c == 0 ? (void)values.emplace_back() : values.back().push_back(c);
  SqlConnection& connection = store();
  connection.script("delete from users; delete from tokens");
  for (std::size_t i = 0; i < values.size() && i < 16; i += 4) {
    fill(connection,
         "insert into users (name, role, password_hash, created_at) values ($1, $2, $3, $4) on "
         "conflict do nothing",
         row_of(values, i));
    fill(connection,
         "insert into tokens (name, hash, created_at, ends_at) values ($1, $2, $3, $4) on "
         "conflict do nothing",
         row_of(values, i));
  }
  UserTable users(connection);
  try {
    for (const User& user : users.list()) require(role_from(to_text(user.role)).has_value());
  } catch (const StoreError& error) { require(is_one_line(error.what())); }
  for (const std::string& name : values) {
    if (const auto user = users.find(name)) (void)to_text(user->role);
  }
  TokenTable tokens(connection);
  for (const Token& token : tokens.list()) (void)tokens.remove(token.name);
  require(!tokens.find(text, {}));
}

void run_users(ByteView data) {
  if (data.empty()) return;
  const std::string text(data.begin() + 1, data.end());
  switch (data[0] % 4) {
    case 0: return read_password_file(text);
    case 1: return read_names(text);
    case 2: return read_hash(text);
    default: return read_store(text);
  }
}

}  // namespace
}  // namespace fieldcast

FIELDCAST_FUZZ_TARGET(fieldcast::run_users)
