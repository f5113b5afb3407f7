// How a forwarder reaches PostgreSQL. A plain value.
#pragma once

#include <string>

namespace fieldcast::forward {

struct PostgresqlSpec {
  std::string server = "127.0.0.1:5432";  // HOST:PORT, or the directory of a Unix socket
  std::string database = "fieldcast";
  std::string user;  // empty: the user of the process
  std::string password_file;
  std::string authority;  // PEM file that signed the server's certificate; empty: not checked
  std::string certificate, key;  // PEM files of this client
  bool without_tls = false;      // plain text off the loopback, explicitly configured
  std::string schema = "fieldcast";
  bool create = false;  // creates the tables that are missing; changes no existing one
  friend bool operator==(const PostgresqlSpec&, const PostgresqlSpec&) = default;
};

}  // namespace fieldcast::forward
