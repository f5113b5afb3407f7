#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "bridge/capture/capture_folder.hpp"

namespace fieldcast {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class CaptureCheck : public testing::Test {
 protected:
  CaptureCheck() {
    char name[] = "/tmp/fieldcast-check-XXXXXX";
    folder_ = ::mkdtemp(name);
  }
  ~CaptureCheck() override { std::filesystem::remove_all(folder_); }

  static BusSpec bus(const std::string& name, const std::string& folder, std::uint64_t bytes) {
    BusSpec made;
    made.name = name;
    made.capture = CaptureSpec{folder, bytes, 2};
    return made;
  }
  static std::vector<CaptureRemark> check(std::vector<BusSpec> buses) {
    BridgeSpec spec;
    spec.buses = std::move(buses);
    return capture_remarks(spec);
  }
  [[nodiscard]] std::uint64_t free() const { return free_bytes_at(folder_).value(); }

  std::string folder_;
};

TEST_F(CaptureCheck, AFolderThatTakesEverythingAndABusWithoutACaptureAreNoRemark) {
  EXPECT_THAT(check({bus("a", folder_, 100'000), BusSpec{}}), IsEmpty());
}

TEST_F(CaptureCheck, WhatIsMissingOrNoFolderIsSaidWithARemedy) {
  std::ofstream(folder_ + "/file") << "x";
  const auto remarks =
      check({bus("a", folder_ + "/none", 100'000), bus("b", folder_ + "/file", 100'000),
             bus("c", folder_ + "/file/below", 100'000)});
  ASSERT_THAT(remarks, SizeIs(3));
  EXPECT_EQ(remarks[0].bus, "a");
  EXPECT_THAT(remarks[0].what, HasSubstr("No such file or directory"));
  EXPECT_THAT(remarks[0].remedy, HasSubstr("mkdir " + folder_ + "/none"));
  EXPECT_THAT(remarks[1].what, HasSubstr("no folder"));
  EXPECT_THAT(remarks[2].what, HasSubstr("Not a directory"));
}

TEST_F(CaptureCheck, AFolderOfAnotherUserIsARemark) {
  ::chmod(folder_.c_str(), 0500);
  // Root can write everywhere, so the check runs as another user.
  const bool root = ::geteuid() == 0;
  if (root) { ASSERT_EQ(::seteuid(65534), 0); }
  const auto remarks = check({bus("a", folder_, 100'000)});
  if (root) { ASSERT_EQ(::seteuid(0), 0); }
  ASSERT_THAT(remarks, SizeIs(1));
  EXPECT_THAT(remarks[0].what, HasSubstr("Permission denied"));
}

TEST_F(CaptureCheck, BusesOnOneDiskShareItsSpace) {
  // Each alone has space: two files of a quarter. Other programs may fill the disk meanwhile.
  const std::uint64_t bytes = free() / 8 * 3;
  EXPECT_THAT(check({bus("a", folder_, bytes)}), IsEmpty());
  const auto remarks = check({bus("a", folder_, bytes), bus("b", folder_, bytes)});
  ASSERT_THAT(remarks, SizeIs(1));
  EXPECT_EQ(remarks[0].bus, "b");
  EXPECT_THAT(remarks[0].what, HasSubstr("MB more, and "));
}

TEST_F(CaptureCheck, FilesThatAreThereMakeRoomForTheNext) {
  const std::uint64_t bytes = free();
  EXPECT_THAT(check({bus("a", folder_, bytes)}), SizeIs(1));
  // A sparse file uses no space but has its size.
  const std::string name = folder_ + "/" + ring_file_name("a", {}, 1);
  std::ofstream(name) << "x";
  std::filesystem::resize_file(name, 2 * bytes);
  EXPECT_THAT(check({bus("a", folder_, bytes)}), IsEmpty());
}

}  // namespace
}  // namespace fieldcast
