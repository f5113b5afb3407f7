#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bridge/standby/member_identity.hpp"

namespace fieldcast {
namespace {

struct Child {
  Child() {
    int ends[2];
    if (::pipe(ends) != 0) std::abort();
    pid = ::fork();
    if (pid == 0) {
      const std::string own = own_process_identity();
      (void)!::write(ends[1], own.data(), own.size());
      ::close(ends[1]);
      ::pause();
      ::_exit(0);
    }
    ::close(ends[1]);
    char buffer[256];
    for (ssize_t size = 0; (size = ::read(ends[0], buffer, sizeof buffer)) > 0;) {
      identity.append(buffer, static_cast<std::size_t>(size));
      if (identity.size() > 60) break;
    }
    ::close(ends[0]);
  }
  pid_t pid = 0;
  std::string identity;
};

TEST(ProcessIdentity, TellsWhetherAProcessOfThisKernelHasEnded) {
  const Child child;
  EXPECT_FALSE(has_ended(child.identity)) << child.identity;
  ::kill(child.pid, SIGKILL);
  siginfo_t ended{};
  ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(child.pid), &ended, WEXITED | WNOWAIT), 0);
  EXPECT_TRUE(has_ended(child.identity)) << "not yet waited for";
  ::waitpid(child.pid, nullptr, 0);
  EXPECT_TRUE(has_ended(child.identity));
  EXPECT_FALSE(has_ended(own_process_identity()));
}

TEST(ProcessIdentity, SaysNothingOfOtherMachinesAndContainers) {
  for (const char* other : {"", "x", "boot/pid:[1]/999999/5", "////"})
    EXPECT_FALSE(has_ended(other));
  std::string same_pid = own_process_identity();
  same_pid += '0';  // another start time: not the same process
  EXPECT_TRUE(has_ended(same_pid));
}

}  // namespace
}  // namespace fieldcast
