#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <chrono>
#include <string>
#include <vector>

#include "bridge/base/file_descriptor.hpp"

extern char** environ;

namespace fieldcast::test {

// Killed by the destructor if it still runs.
class Process {
 public:
  Process(std::string program, const std::vector<std::string>& arguments) {
    int out[2];
    EXPECT_EQ(::pipe2(out, O_CLOEXEC), 0);
    output_.reset(out[0]);
    const FileDescriptor write_end(out[1]);
    start(std::move(program), arguments, write_end.get());
  }
  // The output goes to the descriptor and is not read here.
  Process(std::string program, const std::vector<std::string>& arguments, int output) {
    start(std::move(program), arguments, output);
  }
  ~Process() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void signal(int number) const { ASSERT_EQ(::kill(pid_, number), 0); }

  // Waits until the output contains the text; returns all output, also after the limit.
  const std::string& said(const std::string& text,
                          std::chrono::milliseconds limit = std::chrono::seconds{15}) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (said_.find(text) == std::string::npos && std::chrono::steady_clock::now() < deadline &&
           read_some()) {}
    return said_;
  }

  // Returns -1 after the limit or if a signal ended the process.
  int exit_code(std::chrono::milliseconds limit = std::chrono::seconds{15}) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (std::chrono::steady_clock::now() < deadline &&
           read_some()) {  // the output ends with the process
    }
    int status = 0;
    if (::waitpid(pid_, &status, WNOHANG) != pid_) return -1;
    pid_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  [[nodiscard]] const std::string& output() const { return said_; }

 private:
  void start(std::string program, const std::vector<std::string>& arguments, int output) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, output, STDERR_FILENO);
    std::vector<std::string> copy = arguments;
    std::vector<char*> argv{program.data()};
    for (std::string& argument : copy) argv.push_back(argument.data());
    argv.push_back(nullptr);
    EXPECT_EQ(::posix_spawn(&pid_, program.c_str(), &actions, nullptr, argv.data(), environ), 0);
    posix_spawn_file_actions_destroy(&actions);
  }

  // Returns false at the end of the output, or of the process if its output is not read.
  bool read_some() {
    if (!output_.valid()) {
      siginfo_t ended{};
      ::waitid(P_PID, static_cast<id_t>(pid_), &ended, WEXITED | WNOWAIT | WNOHANG);
      if (ended.si_pid != pid_) ::poll(nullptr, 0, 5);
      return ended.si_pid != pid_;
    }
    pollfd wait{output_.get(), POLLIN, 0};
    if (::poll(&wait, 1, 50) <= 0) return true;
    char buffer[4096];
    const ssize_t size = ::read(output_.get(), buffer, sizeof buffer);
    if (size <= 0) {
      // The pipe closes slightly before waitid() can reap the process.
      siginfo_t ended{};
      ::waitid(P_PID, static_cast<id_t>(pid_), &ended, WEXITED | WNOWAIT);
      return false;
    }
    said_.append(buffer, static_cast<std::size_t>(size));
    return true;
  }

  pid_t pid_ = 0;
  FileDescriptor output_;
  std::string said_;
};

}  // namespace fieldcast::test
