#include "bridge/process/secret.hpp"

#include <gmock/gmock.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

namespace fieldcast {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Secret, KeepsItsTextAndLeavesNoneInTheTextThatItWasTakenFrom) {
  std::string text = "correct horse battery staple";
  const char* memory = text.data();
  const Secret secret = Secret::taken_from(text);
  EXPECT_EQ(secret.text(), "correct horse battery staple");
  EXPECT_TRUE(text.empty());
  EXPECT_EQ(std::string(memory, 28), std::string(28, '\0'));
  const Secret copy = secret;
  EXPECT_EQ(copy.text().data(), secret.text().data());
  EXPECT_TRUE(Secret().empty());
  EXPECT_TRUE(Secret("").text().empty());
}

TEST(Secret, AreComparedWhole) {
  EXPECT_TRUE(same_bytes("secret", "secret"));
  EXPECT_FALSE(same_bytes("secret", "secreT"));
  EXPECT_FALSE(same_bytes("secret", "secret "));
  EXPECT_TRUE(same_bytes("", ""));
}

struct SecretFile : testing::Test {
  SecretFile() { std::filesystem::create_directories(folder); }
  ~SecretFile() override { std::filesystem::remove_all(folder); }
  std::string file(mode_t mode, const std::string& content = "the secret\r\nsecond\n") {
    const std::string path = folder + "/file";
    std::filesystem::remove(path);
    std::ofstream(path) << content;
    EXPECT_EQ(::chmod(path.c_str(), mode), 0);
    return path;
  }
  const std::string folder = testing::TempDir() + "secret-" + std::to_string(::getpid());
};

TEST_F(SecretFile, IsReadWhenNobodyElseMayReadOrChangeIt) {
  struct Case {
    mode_t mode;
    bool owner, group;  // readers that this mode allows
  };
  for (const Case& each :
       {Case{0600, true, true}, Case{0400, true, true}, Case{0700, true, true},
        Case{0640, false, true}, Case{0440, false, true}, Case{0660, false, false},
        Case{0620, false, false}, Case{0604, false, false}, Case{0602, false, false},
        Case{0644, false, false}, Case{0666, false, false}}) {
    const std::string path = file(each.mode);
    EXPECT_EQ(read_secret_line(path, Readers::kOwner).has_value(), each.owner) << each.mode;
    EXPECT_EQ(read_secret_file(path, Readers::kOwnerAndGroup).has_value(), each.group) << each.mode;
    const auto checked = check_secret_file(path, Readers::kOwner);
    EXPECT_EQ(checked.has_value(), each.owner) << each.mode;
    EXPECT_EQ(checked ? "" : checked.error(),
              each.owner ? "" : path + ": others may read or change it; chmod 600 " + path);
  }
  EXPECT_EQ(read_secret_line(file(0600), Readers::kOwner)->text(), "the secret");
  EXPECT_EQ(read_secret_file(file(0600), Readers::kOwner)->text(), "the secret\r\nsecond\n");
}

TEST_F(SecretFile, WhatIsNotASecretIsRefusedInOneLineThatHoldsNothingOfIt) {
  const auto error = [](const tl::expected<Secret, std::string>& read) {
    return read ? "" : read.error();
  };
  EXPECT_THAT(error(read_secret_line(folder + "/none", Readers::kOwner)),
              HasSubstr("none: cannot be read"));
  EXPECT_THAT(error(read_secret_line(folder, Readers::kOwner)), HasSubstr("this is no file"));
  EXPECT_THAT(error(read_secret_line("/dev/zero", Readers::kOwner)), HasSubstr("/dev/zero: "));
  EXPECT_THAT(error(read_secret_line(file(0600, "\nsecond\n"), Readers::kOwner)),
              HasSubstr("its first line is empty"));
  const std::string large =
      error(read_secret_file(file(0600, std::string(kMaxSecretFile + 1, 'x')), Readers::kOwner));
  EXPECT_THAT(large, HasSubstr("too long"));
  EXPECT_THAT(large, Not(HasSubstr("xx")));
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
// Returns the wait status of a process that calls `prepare` and then segfaults.
int killed_by_a_fault(void (*prepare)()) {
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit any{RLIM_INFINITY, RLIM_INFINITY};
    (void)::setrlimit(RLIMIT_CORE, &any);
    if (::chdir("/tmp") != 0) ::_exit(1);
    prepare();
    std::signal(SIGSEGV, SIG_DFL);
    ::raise(SIGSEGV);
    ::_exit(1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

TEST(GuardedProcess, LeavesNoCoreAndItsMemoryIsForNoOtherProcess) {
  const int status = killed_by_a_fault([] {
    guard_memory();
    rlimit core{1, 1};
    ::getrlimit(RLIMIT_CORE, &core);
    if (::prctl(PR_GET_DUMPABLE, 0, 0, 0, 0) != 0 || core.rlim_cur != 0 || core.rlim_max != 0)
      ::_exit(2);
    // Only the limit of locked memory may remain unguarded.
    if (!unguarded_memory().empty() && secrets_are_locked()) ::_exit(3);
  });
  ASSERT_TRUE(WIFSIGNALED(status)) << WEXITSTATUS(status);
  EXPECT_EQ(WTERMSIG(status), SIGSEGV);
  EXPECT_FALSE(WCOREDUMP(status));
}

TEST(GuardedProcess, SaysWhatDoesNotHold) {
  const int wanted = killed_by_a_fault([] {
    ::setenv("FIELDCAST_CORE_DUMPS", "1", 1);
    guard_memory();
    const bool said = unguarded_memory().find("core dump") != std::string::npos;
    ::_exit(::prctl(PR_GET_DUMPABLE, 0, 0, 0, 0) == 1 && said ? 0 : 4);
  });
  EXPECT_EQ(wanted, 0);
  const int little = killed_by_a_fault([] {
    const rlimit none{0, 0};
    ::setrlimit(RLIMIT_MEMLOCK, &none);
    (void)::setresuid(65534, 65534, 65534);  // the limit does not apply to root
    guard_memory();
    const Secret kept("kept all the same");
    const bool said = unguarded_memory().find("swap") != std::string::npos;
    ::_exit(said && kept.text() == "kept all the same" ? 0 : 5);
  });
  EXPECT_EQ(little, 0);
}
#endif

}  // namespace
}  // namespace fieldcast
