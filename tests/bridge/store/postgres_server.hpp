// A real PostgreSQL server for one test, in its own directory and only on a Unix socket there.
#pragma once

#include <gtest/gtest.h>
#include <pwd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "bridge/store/sql/sql.hpp"

namespace fieldcast::test {

class PostgresServer {
 public:
  // Returns the directory of the server's programs, empty if it is not installed.
  [[nodiscard]] static std::string programs() {
    const std::filesystem::path root = "/usr/lib/postgresql";
    std::error_code none;
    for (const auto& version : std::filesystem::directory_iterator(root, none)) {
      if (std::filesystem::exists(version.path() / "bin/initdb"))
        return (version.path() / "bin").string();
    }
    return {};
  }

  PostgresServer() {
    std::string pattern = (std::filesystem::temp_directory_path() / "fieldcast-pg-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) return;
    folder_ = pattern;
    // The server refuses to run as root; its package has created a user for it.
    if (::geteuid() == 0) owner_ = ::getpwnam("postgres");
    if (owner_ && ::chown(folder_.c_str(), owner_->pw_uid, owner_->pw_gid) != 0) return;
    const pid_t init = start("initdb", {"-D", folder_ + "/data", "-A", "trust", "-U", "fieldcast",
                                        "--no-sync", "-E", "UTF8", "--locale=C"});
    int status = -1;
    ::waitpid(init, &status, 0);
    if (status != 0) return;
    server_ = start("postgres", {"-D", folder_ + "/data", "-k", folder_, "-c",
                                 "listen_addresses=", "-c", "fsync=off"});
    for (const auto end = std::chrono::steady_clock::now() + std::chrono::seconds{30};
         std::chrono::steady_clock::now() < end;) {
      try {
        (void)open_postgres(address());
        ready_ = true;
        return;
      } catch (const StoreError&) { std::this_thread::sleep_for(std::chrono::milliseconds{50}); }
    }
  }
  ~PostgresServer() {
    stop(SIGINT);  // "fast": ends its connections
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
  }
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

  [[nodiscard]] bool ready() const { return ready_; }
  [[nodiscard]] StoreAddress address() const {
    return StoreAddress("postgresql://fieldcast:secret@/postgres?host=" + folder_);
  }
  void stop(int signal) {
    if (server_ <= 0) return;
    ::kill(server_, signal);
    ::waitpid(server_, nullptr, 0);
    server_ = -1;
  }

 private:
  pid_t start(const std::string& program, std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), programs() + '/' + program);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    const std::string log = folder_ + "/log";
    const pid_t child = ::fork();
    if (child != 0) return child;
    if (owner_ && (::setgid(owner_->pw_gid) != 0 || ::setuid(owner_->pw_uid) != 0)) ::_exit(126);
    if (std::freopen(log.c_str(), "a", stdout) == nullptr ||
        ::dup2(STDOUT_FILENO, STDERR_FILENO) < 0)
      ::_exit(126);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }

  std::string folder_;
  const passwd* owner_ = nullptr;
  pid_t server_ = -1;
  bool ready_ = false;
};

// Runs `test` with a server; skips it if PostgreSQL is not installed.
inline void with_postgres(const std::function<void(PostgresServer&)>& test) {
  if (PostgresServer::programs().empty())
    GTEST_SKIP() << "no PostgreSQL server here (Debian: postgresql): not tested";
  PostgresServer server;
  ASSERT_TRUE(server.ready()) << "the server did not start";
  test(server);
}

}  // namespace fieldcast::test
