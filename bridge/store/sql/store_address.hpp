// Location of a store: a SQLite file, or a PostgreSQL server given by its connection string.
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
  // Contains the password; never log it.
  [[nodiscard]] const std::string& text() const { return text_; }
  // For logs: passwords are shown as ***.
  [[nodiscard]] std::string masked() const;
  // True if the password contains '/' or '@' unescaped: libpq would show a part of it as the host.
  [[nodiscard]] bool is_ambiguous() const;

 private:
  std::string text_;
};

}  // namespace fieldcast
