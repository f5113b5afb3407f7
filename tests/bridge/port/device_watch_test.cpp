#include "bridge/port/device_watch.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "tests/bridge/support/port_probe.hpp"

namespace fieldcast {
namespace {

using std::chrono::milliseconds;
using test::run_until;
namespace fs = std::filesystem;

struct DeviceWatchTest : testing::Test {
  DeviceWatchTest() {
    folder = fs::path(testing::TempDir()) / ("fieldcast-watch-" + std::to_string(::getpid()));
    fs::create_directories(folder);
  }
  ~DeviceWatchTest() override { fs::remove_all(folder); }

  void watch(const fs::path& path) {
    watching.emplace(io, path, [this] { ++came; });
    watching->start(DeviceWatch::identity_of(path));
  }
  // Waits for `times` notifications in total.
  bool told(int times) {
    return run_until(
        io, [&] { return came >= times; }, milliseconds{1000});
  }
  // Waits until pending events are handled: the watch of a second file is notified.
  void settle() {
    bool seen = false;
    const fs::path mark = folder / "mark";
    fs::remove(mark);
    DeviceWatch other(io, mark, [&] { seen = true; });
    other.start(std::nullopt);
    make(mark);
    ASSERT_TRUE(run_until(io, [&] { return seen; }));
  }
  static void make(const fs::path& file) { std::ofstream(file) << ""; }

  boost::asio::io_context io{1};
  fs::path folder;
  int came = 0;
  std::optional<DeviceWatch> watching;
};

TEST_F(DeviceWatchTest, ReportsAFileThatAppears) {
  watch(folder / "ttyUSB0");
  settle();
  EXPECT_EQ(came, 0);
  make(folder / "ttyUSB0");
  EXPECT_TRUE(told(1));
}

TEST_F(DeviceWatchTest, ReportsAFileThatAppearsInAFolderThatAppears) {
  watch(folder / "serial" / "by-id" / "usb-FTDI");
  fs::create_directories(folder / "serial" / "by-id");
  make(folder / "serial" / "by-id" / "usb-FTDI");
  EXPECT_TRUE(told(1));
  fs::remove_all(folder / "serial");
  settle();
  fs::create_directories(folder / "serial" / "by-id");
  make(folder / "serial" / "by-id" / "usb-FTDI");
  EXPECT_TRUE(told(2));
}

TEST_F(DeviceWatchTest, ReportsTheTargetOfALinkThatHangs) {
  fs::create_directories(folder / "by-id");
  fs::create_directories(folder / "dev");
  fs::create_symlink("../dev/ttyUSB0", folder / "by-id" / "usb");
  watch(folder / "by-id" / "usb");
  settle();
  EXPECT_EQ(came, 0);
  make(folder / "dev" / "ttyUSB0");
  EXPECT_TRUE(told(1));
}

TEST_F(DeviceWatchTest, ReportsALinkThatLeadsElsewhere) {
  make(folder / "ttyUSB0");
  make(folder / "ttyUSB1");
  fs::create_symlink(folder / "ttyUSB0", folder / "usb");
  watch(folder / "usb");
  settle();
  EXPECT_EQ(came, 0);  // the file that was already tried
  fs::remove(folder / "usb");
  fs::create_symlink(folder / "ttyUSB1", folder / "usb");
  EXPECT_TRUE(told(1));
}

TEST_F(DeviceWatchTest, ReportsAFileWhoseRightsAreGivenLater) {
  make(folder / "ttyUSB0");
  ASSERT_EQ(::chmod((folder / "ttyUSB0").c_str(), 0), 0);
  watch(folder / "ttyUSB0");
  settle();
  EXPECT_EQ(came, 0);
  ASSERT_EQ(::chmod((folder / "ttyUSB0").c_str(), 0660), 0);
  EXPECT_TRUE(told(1));
}

TEST_F(DeviceWatchTest, IsSilentOnceStopped) {
  watch(folder / "ttyUSB0");
  watching->stop();
  make(folder / "ttyUSB0");
  settle();
  EXPECT_EQ(came, 0);
}

TEST_F(DeviceWatchTest, KnowsEveryFolderOnTheWay) {
  fs::create_directories(folder / "by-id");
  fs::create_symlink("../dev/ttyUSB0", folder / "by-id" / "usb");
  const auto folders = folders_on_the_way(folder / "by-id" / "usb");
  EXPECT_THAT(folders, testing::Contains((folder / "by-id").string()));
  EXPECT_THAT(folders, testing::Contains(folder.string()));
  EXPECT_THAT(folders, testing::Contains("/"));
}

TEST_F(DeviceWatchTest, ALinkToItselfEnds) {
  fs::create_symlink("loop", folder / "loop");
  EXPECT_THAT(folders_on_the_way(folder / "loop"), testing::Contains(folder.string()));
  EXPECT_EQ(DeviceWatch::identity_of(folder / "loop"), std::nullopt);
}

}  // namespace
}  // namespace fieldcast
