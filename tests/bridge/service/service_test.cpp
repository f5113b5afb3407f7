#include "bridge/service/service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstring>

#include "bridge/dds/library/library.hpp"
#include "bridge/service/process_watch.hpp"

namespace fieldcast {
namespace {

using std::chrono::seconds;
using testing::HasSubstr;

constexpr Instant kStart{seconds{1000}};

// Replaces systemd: an abstract socket.
struct Manager {
  Manager() : address("@fieldcast-service-test-" + std::to_string(::getpid())) {
    socket.reset(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    std::memcpy(at.sun_path + 1, address.data() + 1, address.size() - 1);
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address.size());
    EXPECT_EQ(::bind(socket.get(), reinterpret_cast<const sockaddr*>(&at), size), 0);
  }
  // Returns the oldest unread message, empty if there is none.
  std::string take() {
    std::array<char, 4096> buffer{};
    const ssize_t size = ::recv(socket.get(), buffer.data(), buffer.size(), 0);
    return size > 0 ? std::string(buffer.data(), static_cast<std::size_t>(size)) : "";
  }
  std::string address;
  FileDescriptor socket;
};

TEST(StandingBus, IsTheOneThatHasStoodForLongest) {
  const std::vector<BusTurn> turns{{"one", kStart}, {"two", kStart - seconds{9}}, {"three", {}}};
  const auto standing = standing_bus({turns[0], turns[1]}, kStart, seconds{5});
  ASSERT_TRUE(standing);
  EXPECT_EQ(standing->bus, "two");
  EXPECT_EQ(standing->standing, seconds{9});
  EXPECT_EQ(standing_bus(turns, kStart, seconds{5})->bus, "three");
}

TEST(StandingBus, IsNoneWithinTheLimitAndWithoutBuses) {
  EXPECT_FALSE(standing_bus({{"one", kStart - seconds{5}}}, kStart, seconds{5}));
  EXPECT_FALSE(standing_bus({}, kStart, seconds{5}));
}

TEST(Service, SaysWhenItIsReadyReloadsAndStops) {
  Manager manager;
  Service service(manager.address, std::nullopt);
  service.ready("2 buses");
  EXPECT_EQ(manager.take(), "READY=1\nSTATUS=2 buses");
  service.reloading(kStart);
  EXPECT_THAT(manager.take(), HasSubstr("RELOADING=1\nMONOTONIC_USEC=1000000000\n"));
  service.stopping();
  EXPECT_THAT(manager.take(), HasSubstr("STOPPING=1\n"));
}

TEST(Service, FeedsTheWatchdogOnlyWhileEveryBusTurns) {
  Manager manager;
  Service service(manager.address, seconds{30});
  service.look({{"one", kStart}, {"two", kStart}}, kStart);
  EXPECT_EQ(manager.take(), "WATCHDOG=1");
  service.look({{"one", kStart + seconds{16}}, {"two", kStart}}, kStart + seconds{16});
  EXPECT_THAT(manager.take(), HasSubstr("STATUS=two: the bus stands"));
  service.look({{"one", kStart + seconds{17}}, {"two", kStart}}, kStart + seconds{17});
  EXPECT_EQ(manager.take(), "") << "said once, and not fed";
  service.look({{"one", kStart + seconds{18}}, {"two", kStart + seconds{18}}},
               kStart + seconds{18});
  EXPECT_EQ(manager.take(), "STATUS=all buses turn");
  EXPECT_EQ(manager.take(), "WATCHDOG=1");
}

TEST(Service, WakesThreeTimesWithinTheWatchdogsLimit) {
  EXPECT_EQ(Service("", seconds{3}).sleep(seconds{10}), seconds{1});
  EXPECT_EQ(Service("", seconds{90}).sleep(seconds{10}), seconds{10});
  EXPECT_EQ(Service("", std::nullopt).sleep(seconds{10}), seconds{10});
}

TEST(Service, WithoutAManagerSaysNothing) {
  Service("", seconds{3}).ready("");
  Service("/nobody/listens", seconds{3}).ready("");
  Service(std::string(300, 'x'), seconds{3}).ready("");
}

TEST(WatchdogLimit, IsForThisProcessOnly) {
  ::setenv("WATCHDOG_USEC", "3000000", 1);
  EXPECT_EQ(watchdog_limit(), std::optional<Duration>(seconds{3}));
  ::setenv("WATCHDOG_USEC", "7200000000", 1);  // more than 32 bits
  EXPECT_EQ(watchdog_limit(), std::optional<Duration>(seconds{7200}));
  ::setenv("WATCHDOG_USEC", "3000000", 1);
  ::setenv("WATCHDOG_PID", "1", 1);
  EXPECT_EQ(watchdog_limit(), std::nullopt);
  ::setenv("WATCHDOG_PID", std::to_string(::getpid()).c_str(), 1);
  EXPECT_EQ(watchdog_limit(), std::optional<Duration>(seconds{3}));
  for (const char* text : {"", "0", "-1", "soon"}) {
    ::setenv("WATCHDOG_USEC", text, 1);
    EXPECT_EQ(watchdog_limit(), std::nullopt) << text;
  }
  ::unsetenv("WATCHDOG_USEC");
  ::unsetenv("WATCHDOG_PID");
}

constexpr std::int64_t kSecond = 1'000'000'000, kDay = 86'400 * kSecond;
constexpr UtcTime kToday{1'800'000'000 * kSecond};
UtcTime after(std::int64_t nanoseconds) { return {kToday.nanoseconds + nanoseconds}; }

TEST(IdentityWatch, LooksOnceADay) {
  EXPECT_FALSE(is_look_due(std::nullopt, kToday, kToday));
  EXPECT_FALSE(is_look_due(std::nullopt, kToday, after(kDay - 1)));
  EXPECT_TRUE(is_look_due(std::nullopt, kToday, after(kDay)));
  EXPECT_FALSE(is_look_due(after(400 * kDay), after(kDay), after(2 * kDay - 1)));
}

TEST(IdentityWatch, LooksWhenTheCertificateEndsAndThenOnceADay) {
  const UtcTime end = after(100);
  EXPECT_FALSE(is_look_due(end, kToday, after(99)));
  EXPECT_TRUE(is_look_due(end, kToday, end)) << "good until then, not at it";
  EXPECT_TRUE(is_look_due(end, kToday, after(kSecond)));
  EXPECT_FALSE(is_look_due(end, end, after(kSecond))) << "it was said";
  EXPECT_TRUE(is_look_due(end, end, after(100 + kDay)));
}

TEST(IdentityWatch, LooksAgainWhenTheClockWasSetBack) {
  EXPECT_TRUE(is_look_due(after(10 * kDay), after(kSecond), kToday));
}

// Runtimes of containers pass SIGURG on, which the Go runtime sends to itself. It once meant this.
TEST(Signals, OnlyAMemberOfThisProcessReportsThatItWasRemoved) {
  Signals signals;
  ::kill(::getpid(), SIGURG);
  report_removed();
  report_removed();
  EXPECT_EQ(signals.wait(seconds{10}), Signals::kRemoved);
  EXPECT_EQ(signals.wait({}), 0);
}

}  // namespace
}  // namespace fieldcast
