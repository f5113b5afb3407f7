#include <gtest/gtest.h>
#include <sys/socket.h>

#include <boost/asio/io_context.hpp>
#include <chrono>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/port/device_watch.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

class ReadinessTest : public ::testing::Test {
 protected:
  void SetUp() override {
    int ends[2];
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends), 0);
    ours.reset(ends[0]);
    theirs.reset(ends[1]);
    ASSERT_TRUE(readiness.assign(ours.get()));
  }
  void say() { ASSERT_EQ(::send(theirs.get(), "x", 1, MSG_NOSIGNAL), 1); }
  void wait() {
    readiness.wait_readable([this](boost::system::error_code) { ++told; });
  }
  // Runs ready handlers within the time and returns their number.
  std::size_t run() {
    io.restart();
    return io.run_for(50ms);
  }

  boost::asio::io_context io;
  FileDescriptor ours, theirs;
  Readiness readiness{io};
  int told = 0;
};

TEST_F(ReadinessTest, EachWaitIsReportedOnce) {
  wait();
  EXPECT_EQ(run(), 0u) << "nothing came yet";
  say();
  run();
  EXPECT_EQ(told, 1);
  wait();
  run();
  EXPECT_EQ(told, 2) << "what came before was not taken: it is readable still";
}

TEST_F(ReadinessTest, NobodyIsWokenWhileNobodyWaits) {
  say();
  EXPECT_EQ(run(), 0u);
  wait();
  run();
  EXPECT_EQ(told, 1);
  say();
  EXPECT_EQ(run(), 0u);
  EXPECT_EQ(told, 1);
}

TEST_F(ReadinessTest, ReadingAndWritingAreWaitedForAtTheSameTime) {
  int writable = 0;
  wait();
  readiness.wait_writable([&](boost::system::error_code) { ++writable; });
  run();
  EXPECT_EQ(writable, 1);
  EXPECT_EQ(told, 0);
  say();
  run();
  EXPECT_EQ(writable, 1);
  EXPECT_EQ(told, 1);
}

TEST_F(ReadinessTest, APeerThatGoesIsReported) {
  wait();
  theirs.reset();
  run();
  EXPECT_EQ(told, 1);
}

TEST_F(ReadinessTest, NobodyIsNotifiedAfterTheEnd) {
  wait();
  say();
  readiness.close();
  run();
  EXPECT_EQ(told, 0);
  wait();
  run();
  EXPECT_EQ(told, 0);
}

}  // namespace
}  // namespace fieldcast
