#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "config/loader/loader.hpp"
#include "core/capture/pcapng.hpp"
#include "core/capture/pcapng_reader.hpp"
#include "core/model/bus_spec.hpp"
#include "tests/bridge/support/modbus_device.hpp"
#include "tests/support/text_cases.hpp"
#include "tools/cli/command/line/poke.hpp"
#include "tools/cli/command/line/read.hpp"
#include "tools/cli/command/line/scan.hpp"
#include "tools/cli/direct/meanings.hpp"
#include "tools/cli/model/address_notation.hpp"
#include "tools/cli/scan/scan_plan.hpp"

namespace fieldcast::cli {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::unique_ptr<Protocol> protocol(const char* name) {
  return find_protocol(name)->make(DeviceLink{}).value();
}

TEST(AddressSteps, CountInTheNotationOfTheFamily) {
  const auto modbus = protocol("modbus-rtu");
  EXPECT_EQ(address_behind(*modbus, "holding:100", 2), "holding:102");
  EXPECT_EQ(address_behind(*modbus, "40009", 2), "40011");
  EXPECT_EQ(address_behind(*modbus, "holding:65535", 1), std::nullopt);
  EXPECT_EQ(address_behind(*modbus, "nonsense", 1), std::nullopt);
  EXPECT_EQ(address_behind(*protocol("s7-ppi"), "VW100", 2), "VW102");
  EXPECT_EQ(address_behind(*protocol("omron-hostlink"), "DM0009", 1), "DM0010");
}

TEST(Meanings, OfARegisterPairInEveryOrder) {
  const auto meanings = meanings_of("float32,int16");
  ASSERT_TRUE(meanings);
  EXPECT_EQ(meanings->size(), 6u);
  // 1.5 as an IEEE 754 single is 3FC00000.
  const Bytes image{0x3F, 0xC0, 0x00, 0x00};
  const std::vector<std::string> addresses{"holding:0", "holding:1"};
  const auto lines = meaning_lines(addresses, 16, image, *meanings, {});
  std::string text;
  for (const auto& line : lines) text += line + '\n';
  EXPECT_THAT(text, HasSubstr("holding:0  3F C0\n"));
  EXPECT_THAT(text, HasSubstr("  float32                  1.5\n"));
  EXPECT_THAT(text, HasSubstr("  int16                    16320\n"));
  EXPECT_THAT(text, HasSubstr("  int16 bytes swapped      -16321\n"));
}

TEST(Meanings, AllTypesAndWhatIsNone) {
  const auto all = meanings_of("all");
  ASSERT_TRUE(all);
  EXPECT_GT(all->size(), 20u);
  EXPECT_FALSE(meanings_of("flaot32"));
  EXPECT_FALSE(meanings_of(""));
  EXPECT_FALSE(meanings_of("int16,"));
}

struct Ended {
  ExitCode code;
  std::string out, err;
};

struct DirectTest : testing::Test {
  LineOptions line() const {
    return {.port = pty.path(),
            .baud = 115200,
            .format = "8N1",
            .timeout = std::chrono::milliseconds{200}};
  }
  template <typename Run, typename Options>
  Ended run(Run command, const Options& options) {
    std::istringstream in;
    std::ostringstream out, err;
    const auto code = command(options, interrupt, Streams{in, out, err});
    return {code, out.str(), err.str()};
  }
  Ended read(ReadOptions options) { return run(cli::read, options); }
  Ended poke(PokeOptions options) { return run(cli::poke, options); }
  Ended scan(ScanOptions options) { return run(cli::scan, options); }

  test::Pty pty;
  test::ModbusDevice device{pty};
  Interrupt interrupt;
};

TEST_F(DirectTest, ReadsValuesOneBehindTheOther) {
  const auto ended = read({.line = line(), .addresses = {"holding:100"}, .count = 3});
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  EXPECT_EQ(ended.out, "holding:100 = 100\nholding:101 = 101\nholding:102 = 102\n");
}

TEST_F(DirectTest, ReadsMoreThanOneRequestHolds) {
  const auto ended = read({.line = line(), .addresses = {"holding:0"}, .count = 300, .json = true});
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr(",298,299]"));
  EXPECT_EQ(device.reads(), 3u);
}

TEST_F(DirectTest, ShowsWhatRegistersMean) {
  const auto ended = read({.line = line(), .addresses = {"holding:7"}, .count = 2, .as = "uint32"});
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("uint32                   458760"));  // 7 << 16 | 8
  EXPECT_THAT(ended.out, HasSubstr("uint32 words swapped     524295"));
}

TEST_F(DirectTest, SaysWhatADeviceRefuses) {
  const auto ended = read({.line = line(), .addresses = {"coil:1", "holding:5"}});
  EXPECT_EQ(ended.code, ExitCode::kFailed);
  EXPECT_THAT(ended.err, HasSubstr("illegal function"));
  EXPECT_THAT(ended.out, HasSubstr("holding:5 = 5"));
}

TEST_F(DirectTest, SaysWhatIsNotAnAddress) {
  const auto ended = read({.line = line(), .addresses = {"holdin:1"}});
  EXPECT_EQ(ended.code, ExitCode::kUsage);
  EXPECT_THAT(ended.err, HasSubstr("did you mean holding:1?"));
  EXPECT_EQ(device.reads(), 0u);
}

TEST_F(DirectTest, WritesAndReadsBack) {
  const auto ended = poke({.line = line(), .assignments = {"holding:40=1234"}, .verify = true});
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  EXPECT_EQ(ended.out, "holding:40 = 1234: verified (read back 1234)\n");
  EXPECT_EQ(device.held(40), 1234);
}

TEST_F(DirectTest, AWrongValueIsFoundBeforeAnythingIsWritten) {
  const auto ended = poke({.line = line(), .assignments = {"holding:40=1", "holding:41=x"}});
  EXPECT_EQ(ended.code, ExitCode::kUsage);
  EXPECT_THAT(ended.err, HasSubstr("'x' is no number"));
  EXPECT_EQ(device.writes(), 0u);
}

TEST_F(DirectTest, AValueThatDoesNotFitIsFoundBeforeAnythingIsWritten) {
  const auto ended = poke({.line = line(), .assignments = {"holding:40=1", "holding:41=99999"}});
  EXPECT_EQ(ended.code, ExitCode::kRejected);
  EXPECT_EQ(ended.err,
            "holding:41 = 99999: rejected: 99999 does not fit uint16; nothing is written\n");
  EXPECT_EQ(device.writes(), 0u);
}

TEST_F(DirectTest, TheEndOfTheAddressesIsSaid) {
  const auto ended = read({.line = line(), .addresses = {"holding:65535"}, .count = 2});
  EXPECT_EQ(ended.code, ExitCode::kUsage);
  EXPECT_THAT(ended.err, HasSubstr("holding:65535: with 2 values it reaches beyond the end of "
                                   "holding; there is room for 1"));
}

TEST_F(DirectTest, AnAddressThatNoDeviceHasIsSaidByItsOption) {
  LineOptions options = line();
  options.address = 248;
  const auto ended = read({.line = options, .addresses = {"holding:1"}});
  EXPECT_EQ(ended.code, ExitCode::kUsage);
  EXPECT_THAT(ended.err, HasSubstr("--address: address 248 is outside"));
}

TEST(LineOptions, SetTakesOneWordEach) {
  LineOptions options;
  std::vector<std::string> addresses;
  CommandLine line("test", "");
  add_line_options(line, options);
  line.texts("ADDRESS", addresses, "").required();
  const std::vector<const char*> words{"test",       "/dev/ttyS0", "--set",  "mode=fins",
                                       "DM110=1e10", "--set",      "node=3", "DM111=1"};
  const auto ended = line.parse(static_cast<int>(words.size()), words.data());
  EXPECT_FALSE(ended) << ended->text;
  EXPECT_EQ(options.settings, (std::vector<std::string>{"mode=fins", "node=3"}));
  EXPECT_EQ(addresses, (std::vector<std::string>{"DM110=1e10", "DM111=1"}));
}

// A device that responds with one record of values of several widths.
struct RecordTest : DirectTest {
  RecordTest() {
    std::filesystem::create_directory(folder);
    std::ofstream(file) << R"(
summary: a scale
addresses: { from: 1, to: 9 }
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    request:
      - { name: start, constant: "R" }
      - { is: address }
      - { is: checksum, kind: xor, of: start..address }
    answer: &state
      - { name: start, constant: "A" }
      - { is: address }
      - { name: weight, is: value, text: "+000.00" }
      - { name: label, is: value, text: 4 }
      - { name: tare, is: value, bytes: 2, signed: true }
      - { is: checksum, kind: crc16-modbus, of: start..tare, bytes: 2 }
  - name: set
    write: state
    request:
      - { name: start, constant: "W" }
      - { is: address }
      - { name: tare, is: value, bytes: 2, signed: true }
      - { is: checksum, kind: xor, of: start..tare }
    answer: *state
)";
  }
  ~RecordTest() override { std::filesystem::remove_all(folder); }
  LineOptions line() const {
    LineOptions options = DirectTest::line();
    options.protocol = file;
    return options;
  }
  std::string type_of(const char* at) const {
    std::ostringstream err;
    const auto named = named_protocol(file, "read", err);
    EXPECT_TRUE(named) << err.str();
    const auto bus = bus_of(line(), *named);
    EXPECT_TRUE(bus) << bus.error();
    return type_at(at, {}, **make_protocol(bus->devices.front(), LineFormat{})).value_or("?");
  }

  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("fieldcast-record-" + std::to_string(::getpid()));
  const std::string file = folder / "scale.yaml";
};

TEST_F(RecordTest, AValueHasTheTypeOfItsField) {
  EXPECT_EQ(type_of("weight"), "float64");
  EXPECT_EQ(type_of("label"), "string(4)");
  EXPECT_EQ(type_of("tare"), "int16");
  EXPECT_EQ(type_of("tare.3"), "bool");
}

TEST_F(RecordTest, AValueHasNoNeighbours) {
  const auto ended = read({.line = line(), .addresses = {"weight"}, .count = 2});
  EXPECT_EQ(ended.code, ExitCode::kUsage);
  EXPECT_THAT(ended.err, HasSubstr("weight is one value; --count is for what has neighbours"));
  const auto more = poke({.line = line(), .assignments = {"tare=1,2"}});
  EXPECT_EQ(more.code, ExitCode::kRejected);
  EXPECT_THAT(more.err, HasSubstr("'tare' with 2 values reaches beyond the field"));
}

TEST_F(RecordTest, AScanReadsTheRecordWhole) {
  std::ostringstream err;
  const auto named = named_protocol(file, "scan", err);
  ASSERT_TRUE(named) << err.str();
  const auto protocol = scan_protocol(*named);
  const auto questions = questions_of(*named, *protocol);
  ASSERT_EQ(questions.size(), 1u);
  EXPECT_EQ(questions[0].at, "weight");
  EXPECT_EQ(questions[0].range.count, protocol->areas()[0].items);
  const auto lines = scan_lines(*named, {LineFormat{}}, {0, 9, 10});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].addresses, (std::vector<std::uint16_t>{9}));
}

TEST_F(RecordTest, AValueThatNoOperationWritesIsReadOnly) {
  const auto ended = poke({.line = line(), .assignments = {"weight=2.5"}});
  EXPECT_EQ(ended.code, ExitCode::kRejected);
  EXPECT_THAT(ended.err, HasSubstr("'weight' is read-only: the protocol has no operation that "
                                   "writes it alone"));
}

TEST_F(DirectTest, ASilentDeviceIsSaidToBeSilent) {
  device.set_silent(true);
  const auto ended = read({.line = line(), .addresses = {"holding:5"}});
  EXPECT_EQ(ended.code, ExitCode::kFailed);
  EXPECT_THAT(ended.err, HasSubstr("holding:5: "));
}

TEST_F(DirectTest, ScanFindsTheDeviceAndWritesNothingToIt) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("fieldcast-scan-" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  const std::string file = folder / "found.yaml";
  const auto ended = scan({.port = pty.path(),
                           .baud = 115200,
                           .format = "8N1",
                           .addresses = "1-2",
                           .timeout = std::chrono::milliseconds{300},
                           .out = file});
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("modbus-rtu 115200 8N1"));
  EXPECT_EQ(device.writes(), 0u);
  const auto loaded = config::load_file(file);
  EXPECT_TRUE(loaded);
  // An existing file is never overwritten.
  EXPECT_EQ(scan({.port = pty.path(),
                  .baud = 115200,
                  .format = "8N1",
                  .addresses = "1",
                  .timeout = std::chrono::milliseconds{300},
                  .out = file})
                .code,
            ExitCode::kUsage);
  std::filesystem::remove_all(folder);
}

TEST_F(DirectTest, ScanSaysWhichProtocolWasMeant) {
  const auto ended = scan({.port = pty.path(), .protocols = {"modbus-rtz"}});
  EXPECT_EQ(ended.code, ExitCode::kUsage);
  EXPECT_THAT(ended.err, HasSubstr("protocol 'modbus-rtz' is unknown; did you mean modbus-rtu?"));
}

// A line that echoes every byte and has no device.
struct EchoTest : DirectTest {
  EchoTest() {
    device.stop();
    echo = std::thread([this] {
      while (running) {
        pollfd wait{pty.master(), POLLIN, 0};
        if (::poll(&wait, 1, 5) > 0) pty.send(pty.take());
      }
    });
  }
  ~EchoTest() override {
    running = false;
    echo.join();
  }
  std::atomic<bool> running = true;
  std::thread echo;
};

TEST_F(EchoTest, AScanSaysThatWhatWasSentComesBack) {
  const auto ended = scan({.port = pty.path(),
                           .baud = 115200,
                           .format = "8N1",
                           .addresses = "1-10",
                           .timeout = std::chrono::milliseconds{50}});
  EXPECT_EQ(ended.code, ExitCode::kNothing);
  EXPECT_THAT(ended.err, HasSubstr("what was sent comes back, and nothing else"));
  EXPECT_THAT(ended.err, Not(HasSubstr("another master")));
}

// Two devices with address 1: each response has a wrong CRC or is too long.
struct CollisionTest : DirectTest {
  CollisionTest() { device.stop(); }
  Ended scan_with(const Bytes& answer) {
    std::atomic<bool> running = true;
    std::thread devices([&] {
      while (running) {
        pollfd wait{pty.master(), POLLIN, 0};
        if (::poll(&wait, 1, 5) <= 0) continue;
        Bytes all = answer;
        all[1] = pty.take()[1];  // function code
        pty.send(all);
      }
    });
    auto ended = scan({.port = pty.path(),
                       .baud = 115200,
                       .format = "8N1",
                       .addresses = "1",
                       .timeout = std::chrono::milliseconds{100}});
    running = false;
    devices.join();
    return ended;
  }
};

TEST_F(CollisionTest, AScanSaysThatTwoDevicesHaveTheAddress) {
  for (const Bytes& answer : {Bytes{1, 3, 2, 0, 5, 0, 0}, Bytes{1, 3, 2, 0, 5, 0, 0, 1, 3, 2, 0}}) {
    const auto ended = scan_with(answer);
    EXPECT_EQ(ended.code, ExitCode::kNothing);
    EXPECT_THAT(ended.err,
                HasSubstr("address 1, modbus-rtu 115200 8N1: bytes arrive that are not a "
                          "valid response; they begin like its response"));
    EXPECT_THAT(ended.err, HasSubstr("two devices"));
    EXPECT_THAT(ended.err, Not(HasSubstr("the settings are others")));
  }
}

TEST_F(CollisionTest, AScanSaysThatResponsesAreCut) {
  const auto ended = scan_with(Bytes{1, 3, 2, 0});
  EXPECT_EQ(ended.code, ExitCode::kNothing);
  EXPECT_THAT(ended.err, HasSubstr("the end is missing"));
}

TEST(FullPort, NamesOfSerialPortsAreCompleted) {
  test::expect_texts(full_port, {"ttyUSB0 -> /dev/ttyUSB0", "null -> /dev/null", "./x -> ./x",
                                 "/dev/ttyS1 -> /dev/ttyS1", "10.0.0.7:502 -> 10.0.0.7:502"});
  EXPECT_EQ(full_port("plc.local"), "plc.local") << "still no HOST:PORT";
}

TEST_F(DirectTest, ScanTakesARelativePath) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("fieldcast-port-" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  std::filesystem::create_symlink(pty.path(), folder / "adapter");
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder);
  const auto ended = scan({.port = "adapter",
                           .baud = 115200,
                           .format = "8N1",
                           .addresses = "1",
                           .timeout = std::chrono::milliseconds{300}});
  std::filesystem::current_path(before);
  std::filesystem::remove_all(folder);
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("modbus-rtu 115200 8N1"));
}

TEST_F(EchoTest, AReadSaysThatWhatWasSentComesBack) {
  const auto ended = read({.line = line(), .addresses = {"holding:5"}});
  EXPECT_EQ(ended.code, ExitCode::kFailed);
  EXPECT_THAT(ended.err, HasSubstr("what was sent comes back, and nothing else"));
}

TEST_F(DirectTest, ScanSaysThatNobodyResponds) {
  device.set_silent(true);
  const auto ended = scan({.port = pty.path(),
                           .baud = 9600,
                           .format = "8N1",
                           .addresses = "1",
                           .timeout = std::chrono::milliseconds{20}});
  EXPECT_EQ(ended.code, ExitCode::kNothing);
  EXPECT_THAT(ended.err, HasSubstr("no device responded to 2 requests"));
  EXPECT_EQ(ended.out, "");
}

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

TEST_F(DirectTest, APortThatIsNotThereIsSaid) {
  const auto ended = scan({.port = "/dev/fieldcast-none", .addresses = "1"});
  EXPECT_EQ(ended.code, ExitCode::kTrouble);
  EXPECT_THAT(ended.err, HasSubstr("/dev/fieldcast-none"));
}

}  // namespace
}  // namespace fieldcast::cli
