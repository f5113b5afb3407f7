#include <filesystem>
#include <fstream>

#include "core/capture/pcapng.hpp"
#include "core/capture/pcapng_reader.hpp"
#include "tests/tools/cli/direct_fixture.hpp"

namespace fieldcast::cli {
namespace {

using testing::Contains;
using testing::StartsWith;

struct CaptureTest : DirectTest {
  CaptureTest() { std::filesystem::create_directory(folder); }
  ~CaptureTest() override { std::filesystem::remove_all(folder); }

  struct Packet {
    Direction direction;
    std::string bytes, comment;
  };
  [[nodiscard]] std::vector<Packet> packets() const {
    std::ifstream file(path, std::ios::binary);
    pcapng::Reader reader([&](std::uint8_t* to, std::size_t size) {
      file.read(reinterpret_cast<char*>(to), static_cast<std::streamsize>(size));
      return static_cast<std::size_t>(file.gcount());
    });
    std::vector<Packet> all;
    for (;;) {
      const auto packet = reader.next();
      EXPECT_TRUE(packet) << to_text(packet.error());
      if (!packet || !*packet) return all;
      const auto pdu = parse_upper_pdu((*packet)->data);
      EXPECT_EQ(pdu->dissector, "mbrtu");
      all.push_back({*(*packet)->direction, to_hex(pdu->frame), (*packet)->comment});
    }
  }

  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("fieldcast-line-" + std::to_string(::getpid()));
  const std::string path = folder / "line.pcapng";
};

TEST_F(CaptureTest, OfAReadHasRequestAndResponse) {
  const auto ended = read({.line = line(), .addresses = {"holding:5"}, .capture = path});
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  const auto all = packets();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].direction, Direction::kSent);
  EXPECT_THAT(all[0].bytes, StartsWith("01 03 00 05 00 01"));
  EXPECT_EQ(all[1].direction, Direction::kReceived);
  EXPECT_THAT(all[1].bytes, StartsWith("01 03 02 00 05"));
  const auto again = read({.line = line(), .addresses = {"holding:5"}, .capture = path});
  EXPECT_EQ(again.code, ExitCode::kTrouble);
  EXPECT_THAT(again.err, HasSubstr("a capture never overwrites a file"));
  EXPECT_EQ(device.reads(), 1u);
}

TEST_F(CaptureTest, OfAWriteHasBoth) {
  const auto ended = poke({.line = line(), .assignments = {"holding:40=7"}, .capture = path});
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  std::vector<std::string> frames;
  for (const Packet& packet : packets()) frames.push_back(packet.bytes);
  EXPECT_THAT(frames, Contains(StartsWith("01 06 00 28 00 07")).Times(2)) << "it is echoed";
}

TEST_F(CaptureTest, OfAScanSaysWhatWasAskedAndWhoWasSilent) {
  const auto ended = scan({.port = pty.path(),
                           .baud = 115200,
                           .format = "8N1",
                           .addresses = "1-2",
                           .timeout = std::chrono::milliseconds{300},
                           .capture = path});
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  const auto all = packets();
  ASSERT_GE(all.size(), 4u);
  EXPECT_THAT(all[0].comment, HasSubstr("the port is open: 115200 8N1"));
  EXPECT_THAT(all[0].comment, HasSubstr("address 1: reads holding:0"));
  EXPECT_EQ(all[1].direction, Direction::kReceived);
  const auto silent = std::ranges::find_if(
      all, [](const Packet& packet) { return packet.bytes.starts_with("02 "); });
  ASSERT_NE(silent, all.end());
  EXPECT_THAT(silent->comment, HasSubstr("address 2: reads holding:0"));
  EXPECT_THAT(silent->comment, HasSubstr(std::string(to_text(Cause::kNoResponse))));
}

TEST_F(CaptureTest, WithoutAFrameNoFileIsLeft) {
  auto nowhere = line();
  nowhere.port = "/dev/fieldcast-none";
  const auto ended = read({.line = nowhere, .addresses = {"holding:5"}, .capture = path});
  EXPECT_EQ(ended.code, ExitCode::kTrouble);
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace fieldcast::cli
