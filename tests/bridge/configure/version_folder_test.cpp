#include "bridge/configure/version_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "bridge/security/file_access.hpp"
#include "tests/bridge/security/scratch_folder.hpp"

namespace fieldcast::configure {
namespace {

using testing::SizeIs;

class VersionFolderTest : public testing::Test {
 protected:
  VersionFolderTest() { std::ofstream(file_) << "bridge: one\n"; }

  test::ScratchFolder scratch_;
  const std::string file_ = scratch_.path("b.yaml");
};

TEST_F(VersionFolderTest, AVersionIsTheHashOfItsText) {
  EXPECT_EQ(version_of("abc"), "ba7816bf8f01cfea");
}

TEST_F(VersionFolderTest, KeepsTextsAndRowsOverARestart) {
  {
    VersionFolder folder(file_);
    folder.add({"1", "anna", "first", {5}, "watching"}, "one");
    folder.add({"2", "bert", "second", {6}, "watching"}, "two");
    folder.set_state("1", "kept");
  }
  const VersionFolder folder(file_);
  ASSERT_THAT(folder.rows(), SizeIs(2));
  EXPECT_EQ(folder.rows()[0].state, "kept");
  EXPECT_EQ(folder.rows()[1].who, "bert");
  EXPECT_EQ(folder.text_of("1"), "one");
  EXPECT_EQ(folder.text_of("3"), std::nullopt);
}

TEST_F(VersionFolderTest, ForgetsTheOldest) {
  VersionFolder folder(file_);
  for (std::size_t i = 0; i <= VersionFolder::kMostVersions; ++i)
    folder.add({std::to_string(i), "", "", {}, ""}, "text");
  EXPECT_THAT(folder.rows(), SizeIs(VersionFolder::kMostVersions));
  EXPECT_FALSE(std::filesystem::exists(file_ + ".versions/0.yaml"));
  EXPECT_TRUE(std::filesystem::exists(file_ + ".versions/1.yaml"));
}

// A deployment adds a row before it replaces the file, and may be rolled back to the file before.
TEST_F(VersionFolderTest, KeepsTheTextInForceAlsoIfItIsTheOldest) {
  VersionFolder folder(file_);
  const std::string base = version_of(folder.present());
  folder.add({base, "", "", {}, "found"}, folder.present());
  for (std::size_t i = 0; i < VersionFolder::kMostVersions; ++i)
    folder.add({std::to_string(i), "", "", {}, ""}, "text");
  EXPECT_THAT(folder.rows(), SizeIs(VersionFolder::kMostVersions));
  EXPECT_FALSE(folder.text_of("0"));
  folder.replace("text");
  folder.restore(base);
  EXPECT_EQ(folder.present(), "bridge: one\n");
}

TEST_F(VersionFolderTest, ReplacesTheFileAndKeepsItsRights) {
  ::chmod(file_.c_str(), 0640);
  VersionFolder folder(file_);
  folder.replace("bridge: two\n");
  struct stat found {};
  ASSERT_EQ(::stat(file_.c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 0777, 0640u);
  EXPECT_EQ(folder.present(), "bridge: two\n");
}

TEST_F(VersionFolderTest, FollowsALink) {
  const std::string link = scratch_.path("link.yaml");
  std::filesystem::create_symlink(file_, link);
  VersionFolder(link).replace("bridge: two\n");
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(security::read_file(file_), "bridge: two\n");
}

TEST_F(VersionFolderTest, OthersCannotReadTheVersions) {
  VersionFolder folder(file_);
  folder.add({"1", "", "", {}, ""}, "one");
  struct stat found {};
  ASSERT_EQ(::stat((file_ + ".versions").c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 077, 0u);
}

TEST_F(VersionFolderTest, ADamagedListDoesNotPreventAChange) {
  std::filesystem::create_directory(file_ + ".versions");
  std::ofstream(file_ + ".versions/versions.json") << "[{\"version\": 7}, 3, ";
  VersionFolder folder(file_);
  folder.add({"1", "", "", {}, ""}, "one");
  EXPECT_THAT(VersionFolder(file_).rows(), SizeIs(1));
}

TEST_F(VersionFolderTest, KeepsTheWatch) {
  VersionFolder folder(file_);
  EXPECT_FALSE(folder.stored_watch());
  folder.store_watch(
      Watch{.version = "2", .base = "1", .who = "anna", .good = {"a/b/c"}, .restarts = 1});
  const auto watch = VersionFolder(file_).stored_watch();
  ASSERT_TRUE(watch);
  EXPECT_EQ(watch->base, "1");
  EXPECT_EQ(watch->restarts, 1);
  EXPECT_THAT(watch->good, testing::ElementsAre("a/b/c"));
  folder.store_watch(std::nullopt);
  EXPECT_FALSE(folder.stored_watch());
}

TEST_F(VersionFolderTest, KeepsTheWatchOfManyChannels) {
  Watch watch{.version = "2", .base = "1"};
  const std::string name = "a-line-of-the-plant/a-device-of-the-line/channel-";
  for (int i = 0; i < 40'000; ++i) watch.good.push_back(name + std::to_string(i));
  VersionFolder(file_).store_watch(watch);
  const auto stored = VersionFolder(file_).stored_watch();
  ASSERT_TRUE(stored);
  EXPECT_EQ(stored->good, watch.good);
}

}  // namespace
}  // namespace fieldcast::configure
