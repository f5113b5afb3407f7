// Captures log lines from now on, also in a process that has logged before.
//
// Owns stderr from its constructor until end() or its destructor; at most one per process. Any
// thread may log meanwhile. Its functions are for the thread of the test. Lines that are not
// written within 5 s are missing.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <string>

#include "bridge/log/log.hpp"

namespace fieldcast::test {

class CapturedLog {
 public:
  CapturedLog() {
    testing::internal::CaptureStderr();
    reopen_log();
  }
  ~CapturedLog() {
    if (!ended_) (void)end();
  }
  CapturedLog(const CapturedLog&) = delete;
  CapturedLog& operator=(const CapturedLog&) = delete;

  [[nodiscard]] std::string so_far() const {
    flush_log(std::chrono::seconds{5});
    std::ifstream file("/proc/self/fd/2");  // a file while GoogleTest captures
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::string end() {
    ended_ = true;
    flush_log(std::chrono::seconds{5});
    std::string said = testing::internal::GetCapturedStderr();
    reopen_log();
    return said;
  }

 private:
  bool ended_ = false;
};

}  // namespace fieldcast::test
