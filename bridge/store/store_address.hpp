// Where a store lies: a file of SQLite, or a PostgreSQL server by its connection string.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace fieldcast {

class StoreAddress {
 public:
  StoreAddress() = default;
  // "postgresql://.." or "postgres://.." is a server, anything else a file.
  explicit StoreAddress(std::string text) : text_(std::move(text)) {}

  [[nodiscard]] bool is_server() const;
  // With the password: never for a log.
  [[nodiscard]] const std::string& text() const { return text_; }
  // For logs: a password shows as ***.
  [[nodiscard]] std::string masked() const;
  // A password with '/' or '@' that is not escaped: libpq would take a part of it for the host, and
  // show it.
  [[nodiscard]] bool is_ambiguous() const;

 private:
  std::string text_;
};

}  // namespace fieldcast
