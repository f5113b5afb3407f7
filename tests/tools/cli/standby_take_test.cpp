#include <gtest/gtest.h>
#include <pthread.h>
#include <unistd.h>

#include <csignal>
#include <future>
#include <sstream>

#include "bridge/dds/endpoints/standby_channel.hpp"
#include "tests/bridge/dds/dds_support.hpp"
#include "tools/cli/arguments.hpp"

namespace fieldcast::cli {
namespace {

// Before any thread is started, so that only the command receives the signal.
const int kBlocked = [] {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  return pthread_sigmask(SIG_BLOCK, &set, nullptr);
}();

// A waiting member that never takes over. Ctrl-C arrives after the request.
TEST(StandbyTake, AfterCtrlCBlamesNobody) {
  ASSERT_EQ(kBlocked, 0);
  Domain domain(testing::loopback(), "member", nullptr);
  StandbyMessage waiting;
  waiting.group = "g";
  waiting.member.bridge = "b";
  StandbyChannel channel(domain, "b", "g", UtcTime{1},
                         {.member = [](const auto&) {},
                          .lost = [](const auto&) {},
                          .note = [](const auto&) {},
                          .request = [](const auto&) { ::kill(::getpid(), SIGINT); }});
  const std::string number = std::to_string(testing::loopback().domain);
  const char* const words[] = {"fieldcast", "standby", "take", "b", "--domain", number.c_str()};
  const auto parsed = parse_arguments(6, words);
  ASSERT_TRUE(parsed) << parsed.error().text;
  std::istringstream in;
  std::ostringstream out, err;
  auto code = std::async(std::launch::async, [&] { return (*parsed)->run({in, out, err}); });
  while (code.wait_for(std::chrono::milliseconds{50}) != std::future_status::ready) {
    ++waiting.member.beat;
    channel.tell(waiting);
  }
  EXPECT_EQ(code.get(), ExitCode::kInterrupted);
  EXPECT_EQ(err.str(), "");
}

// Without a bridge. The signal waits until the command receives it.
TEST(ReportsForATime, AfterCtrlCBlameNobody) {
  ASSERT_EQ(kBlocked, 0);
  const std::string number = std::to_string(testing::loopback().domain);
  for (const char* command : {"status", "sessions"}) {
    const char* const words[] = {"fieldcast", command, "--for", "1min", "--domain", number.c_str()};
    const auto parsed = parse_arguments(6, words);
    ASSERT_TRUE(parsed) << parsed.error().text;
    std::istringstream in;
    std::ostringstream out, err;
    ::kill(::getpid(), SIGINT);
    EXPECT_EQ((*parsed)->run({in, out, err}), ExitCode::kInterrupted) << command;
    EXPECT_EQ(err.str(), "") << command;
  }
}

}  // namespace
}  // namespace fieldcast::cli
