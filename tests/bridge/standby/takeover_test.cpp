// Tests the samples of a station when the master is killed, suspended, or hands over.
//
// FIELDCAST_TAKEOVERS=20 repeats each so often and prints the longest gaps of a channel.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <set>

#include "tests/bridge/standby/takeover_fixture.hpp"

namespace fieldcast {
namespace {

using namespace takeover;

std::uint16_t free_udp_port() {
  const FileDescriptor any(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  EXPECT_EQ(::bind(any.get(), reinterpret_cast<sockaddr*>(&address), size), 0);
  EXPECT_EQ(::getsockname(any.get(), reinterpret_cast<sockaddr*>(&address), &size), 0);
  return ntohs(address.sin_port);
}

TEST_F(TakeoverTest, AMasterThatIsKilledIsReplacedAndItsSequencesGoOn) {
  start_both();
  const auto gaps = take_over_in_turn(SIGKILL, "has taken over in group g");
  ASSERT_FALSE(gaps.empty());
  print("kill -9", gaps);
  EXPECT_LE(gaps.back(), 1s);  // on an idle machine; see docs/redundancy.md
  EXPECT_EQ(watch.fault(), "");
  expect_one_master();
}

TEST_F(TakeoverTest, AMasterThatEndsHandsOverWithoutAMissedRefresh) {
  start_both();
  const auto gaps = take_over_in_turn(SIGTERM, "the master has handed over");
  ASSERT_FALSE(gaps.empty());
  print("SIGTERM", gaps);
  EXPECT_LE(gaps.back(), 300ms);
  EXPECT_EQ(watch.fault(), "");
  expect_one_master();
}

TEST_F(TakeoverTest, AMasterThatStoodStillDoesNotSpeakAgainAndStandsBy) {
  start_both();
  a->signal(SIGSTOP);
  ASSERT_TRUE(says("b", "has taken over in group g"));
  expect_samples();
  print("a master that falls silent", {watch.longest_gap()});
  std::set<std::uint64_t> ids;
  for (int value = 1; value <= 5; ++value) ids.insert(write(value));
  EXPECT_TRUE(within([&] { return watch.results().size() == ids.size(); }));
  a->signal(SIGCONT);  // it also receives the five
  ASSERT_TRUE(says("a", "steps back"));
  ASSERT_TRUE(says("a", "stands by in group g", 2));
  expect_samples();
  for (const auto& [id, count] : watch.results()) EXPECT_EQ(count, 1) << id;
  for (const auto& [id, result] : watch.last_results())
    EXPECT_EQ(result.state, CommandState::kDone) << id << ": " << result.reason;
  EXPECT_EQ(watch.fault(), "");
  expect_one_master();
}

TEST_F(TakeoverTest, OverAKillEachCommandHasAResultAndNoWriteRunsTwice) {
  start_both();
  const auto ids = write_while_the_master_gets(SIGKILL);
  const auto results = watch.last_results();
  const auto written = device.writes();
  int done = 0;
  for (int i = 1; i <= kWrites; ++i) {
    const auto found = results.find(ids[static_cast<std::size_t>(i - 1)]);
    if (found == results.end()) {
      ADD_FAILURE() << "no result of command " << i;
      continue;
    }
    const auto count = written.find(static_cast<std::uint16_t>(i));
    const int times = count == written.end() ? 0 : count->second;
    EXPECT_LE(times, 1) << i;
    if (found->second.state != CommandState::kDone) continue;
    ++done;
    EXPECT_EQ(times, 1) << i;
  }
  EXPECT_GE(done, kWrites / 2);  // pending ones FAIL at the kill
  for (const auto& [id, count] : watch.results()) EXPECT_EQ(count, 1) << id;
}

TEST_F(TakeoverTest, MembersThatStartBeforeTheirDiscoveryServerWaitForIt) {
  const std::string server = "/usr/bin/fast-discovery-server";
  if (::access(server.c_str(), X_OK) != 0) GTEST_SKIP() << "fastdds-tools is not installed";
  const std::string port = std::to_string(free_udp_port());
  dds = ", discovery-servers: [\"127.0.0.1:" + port + "\"]";
  a = launch("a", 1);
  b = launch("b", 1);
  ASSERT_TRUE(says("a", "waits for a discovery server: none has responded"));
  ASSERT_TRUE(says("b", "waits for a discovery server: none has responded"));
  const auto is_master = [this](const std::string& name) {
    return said(name).find("is master of group g") != std::string::npos;
  };
  EXPECT_FALSE(is_master("a") || is_master("b"));
  const test::Process runs(server,
                           std::vector<std::string>{"-i", "0", "-l", "127.0.0.1", "-p", port});
  ASSERT_TRUE(says("a", "stands by in group g"));
  ASSERT_TRUE(says("b", "stands by in group g"));
  EXPECT_TRUE(within([&] { return is_master("a") || is_master("b"); }));
}

TEST_F(TakeoverTest, OverAHandOverEveryCommandIsDoneOnce) {
  start_both();
  (void)write_while_the_master_gets(SIGTERM);
  for (const auto& [id, result] : watch.last_results())
    EXPECT_EQ(result.state, CommandState::kDone) << id << ": " << result.reason;
  for (const auto& [id, count] : watch.results()) EXPECT_EQ(count, 1) << id;
  const auto written = device.writes();
  for (int i = 1; i <= kWrites; ++i)
    EXPECT_EQ(written.count(static_cast<std::uint16_t>(i)), 1u) << i;
  for (const auto& [value, count] : written) EXPECT_EQ(count, 1) << value;
}

}  // namespace
}  // namespace fieldcast
