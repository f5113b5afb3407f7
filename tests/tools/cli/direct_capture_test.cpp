#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <filesystem>
#include <fstream>
#include <thread>

#include "core/bus/wire/exchange_driver.hpp"
#include "core/capture/capture_record.hpp"
#include "core/capture/pcapng.hpp"
#include "core/capture/pcapng_reader.hpp"
#include "tests/tools/cli/direct_fixture.hpp"
#include "tools/cli/arguments.hpp"

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

// `fieldcast replay` of a capture at a TCP port.
struct ReplayTest : testing::Test {
  ReplayTest() {
    pcapng::append_section(capture, "test", "");
    pcapng::append_interface(capture, "line", "");
  }
  ~ReplayTest() override { std::filesystem::remove(path); }

  void add(Direction direction, const Bytes& bytes, std::string_view comment = {}) {
    pcapng::append_packet(capture, {{1'700'000'000'000'000'000},
                                    direction,
                                    make_upper_pdu("mbrtu", "", direction, bytes),
                                    std::string(comment)});
  }
  Ended replay() {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(capture.data()),
               static_cast<std::streamsize>(capture.size()));
    const std::string port = "127.0.0.1:" + std::to_string(acceptor.local_endpoint().port());
    const char* const words[] = {"fieldcast", "replay", path.c_str(), port.c_str()};
    const auto parsed = parse_arguments(4, words);
    EXPECT_TRUE(parsed) << parsed.error().text;
    std::istringstream in;
    std::ostringstream out, err;
    const ExitCode code = (*parsed)->run({in, out, err});
    return {code, out.str(), err.str()};
  }

  Bytes capture;
  const std::string path = std::filesystem::temp_directory_path() /
                           ("fieldcast-replay-" + std::to_string(::getpid()) + ".pcapng");
  boost::asio::io_context io;
  boost::asio::ip::tcp::acceptor acceptor{io, {boost::asio::ip::address_v4::loopback(), 0}};
};

// A line that sends endlessly, and a recorded request without a response.
TEST_F(ReplayTest, AnEndlessResponseIsAFault) {
  add(Direction::kSent, {1}, kSessionComment);
  std::jthread device([&] {
    boost::asio::ip::tcp::socket peer = acceptor.accept();
    boost::system::error_code closed;
    Bytes bytes(1);
    boost::asio::read(peer, boost::asio::buffer(bytes), closed);
    bytes.resize(ExchangeDriver::kMaxReceived);
    while (!closed) boost::asio::write(peer, boost::asio::buffer(bytes), closed);
  });
  const auto ended = replay();
  EXPECT_EQ(ended.code, ExitCode::kTrouble);
  EXPECT_EQ(ended.err, "fieldcast replay: request 1: the line sent more than 8192 bytes\n");
}

// The adapter of the recorded line had an echo; the line of the replay has none.
TEST_F(ReplayTest, TheEchoOfARequestIsNotARequest) {
  const Bytes request{0x40, 0x30}, response{0x41, 0x31, 0x0D};
  const std::string user = std::string(kSessionComment) + "anna";
  for (int i = 0; i < 2; ++i) {
    add(Direction::kSent, request, user);
    add(Direction::kSent, request, kEchoComment);
    add(Direction::kReceived, response);
  }
  std::jthread device([&] {
    boost::asio::ip::tcp::socket peer = acceptor.accept();
    boost::system::error_code closed;
    for (Bytes bytes = request; !closed;) {
      boost::asio::read(peer, boost::asio::buffer(bytes), closed);
      if (!closed) boost::asio::write(peer, boost::asio::buffer(response), closed);
    }
  });
  const auto ended = replay();
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  EXPECT_EQ(ended.out, "2 requests, 0 with another response\n");
}

}  // namespace
}  // namespace fieldcast::cli
