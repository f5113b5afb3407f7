#include "bridge/security/authority.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "bridge/security/file_access.hpp"
#include "bridge/security/member_folder.hpp"
#include "tests/bridge/security/scratch_folder.hpp"

namespace fieldcast::security {
namespace {

using enum MemberRole;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr UtcTime kToday{1'800'000'000'000'000'000};
UtcTime after(Duration duration) { return {kToday.nanoseconds + duration.count()}; }

mode_t mode_of(const std::string& path) {
  struct stat found {};
  EXPECT_EQ(::stat(path.c_str(), &found), 0) << path;
  return found.st_mode & 07777;
}

class AuthorityTest : public testing::Test {
 protected:
  test::ScratchFolder scratch_;
  const std::string folder_ = scratch_.path("ca");
  Authority authority_ = Authority::create(folder_, Protection::kEncrypt, kToday);
};

TEST_F(AuthorityTest, ItsKeysAreForItsOwnerAlone) {
  EXPECT_EQ(mode_of(folder_), 0700U);
  EXPECT_EQ(mode_of(folder_ + "/identity-ca.key"), 0600U);
  EXPECT_EQ(mode_of(folder_ + "/permissions-ca.key"), 0600U);
  const std::string member = authority_.add({kPlant, "mes", {}}, kToday);
  EXPECT_EQ(mode_of(member + "/identity.key"), 0600U);
}

TEST_F(AuthorityTest, NothingThatIsThereIsWrittenOver) {
  const std::string before = read_file(folder_ + "/identity-ca.key");
  EXPECT_THROW(Authority::create(folder_, Protection::kEncrypt, kToday), SecurityError);
  EXPECT_EQ(read_file(folder_ + "/identity-ca.key"), before);
  const std::string member = authority_.add({kPlant, "mes", {}}, kToday);
  const std::string key = read_file(member + "/identity.key");
  EXPECT_THROW(authority_.add({kBridge, "mes", {}}, kToday), SecurityError);
  EXPECT_EQ(read_file(member + "/identity.key"), key);
}

TEST_F(AuthorityTest, AFolderThatIsNoneIsNamed) {
  try {
    Authority none(scratch_.path("nowhere"));
    FAIL();
  } catch (const SecurityError& error) {
    EXPECT_THAT(error.what(), HasSubstr("fieldcast secure init"));
  }
}

TEST_F(AuthorityTest, AMemberHasAllThatItNeeds) {
  const Member mes{kPlant, "mes", {"press-*", "mill"}};
  const std::string folder = authority_.add(mes, kToday);
  const auto read = read_member(folder);
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(*read, mes);
  const MemberCheck check = check_member(folder, kToday);
  EXPECT_THAT(check.faults, IsEmpty());
  EXPECT_THAT(check.warnings, IsEmpty());
  EXPECT_THAT(verified_text(read_file(folder_ + "/permissions-ca.pem"),
                            read_file(folder + "/permissions.p7s")),
              HasSubstr("<partition>press-*</partition>"));
}

TEST_F(AuthorityTest, TheEndIsSaid30DaysAhead) {
  const std::string folder = authority_.add({kStation, "wall", {}}, kToday);
  EXPECT_THAT(check_member(folder, after(334 * kDay)).warnings, IsEmpty());
  const MemberCheck soon = check_member(folder, after(336 * kDay));
  EXPECT_THAT(soon.warnings, ElementsAre(HasSubstr("fieldcast secure renew wall")));
  EXPECT_THAT(soon.faults, IsEmpty());
  EXPECT_THAT(check_member(folder, after(366 * kDay)).faults, ElementsAre(HasSubstr("ended on")));
  EXPECT_THAT(check_member(folder, after(-2 * kDay)).faults,
              testing::Contains(HasSubstr("clock of this machine")));
  authority_.renew("wall", after(336 * kDay));
  EXPECT_THAT(check_member(folder, after(366 * kDay)).faults, IsEmpty());
}

TEST_F(AuthorityTest, RenewalKeepsKeyAndSubject) {
  const std::string folder = authority_.add({kStation, "wall", {}}, kToday);
  const std::string key = read_file(folder + "/identity.key");
  const CertificateFacts before = read_certificate(read_file(folder + "/identity.pem"));
  authority_.renew("wall", after(kDay));
  const CertificateFacts renewed = read_certificate(read_file(folder + "/identity.pem"));
  EXPECT_EQ(read_file(folder + "/identity.key"), key);
  EXPECT_EQ(renewed.subject, before.subject);
  EXPECT_NE(renewed.serial, before.serial);
}

TEST_F(AuthorityTest, RevokingTakesEveryCertificateThatThereWas) {
  const std::string mes = authority_.add({kPlant, "mes", {}}, kToday);
  const std::string wall = authority_.add({kStation, "wall", {}}, kToday);
  const std::string first = read_file(mes + "/identity.pem");
  authority_.renew("mes", after(kDay));
  authority_.revoke("mes", after(2 * kDay));
  const std::string list = read_file(wall + "/revoked.pem");
  EXPECT_TRUE(is_revoked(list, first));
  EXPECT_TRUE(is_revoked(list, read_file(mes + "/identity.pem")));
  EXPECT_FALSE(is_revoked(list, read_file(wall + "/identity.pem")));
  EXPECT_THAT(revoked_subjects(read_file(wall + "/identity-ca.pem"), list),
              ElementsAre(subject_for({MemberRole::kPlant, "mes", {}})));
  EXPECT_THROW((void)revoked_subjects(read_file(wall + "/permissions-ca.pem"), list), SecurityError)
      << "of another authority";
  EXPECT_THAT(check_member(mes, after(2 * kDay)).faults, ElementsAre(HasSubstr("revoked")));
  EXPECT_THROW(authority_.revoke("mes", after(2 * kDay)), SecurityError);
  EXPECT_THROW(authority_.renew("mes", after(2 * kDay)), SecurityError);
  EXPECT_THROW(authority_.revoke("nobody", kToday), SecurityError);
  EXPECT_THROW(authority_.revoke("../members/wall", kToday), SecurityError);
  const auto members = authority_.members().members;
  ASSERT_EQ(members.size(), 2U);
  EXPECT_TRUE(members[0].revoked);
  EXPECT_FALSE(members[1].revoked);
}

TEST_F(AuthorityTest, FilesOfAnotherAuthorityOrMemberAreFound) {
  Authority other = Authority::create(scratch_.path("other"), Protection::kEncrypt, kToday);
  const std::string ours = authority_.add({kPlant, "mes", {}}, kToday);
  const std::string twin = authority_.add({kPlant, "twin", {}}, kToday);
  const std::string theirs = other.add({kPlant, "mes", {}}, kToday);
  const auto with = [&](std::string_view file, const std::string& from) {
    const std::string path = ours + '/' + std::string(file), before = read_file(path);
    replace(path, read_file(from + '/' + std::string(file)), kOwnerOnly);
    const MemberCheck check = check_member(ours, kToday);
    replace(path, before, kOwnerOnly);
    return check.faults;
  };
  EXPECT_THAT(with(kIdentity, theirs), testing::Contains(HasSubstr("another authority")));
  EXPECT_THAT(with(kGovernance, theirs), ElementsAre(HasSubstr("governance.p7s")));
  EXPECT_THAT(with(kPermissions, theirs), ElementsAre(HasSubstr("permissions.p7s")));
  EXPECT_THAT(with(kPermissions, twin), ElementsAre(HasSubstr("for another member")));
  EXPECT_THAT(with(kIdentityKey, twin), ElementsAre(HasSubstr("key is of another")));
  EXPECT_THAT(check_member(ours, kToday).faults, IsEmpty());
}

TEST_F(AuthorityTest, AnOpenKeyAndAMissingFileAreSaid) {
  const std::string folder = authority_.add({kPlant, "mes", {}}, kToday);
  std::filesystem::permissions(folder + "/identity.key", std::filesystem::perms{0644});
  EXPECT_THAT(check_member(folder, kToday).faults, ElementsAre(HasSubstr("chmod 600")));
  std::filesystem::remove(folder + "/governance.p7s");
  EXPECT_THAT(read_member(folder).error(), HasSubstr("governance.p7s is missing"));
  EXPECT_THAT(read_member(folder_).error(), HasSubstr("authority's folder"));
  EXPECT_THAT(read_member(scratch_.path("none")).error(), HasSubstr("there is no folder"));
}

namespace fs = std::filesystem;

// Limits file sizes during its lifetime, which simulates a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : before_(::signal(SIGXFSZ, SIG_IGN)) {
    EXPECT_EQ(::getrlimit(RLIMIT_FSIZE, &limit_), 0);
    const rlimit small{bytes, limit_.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &limit_);
    ::signal(SIGXFSZ, before_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit limit_{};
  const sighandler_t before_;
};

std::map<std::string, std::string> all_files(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    files[entry.path()] = entry.is_directory() ? "a folder" : read_file(entry.path());
  return files;
}

TEST_F(AuthorityTest, AFullDiskLeavesNothingHalfMade) {
  (void)authority_.add({kPlant, "mes", {}}, kToday);
  const auto before = all_files(folder_);
  for (const rlim_t bytes : {0, 100, 700, 2000}) {
    {
      const FullDisk full(bytes);
      EXPECT_THROW(authority_.add({kBridge, "line-7", {}}, kToday), SecurityError) << bytes;
      EXPECT_THROW(authority_.renew("mes", after(kDay)), SecurityError) << bytes;
      EXPECT_THROW((void)Authority::create(scratch_.path("other"), Protection::kEncrypt, kToday),
                   SecurityError);
    }
    EXPECT_EQ(all_files(folder_), before) << bytes;
    EXPECT_FALSE(fs::exists(scratch_.path("other"))) << bytes;
  }
  (void)authority_.add({kBridge, "line-7", {}}, kToday);
  EXPECT_THAT(authority_.revoke("mes", kToday), IsEmpty());
}

TEST_F(AuthorityTest, AFileThatCannotBeReadIsNamedAndKeepsNobodyFromBeingRevoked) {
  const std::string wall = authority_.add({kStation, "wall", {}}, kToday);
  const std::string hall = authority_.add({kStation, "hall", {}}, kToday);
  (void)authority_.add({kPlant, "mes", {}}, kToday);
  const std::ofstream unread(folder_ + "/issued/0123.pem"), cut(hall + "/identity.pem");
  const auto named = [&](const std::vector<std::string>& faults) {
    EXPECT_THAT(faults, ElementsAre(folder_ + "/issued/0123.pem is empty",
                                    hall + "/identity.pem is empty"));
  };
  named(authority_.members().faults);
  EXPECT_EQ(authority_.members().members.size(), 2U);
  named(authority_.revoke("mes", kToday));
  EXPECT_EQ(read_file(wall + "/revoked.pem"), read_file(folder_ + "/revoked.pem"));
  EXPECT_EQ(revoked_subjects(read_file(wall + "/identity-ca.pem"), read_file(wall + "/revoked.pem"))
                .size(),
            1U);
}

TEST_F(AuthorityTest, WhatIsNotAMemberIsNamedAndOtherwiseLeftAlone) {
  const std::string wall = authority_.add({kStation, "wall", {}}, kToday);
  (void)authority_.add({kPlant, "mes", {}}, kToday);
  const std::string members = folder_ + "/members/";
  std::ofstream(members + "x.tgz") << "an archive";
  fs::copy(wall, members + "wall.bak", fs::copy_options::recursive);
  fs::copy(wall, members + "wall-old", fs::copy_options::recursive);
  fs::create_directory(members + "empty");
  const MemberList all = authority_.members();
  EXPECT_EQ(all.members.size(), 2U);
  EXPECT_THAT(all.faults, IsEmpty());
  EXPECT_THAT(all.strays, ElementsAre(HasSubstr("empty is no"), HasSubstr("wall-old is a copy of"),
                                      HasSubstr("wall.bak is no"), HasSubstr("x.tgz is no")));
  EXPECT_THAT(authority_.revoke("mes", kToday), IsEmpty());
  EXPECT_EQ(read_file(wall + "/revoked.pem"), read_file(folder_ + "/revoked.pem"));
}

TEST_F(AuthorityTest, AMemberWhoseFolderIsRemovedIsRevokedByWhatWasIssued) {
  const std::string wall = authority_.add({kStation, "wall", {}}, kToday);
  const std::string mes = authority_.add({kPlant, "mes", {}}, kToday);
  const std::string certificate = read_file(mes + "/identity.pem");
  fs::rename(mes, scratch_.path("mes"));
  EXPECT_THAT(authority_.revoke("mes", kToday), IsEmpty());
  EXPECT_TRUE(is_revoked(read_file(wall + "/revoked.pem"), certificate));
  try {
    (void)authority_.add({kPlant, "mes", {}}, kToday);
    FAIL() << "its name would be refused";
  } catch (const SecurityError& error) {
    EXPECT_THAT(error.what(), HasSubstr("add a member with another name"));
  }
}

TEST_F(AuthorityTest, ASecondTryReachesThoseThatTheFirstLeftOut) {
  const std::string wall = authority_.add({kStation, "wall", {}}, kToday);
  (void)authority_.add({kPlant, "mes", {}}, kToday);
  const std::string before = read_file(wall + "/revoked.pem");
  (void)authority_.revoke("mes", kToday);
  replace(wall + "/revoked.pem", before, kForAll);
  EXPECT_THROW(authority_.revoke("mes", kToday), SecurityError) << "is revoked already";
  EXPECT_EQ(read_file(wall + "/revoked.pem"), read_file(folder_ + "/revoked.pem"));
}

TEST_F(AuthorityTest, WhatOthersMayChangeIsRefusedWithTheRemedy) {
  const std::string folder = authority_.add({kPlant, "mes", {}}, kToday);
  const auto with = [](const std::string& path, int mode, const auto& faults) {
    const auto before = fs::status(path).permissions();
    fs::permissions(path, fs::perms(mode));
    EXPECT_THAT(faults(), testing::Contains(HasSubstr("chmod go-w " + path))) << path;
    fs::permissions(path, before);
    EXPECT_THAT(faults(), IsEmpty()) << path;
  };
  const auto of_member = [&] { return check_member(folder, kToday).faults; };
  with(folder, 0777, of_member);
  with(folder, 0770, of_member);
  for (const std::string_view file : {kIdentityCa, kPermissionsCa, kRevoked, kGovernance, kMember})
    with(folder + '/' + std::string(file), 0666, of_member);
  const auto of_authority = [&] { return authority_faults(folder_); };
  with(folder_, 0777, of_authority);
  for (const char* const part : {"/members", "/issued", "/identity-ca.pem", "/revoked.pem"})
    with(folder_ + part, 0777, of_authority);
  fs::permissions(folder_, fs::perms(0777));
  EXPECT_THROW(Authority{folder_}, SecurityError);
}

// Root can read everything, so this test runs as another user if started as root.
TEST_F(AuthorityTest, AFolderOfAnotherUserIsOneThatCannotBeRead) {
  const std::string folder = authority_.add({kPlant, "mes", {}}, kToday);
  const std::string own = scratch_.path("");
  fs::permissions(own, fs::perms(0755));
  fs::permissions(folder_, fs::perms(::geteuid() == 0 ? 0700 : 0));
  constexpr uid_t kNobody = 65534;
  const uid_t before = ::geteuid();
  ASSERT_EQ(before == 0 ? ::seteuid(kNobody) : 0, 0);
  const MemberCheck check = check_member(folder, kToday);
  const auto authority = authority_faults(folder_);
  ASSERT_EQ(::seteuid(before), 0);
  fs::permissions(folder_, fs::perms(0700));
  EXPECT_THAT(check.faults, ElementsAre(HasSubstr("cannot be read by this user: Permission")));
  EXPECT_THAT(authority, ElementsAre(HasSubstr("cannot be read by this user: Permission")));
}

TEST(MemberText, IsReadBackAndDistrusted) {
  const Member mes{kPlant, "mes", {"press-*"}};
  const auto read = member_from(member_text(mes));
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, mes);
  for (const char* const text : {"", "role: boss\nname: a\n", "name: a\n", "role: plant\n",
                                 "role: plant\nname: a\nkey: b\n", "role: plant\nname: a/b\n"})
    EXPECT_FALSE(member_from(text)) << text;
}

}  // namespace
}  // namespace fieldcast::security
