#include "bridge/capture/capture_ring.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/capture/pcapng_reader.hpp"

namespace fieldcast {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kNoon = 1'700'000'000 * kSecond;

BusSpec line() {
  BusSpec bus;
  bus.name = "line";
  bus.port = SerialPortSpec{"/dev/line"};
  DeviceSpec device;
  device.name = "meter";
  device.protocol = "modbus-rtu";
  bus.devices.push_back(device);
  return bus;
}

struct ReadFile {
  std::size_t packets = 0;
  std::uint64_t dropped = 0;
  bool whole = false;
};
ReadFile read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  pcapng::Reader reader([&](std::uint8_t* to, std::size_t size) {
    file.read(reinterpret_cast<char*>(to), static_cast<std::streamsize>(size));
    return static_cast<std::size_t>(file.gcount());
  });
  ReadFile found;
  auto packet = reader.next();
  for (; packet && *packet; packet = reader.next()) ++found.packets;
  found.whole = packet.has_value();
  found.dropped = reader.dropped();
  return found;
}

class CaptureRingTest : public testing::Test {
 protected:
  CaptureRingTest() {
    char name[] = "/tmp/fieldcast-ring-XXXXXX";
    folder_ = ::mkdtemp(name);
  }
  ~CaptureRingTest() override { std::filesystem::remove_all(folder_); }

  std::unique_ptr<CaptureRing> ring(std::uint64_t file_bytes, std::uint32_t files) {
    return std::make_unique<CaptureRing>(
        "line", CaptureSpec{folder_, file_bytes, files},
        [this](const std::string& remark) { return capture_.head(remark); });
  }
  static Bytes block(std::uint32_t size) {
    Bytes bytes(size);
    const auto put = [&](std::size_t at, std::uint32_t value) {
      for (unsigned i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
    };
    put(0, 6);
    put(4, size);
    put(20, size - 32);
    put(24, size - 32);
    put(size - 4, size);
    return bytes;
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& each : std::filesystem::directory_iterator(folder_))
      all.push_back(each.path().filename().string());
    std::ranges::sort(all);
    return all;
  }

  std::string folder_;
  const std::shared_ptr<CaptureTap> tap_ = std::make_shared<CaptureTap>();
  BusCapture capture_{line(), "bridge", tap_};
};

TEST_F(CaptureRingTest, AFullFileIsFollowedByTheNextAndTheOldestGoes) {
  const auto all = ring(10'000, 2);
  for (int i = 0; i < 12; ++i) all->packet(block(4000), {kNoon + i * kSecond}, false);
  EXPECT_THAT(names(), ElementsAre("line-20231114T221328Z.pcapng", "line-20231114T221330Z.pcapng"));
  EXPECT_EQ(read_file(folder_ + "/" + names()[0]).packets, 2u);
  EXPECT_TRUE(read_file(folder_ + "/" + names()[0]).whole);
}

TEST_F(CaptureRingTest, OfSessionsAloneNothingElseIsWritten) {
  CaptureRing sessions("line", {.folder = folder_, .only_sessions = true},
                       [this](const std::string& remark) { return capture_.head(remark); });
  sessions.packet(block(400), {kNoon}, false);
  EXPECT_TRUE(names().empty());
  capture_.add(sessions);  // the bus records nothing for it
  EXPECT_FALSE(tap_->wanted());
  EXPECT_TRUE(tap_->sessions_wanted());
  const auto all = ring(10'000, 2);
  capture_.add(*all);
  EXPECT_TRUE(tap_->wanted());
  capture_.remove(*all);
  EXPECT_FALSE(tap_->wanted());
  capture_.remove(sessions);
  EXPECT_FALSE(tap_->sessions_wanted());
  sessions.packet(block(400), {kNoon + kSecond}, true);
  sessions.packet(block(400), {kNoon + 2 * kSecond}, false);
  EXPECT_THAT(names(), ElementsAre("line-20231114T221321Z.pcapng"));
  EXPECT_EQ(read_file(folder_ + "/" + names()[0]).packets, 1u);
}

TEST_F(CaptureRingTest, FilesOfOthersStay) {
  for (const char* other : {"line-2-20200101T000000Z.pcapng", "line-notes.pcapng", "line.pcapng",
                            "line-20200101T000000Z.pcapng.gz"})
    std::ofstream(folder_ + "/" + other) << "x";
  std::ofstream(folder_ + "/line-20200101T000000Z.pcapng") << "x";
  const auto all = ring(10'000, 1);
  all->packet(block(400), {kNoon}, false);
  EXPECT_THAT(names(),
              ElementsAre("line-2-20200101T000000Z.pcapng", "line-20200101T000000Z.pcapng.gz",
                          "line-20231114T221320Z.pcapng", "line-notes.pcapng", "line.pcapng"));
}

TEST_F(CaptureRingTest, NothingIsWrittenOverAndAFileIsForItsOwnerOnly) {
  std::ofstream(folder_ + "/line-20231114T221320Z.pcapng") << "mine";
  const auto all = ring(10'000, 5);
  all->packet(block(400), {kNoon}, false);
  EXPECT_THAT(names(),
              ElementsAre("line-20231114T221320Z-0002.pcapng", "line-20231114T221320Z.pcapng"));
  EXPECT_EQ(std::filesystem::file_size(folder_ + "/line-20231114T221320Z.pcapng"), 4u);
  struct stat about {};
  ASSERT_EQ(::stat((folder_ + "/line-20231114T221320Z-0002.pcapng").c_str(), &about), 0);
  EXPECT_EQ(about.st_mode & 0777, 0600u);
}

TEST_F(CaptureRingTest, AClockThatWentBackTakesOlderFilesAndNotTheNewOne) {
  const auto all = ring(10'000, 2);
  for (int i = 0; i < 2; ++i) all->packet(block(6000), {kNoon + i * kSecond}, false);
  constexpr std::int64_t kEarly = 86'400 * kSecond;  // a clock without a battery
  all->packet(block(6000), {kEarly}, false);
  EXPECT_THAT(names(), ElementsAre("line-19700102T000000Z.pcapng", "line-20231114T221321Z.pcapng"));
  all->packet(block(6000), {kEarly + kSecond}, false);
  EXPECT_THAT(names(), ElementsAre("line-19700102T000000Z.pcapng", "line-19700102T000001Z.pcapng"));
  all->packet(block(6000), {kNoon}, false);  // the clock is correct again
  EXPECT_THAT(names(), ElementsAre("line-19700102T000001Z.pcapng", "line-20231114T221320Z.pcapng"));
}

TEST_F(CaptureRingTest, ManyFilesOfOneSecondStayInTheirOrder) {
  const auto all = ring(10'000, 2);
  for (int i = 0; i < 5; ++i) all->packet(block(6000), {kNoon + i}, false);
  EXPECT_THAT(names(), ElementsAre("line-20231114T221320Z-0004.pcapng",
                                   "line-20231114T221320Z-0005.pcapng"));
}

TEST_F(CaptureRingTest, AFileThatSomebodyDeletesIsFollowedByTheNext) {
  const auto all = ring(10'000, 2);
  all->packet(block(400), {kNoon}, false);
  std::filesystem::remove(folder_ + "/" + names().front());
  all->look({kNoon + 1 * kSecond});
  all->packet(block(400), {kNoon + 2 * kSecond}, false);
  EXPECT_THAT(names(), ElementsAre("line-20231114T221322Z.pcapng"));
}

TEST_F(CaptureRingTest, AMissingFolderIsWaitedFor) {
  std::filesystem::remove(folder_);
  const auto all = ring(10'000, 2);
  all->packet(block(400), {kNoon}, false);
  all->look({kNoon + 1 * kSecond});
  std::filesystem::create_directory(folder_);
  all->look({kNoon + 2 * kSecond});
  all->packet(block(400), {kNoon + 3 * kSecond}, false);
  EXPECT_THAT(names(), ElementsAre("line-20231114T221323Z.pcapng"));
}

// The limit of the process simulates a full disk.
class SmallFiles {
 public:
  explicit SmallFiles(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit small = before_;
    small.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  ~SmallFiles() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, signal_);
  }

 private:
  rlimit before_{};
  void (*signal_)(int) = std::signal(SIGXFSZ, SIG_IGN);
};

TEST_F(CaptureRingTest, WhatDoesNotFitIsTakenBackSoThatTheFileIsWhole) {
  auto file = CaptureFile::make(folder_ + "/x.pcapng");
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->append(capture_.head()));
  ASSERT_TRUE(file->append(block(1000)));
  const auto size = file->size();
  {
    const SmallFiles limit(size + 500);
    const auto refused = file->append(block(1000));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().text, HasSubstr("x.pcapng: File too large"));
  }
  EXPECT_EQ(std::filesystem::file_size(folder_ + "/x.pcapng"), size);
  ASSERT_TRUE(file->append(block(1000)));
  EXPECT_EQ(read_file(folder_ + "/x.pcapng").packets, 2u);
}

TEST_F(CaptureRingTest, AFullDiskStopsItAndItGoesOnWhenThereIsSpace) {
  const auto all = ring(100'000, 5);
  all->packet(block(1000), {kNoon}, false);
  {
    const SmallFiles limit(2000);
    for (int i = 1; i < 5; ++i) all->packet(block(1000), {kNoon + i}, false);
  }
  all->look({kNoon + 1 * kSecond});
  all->packet(block(1000), {kNoon + 2 * kSecond}, false);
  ASSERT_EQ(names().size(), 2u);
  EXPECT_TRUE(read_file(folder_ + "/" + names()[0]).whole);
  EXPECT_EQ(read_file(folder_ + "/" + names()[1]).packets, 1u);
}

TEST(CaptureTap, WhatIsTooMuchIsDroppedAndCounted) {
  CaptureTap tap;
  const Bytes large(1 << 20);
  for (int i = 0; i < 7; ++i) tap.put({.bytes = large});
  auto taken = tap.take();
  EXPECT_EQ(taken.records.size(), 4u);
  EXPECT_EQ(taken.lost, 3u);
  EXPECT_THAT(tap.take().records, IsEmpty());
}

}  // namespace
}  // namespace fieldcast
