#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "config/loader/loader.hpp"
#include "core/capture/pcapng.hpp"
#include "core/model/bus_spec.hpp"
#include "tests/tools/cli/parsed_json.hpp"
#include "tools/cli/command/line/inspect.hpp"
#include "tools/cli/inspect/value_decoder.hpp"
#include "tools/cli/model/sample_text.hpp"

namespace fieldcast::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* kPlant = R"(bridge: b
buses:
  - name: line
    port: { serial: /dev/line, baud: 9600 }
    protocol: modbus-rtu
    devices:
      - name: meter
        address: 1
        channels:
          - { name: voltage, at: "holding:100", type: uint16, unit: V, scale: 0.1 }
          - { name: current, at: "holding:101", type: int16, unit: A }
          - { name: far, at: "holding:300", type: float32 }
  - name: net
    port: { tcp: 127.0.0.1:502 }
    protocol: modbus-tcp
    devices:
      - name: drive
        address: 1
        channels: [ { name: speed, at: "holding:5", type: uint16, unit: rpm } ]
  - name: press
    port: { serial: /dev/press, baud: 9600 }
    protocol: s7-ppi
    devices:
      - name: plc
        address: 2
        channels:
          - { name: count, at: VW100, type: uint16 }
          - { name: on, at: M0.1 }
  - name: cell
    port: { serial: /dev/cell, baud: 9600, format: 7E2 }
    protocol: omron-hostlink
    devices:
      - name: plc
        address: 1
        options: { mode: fins }
        channels: [ { name: force, at: DM200, type: uint16 } ]
)";

class InspectCapture : public testing::Test {
 protected:
  InspectCapture() {
    char name[] = "/tmp/fieldcast-inspect-XXXXXX";
    folder_ = ::mkdtemp(name);
    std::ofstream(config_ = folder_ + "/plant.yaml") << kPlant;
  }
  ~InspectCapture() override { std::filesystem::remove_all(folder_); }

  struct Inspected {
    ExitCode code;
    std::string out, err;
  };
  static Inspected run(const InspectOptions& options, const std::string& input = {}) {
    std::istringstream in(input);
    std::ostringstream out, err;
    const auto code = inspect(options, Streams{in, out, err});
    return {code, out.str(), err.str()};
  }
  std::string file(const Bytes& bytes) {
    std::ofstream(folder_ + "/x.pcapng", std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    return folder_ + "/x.pcapng";
  }
  static Bytes head() {
    Bytes out;
    pcapng::append_section(out, "test", "");
    pcapng::append_interface(out, "line", "");
    return out;
  }
  static void add(Bytes& out, Direction direction, const std::string& hex,
                  const std::string& comment = {}, const char* dissector = "mbrtu",
                  const char* column = "") {
    const Bytes data = make_upper_pdu(dissector, column, direction, *from_hex(hex));
    pcapng::append_packet(out, {{1'700'000'000'000'000'000}, direction, data, comment});
  }

  std::string folder_, config_;
};

// holding:100..101: 2301, -5
constexpr const char* kRequest = "01 03 00 64 00 02 85 D4";
constexpr const char* kAnswer = "01 03 04 08 FD FF FB 69 D0";

TEST_F(InspectCapture, ValuesComeByTheConfiguration) {
  Bytes bytes = head();
  add(bytes, Direction::kSent, kRequest, "meter: read holding:100..101 (voltage, current)");
  add(bytes, Direction::kReceived, kAnswer);
  const auto shown = run({.protocol = file(bytes), .config = config_});
  EXPECT_THAT(shown.out, HasSubstr("2023-11-14T22:13:20.000Z line >> modbus-rtu 01 03 00 64"));
  EXPECT_THAT(shown.out, HasSubstr("  # meter: read holding:100..101 (voltage, current)\n"));
  EXPECT_THAT(shown.out, HasSubstr("  meter/voltage = 230.1 V\n  meter/current = -5 A\n"));
  EXPECT_EQ(shown.code, ExitCode::kOk) << shown.out;
  EXPECT_EQ(shown.err, "fieldcast inspect: 2 frames, 0 with a fault\n");
}

TEST_F(InspectCapture, ACaptureOfOthersHasNoComments) {
  Bytes bytes = head();
  add(bytes, Direction::kSent, kRequest);
  add(bytes, Direction::kReceived, kAnswer);
  EXPECT_THAT(run({.protocol = file(bytes), .config = config_}).out,
              HasSubstr("meter/voltage = 230.1 V"));
}

// Requests and responses of two devices, with a sum as checksum.
template <typename Add>
void add_instruments(const Add& add) {
  for (std::uint8_t i = 0; i < 20; ++i) {
    const auto finished = [](Bytes frame) {
      unsigned sum = 0;
      for (const std::uint8_t byte : frame) sum += byte;
      frame.push_back(static_cast<std::uint8_t>(sum));
      return to_hex(frame);
    };
    const auto device = static_cast<std::uint8_t>(1 + i % 2);
    add(Direction::kSent, finished({0xAA, device, 0x01}));
    add(Direction::kReceived, finished({0xAA, device, static_cast<std::uint8_t>(7 * i),
                                        static_cast<std::uint8_t>(200 - i)}));
  }
}

TEST_F(InspectCapture, LearnPrintsADeclaration) {
  Bytes bytes = head();
  add_instruments([&](Direction direction, const std::string& hex) { add(bytes, direction, hex); });
  const auto shown = run({.protocol = file(bytes), .learn = true});
  EXPECT_EQ(shown.code, ExitCode::kOk) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("- { is: address }"));
  EXPECT_THAT(shown.out, HasSubstr("- { is: checksum, kind: sum, of: constant..value-1 }"));
  EXPECT_THAT(shown.out, HasSubstr("  # at -1, 20/20\n"));
  EXPECT_THAT(shown.err, HasSubstr("40 frames of line, 0 without a response"));
  EXPECT_THAT(shown.err,
              HasSubstr("the proposal explains 40 of 40 frames in 20 different exchanges"));
  // The output is a declaration as it is.
  EXPECT_TRUE(config::load_declaration_text(shown.out, "mine.yaml"));
}

// The bridge writes the echo of a request as a sent frame.
TEST_F(InspectCapture, LearnSkipsEchoes) {
  Bytes bytes = head();
  add_instruments([&](Direction direction, const std::string& hex) {
    add(bytes, direction, hex);
    if (direction == Direction::kSent) add(bytes, direction, hex, std::string(kEchoComment));
  });
  const auto shown = run({.protocol = file(bytes), .learn = true});
  EXPECT_EQ(shown.code, ExitCode::kOk) << shown.err;
  EXPECT_THAT(shown.err, HasSubstr("40 frames of line, 0 without a response"));
}

TEST_F(InspectCapture, LearnReadsATraceOfTheFirstBus) {
  std::string trace = "not a line of the trace\n";
  add_instruments([&](Direction direction, const std::string& hex) {
    trace += "2026-11-22T14:24:21.126358Z line " +
             std::string(direction == Direction::kSent ? ">> " : "<< ") + hex + '\n';
  });
  trace += "2026-11-22T14:24:21.126358Z other >> 01 02\n";
  const auto shown = run({.learn = true}, trace);
  EXPECT_EQ(shown.code, ExitCode::kOk) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("is: checksum, kind: sum"));
  EXPECT_THAT(shown.err, HasSubstr("; 1 of other buses or without a direction"));
}

TEST_F(InspectCapture, LearnPrintsJsonLines) {
  Bytes bytes = head();
  add_instruments([&](Direction direction, const std::string& hex) { add(bytes, direction, hex); });
  const auto shown = run({.protocol = file(bytes), .json = true, .learn = true});
  const auto row = parsed(shown.out.substr(0, shown.out.find('\n')));
  EXPECT_EQ(row["operation"], "operation 1");
  EXPECT_EQ(row["frame"], "request");
  EXPECT_EQ(row["at"], 0);
  EXPECT_EQ(row["content"], "constant: 0xAA");
}

TEST_F(InspectCapture, LearnRefusesWhatHasNoFrames) {
  const auto empty = run({.protocol = file(head()), .learn = true});
  EXPECT_EQ(empty.code, ExitCode::kFound);
  EXPECT_THAT(empty.err, HasSubstr("no operation can be declared"));
  EXPECT_EQ(empty.out, "");
  EXPECT_EQ(run({.protocol = folder_ + "/missing.pcapng", .learn = true}).code, ExitCode::kUsage);
  EXPECT_EQ(run({.protocol = config_, .learn = true}).code, ExitCode::kUsage);
  EXPECT_EQ(run({.learn = true}, "01 03 00").code, ExitCode::kUsage);
}

TEST_F(InspectCapture, WithoutAConfigurationFramesAreExplained) {
  Bytes bytes = head();
  add(bytes, Direction::kSent, kRequest);
  add(bytes, Direction::kReceived, "01 03 04 08 FD FF FB 12 34");
  const auto shown = run({.protocol = file(bytes)});
  EXPECT_EQ(shown.code, ExitCode::kFound);
  EXPECT_THAT(shown.out, HasSubstr("!! CRC"));
  EXPECT_EQ(shown.err, "fieldcast inspect: 2 frames, 1 with a fault\n");
  EXPECT_THAT(run({.protocol = file(bytes), .fields = true}).out, HasSubstr("function"));
}

// A capture names an installed declaration; it cannot name a file.
TEST_F(InspectCapture, FramesOfDeclarationsAreExplained) {
  Bytes bytes = head();
  const auto add_as = [&](const char* declaration) {
    add(bytes, Direction::kReceived, "68 37 03 00 92 81 39 68 91 06 33 34 34 35 B9 34 AB 16", "",
        "fieldcast-frame", declaration);
  };
  add_as("dlt645-2007");
  const auto shown = run({.protocol = file(bytes), .fields = true});
  EXPECT_EQ(shown.code, ExitCode::kFound);
  EXPECT_THAT(shown.out, HasSubstr("response: read voltage"));
  EXPECT_THAT(shown.out, HasSubstr("should be AA"));
  EXPECT_EQ(shown.err, "fieldcast inspect: 1 frame, 1 with a fault\n");
  add_as("mine");
  add_as("../mine.yaml");
  const auto unknown = run({.protocol = file(bytes), .fields = true});
  EXPECT_THAT(unknown.out, HasSubstr("  not explained: the protocol is unknown\n"));
  EXPECT_EQ(unknown.err,
            "fieldcast inspect: 3 frames, 1 with a fault, 2 of unknown protocols (add --config "
            "FILE)\n");
}

// A piece has the end of a sentence and the beginning of the next one.
TEST_F(InspectCapture, PiecesOfUnsolicitedFramesAreJoined) {
  Bytes bytes = head();
  for (const char* piece :
       {"24 47 47 4D 57 56 2C 2C 2C 2C 2C 2A 36 30 0D 0A 24 47", "47 4D 57 56 2C 2C 2C",
        "2C 2C 2A 36 30 0D 0A 24 47 47 4D 57 56 2C 2C 2C 2C 2C 2A 36 30 0D 0A", "24 47 47"})
    add(bytes, Direction::kReceived, piece, "", "fieldcast-frame", "nmea-0183");
  const auto shown = run({.protocol = file(bytes)});
  EXPECT_EQ(shown.err, "fieldcast inspect: 4 frames, 1 with a fault\n");
  EXPECT_THAT(shown.out, HasSubstr("<< nmea-0183 24 47 47 4D 57 56 2C 2C 2C 2C 2C 2A 36 30 0D 0A"));
  EXPECT_THAT(shown.out, HasSubstr("<< nmea-0183 24 47 47\n"));
}

TEST_F(InspectCapture, ACutFileShowsWhatIsWholeAndNamesTheCut) {
  Bytes bytes = head();
  add(bytes, Direction::kSent, kRequest);
  const std::size_t whole = bytes.size();
  add(bytes, Direction::kReceived, kAnswer);
  bytes.resize(bytes.size() - 5);
  const auto shown = run({.protocol = file(bytes)});
  EXPECT_EQ(shown.code, ExitCode::kFound);
  EXPECT_THAT(shown.out, HasSubstr(">> modbus-rtu"));
  EXPECT_THAT(shown.out, Not(HasSubstr("<<")));
  EXPECT_THAT(shown.err, HasSubstr("x.pcapng is cut in the middle of a block at byte " +
                                   std::to_string(whole) + "; 1 frame before it"));
}

TEST_F(InspectCapture, WhatIsNotACaptureIsRefused) {
  const auto old = run({.protocol = file(*from_hex("D4C3B2A1020004000000000000000000"))});
  EXPECT_EQ(old.code, ExitCode::kUsage);
  EXPECT_THAT(old.err, HasSubstr("save it as pcapng in Wireshark"));
}

// Regression: both had the empty name of a dissector.
TEST_F(InspectCapture, WithoutADissectorTheProtocolIsThatOfTheConfiguration) {
  Bytes bytes = head();
  add(bytes, Direction::kSent, kRequest, "", "");
  const auto unknown = run({.protocol = file(bytes)});
  EXPECT_THAT(unknown.out, HasSubstr("not explained: the protocol is unknown"));
  EXPECT_THAT(run({.protocol = file(bytes), .config = config_}).out,
              HasSubstr(">> modbus-rtu 01 03 00 64"));
}

TEST_F(InspectCapture, APipeIsRead) {
  Bytes bytes = head();
  add(bytes, Direction::kSent, kRequest);
  const std::string pipe = folder_ + "/pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::jthread writer([&] {
    std::ofstream(pipe, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  });
  const auto shown = run({.protocol = pipe});
  EXPECT_THAT(shown.out, HasSubstr(">> modbus-rtu 01 03 00 64"));
  EXPECT_EQ(shown.err, "fieldcast inspect: 1 frame, 0 with a fault\n");
}

TEST_F(InspectCapture, AFileNamedLikeACaptureIsNotAProtocolWhateverIsInIt) {
  const std::string path = folder_ + "/broken.pcapng";
  EXPECT_THAT(run({.protocol = path}).err, HasSubstr("broken.pcapng: No such file"));
  for (const char* text : {"", "\n", "text", "some: declaration"}) {
    std::ofstream(path) << text;
    const Inspected inspected = run({.protocol = path});
    EXPECT_EQ(inspected.code, ExitCode::kUsage);
    EXPECT_THAT(inspected.err, HasSubstr("broken.pcapng is no pcapng file"));
  }
}

TEST_F(InspectCapture, PastedLinesOfATrace) {
  const std::string trace =
      "Nov 22 gate fieldcast-bridge[8]: 2026-11-22T14:24:21.126358Z line >> 01 03 00 64 00 02 85 "
      "D4\nsomething else\n"
      "2026-11-22T14:24:21.136358Z line << 01 03 04\n"
      "2026-11-22T14:24:21.146358Z line << 08 FD FF FB 69 D0\n"
      "2026-11-22T14:24:21.146358Z line -- meter: read holding:100.., 2 items, 2 samples\n";
  const auto shown = run({.config = config_}, trace);
  EXPECT_EQ(shown.code, ExitCode::kOk) << shown.err;
  EXPECT_EQ(shown.out,
            "2026-11-22T14:24:21.126358Z line >> modbus-rtu 01 03 00 64 00 02 85 D4\n"
            "2026-11-22T14:24:21.146358Z line << modbus-rtu 01 03 04 08 FD FF FB 69 D0\n"
            "  meter/voltage = 230.1 V\n"
            "  meter/current = -5 A\n"
            "2026-11-22T14:24:21.146358Z line -- meter: read holding:100.., 2 items, 2 samples\n");
  EXPECT_THAT(run({.protocol = "modbus-rtu"}, trace).out, HasSubstr("line >> modbus-rtu 01 03"));
  EXPECT_THAT(run({.protocol = "modbus-rtu", .hex = {"line >> 01 03 00 64 00 02 85 D4"}}).out,
              HasSubstr("line >> modbus-rtu 01 03"));
  EXPECT_THAT(run({.protocol = "line >> 01 03 00 64 00 02 85 D4", .config = config_}).out,
              HasSubstr("line >> modbus-rtu 01 03"));
}

TEST_F(InspectCapture, JsonHasDirectionCommentAndValues) {
  Bytes bytes = head();
  add(bytes, Direction::kSent, kRequest, "why");
  add(bytes, Direction::kReceived, kAnswer);
  std::istringstream lines(run({.protocol = file(bytes), .json = true, .config = config_}).out);
  std::string first, second;
  std::getline(lines, first);
  std::getline(lines, second);
  EXPECT_EQ(parsed(first)["direction"], "sent");
  EXPECT_EQ(parsed(first)["comment"], "why");
  EXPECT_EQ(parsed(second)["values"][0]["channel"], "voltage");
  EXPECT_EQ(parsed(second)["values"][0]["value"], 230.1);
}

TEST_F(InspectCapture, WithoutAProtocolItAsksForOne) {
  EXPECT_THAT(run({}).err, HasSubstr("which protocol?"));
  EXPECT_THAT(run({.config = config_}, "01 03").err, HasSubstr("the protocol must be named"));
}

class Decoding : public testing::Test {
 protected:
  Decoding() : plant_(*config::load_text(kPlant, "plant.yaml", {})) {}
  static std::vector<std::string> text(const std::vector<DecodedValue>& values) {
    std::vector<std::string> all;
    for (const auto& each : values)
      all.push_back(each.channel + "=" + value_text(each.value, each.type));
    return all;
  }
  BridgeSpec plant_;
};

TEST_F(Decoding, TransactionNumbersOfModbusTcpAreFound) {
  ValueDecoder decoder(plant_.buses[1]);
  for (const char* number : {"12 34", "12 35", "00 01"}) {
    (void)decoder.take(Direction::kSent, *from_hex(std::string(number) + "000000060103 00050001"),
                       {});
    EXPECT_THAT(text(decoder.take(Direction::kReceived,
                                  *from_hex(std::string(number) + "000000050103 0205DC"), {})),
                ElementsAre("speed=1500"));
  }
}

// The sum of a frame is a XOR of its digits, so its digits do not depend on each number.
TEST_F(Decoding, EveryServiceIdOfFinsIsFound) {
  const DeviceSpec& plc = plant_.buses[3].devices[0];
  const auto protocol = *make_protocol(plc, {});
  ValueDecoder decoder(plant_.buses[3]);
  for (std::uint16_t number = 0; number < 256; ++number) {
    Bytes request;
    (void)protocol->begin(ReadRequest{{plc.channels[0].range}}, {number})->start(request);
    EXPECT_THAT(decoder.take(Direction::kSent, request, "plc: read DM:200 (force)"), IsEmpty());
    std::string answer = fmt::format("@01FA00400000{:02X}010100001234", number);
    unsigned sum = 0;
    for (const char digit : answer) sum ^= static_cast<unsigned char>(digit);
    answer += fmt::format("{:02X}*\r", sum);
    EXPECT_THAT(text(decoder.take(Direction::kReceived, Bytes(answer.begin(), answer.end()), {})),
                ElementsAre("force=4660"))
        << number;
  }
}

// With several ranges and rounds, the comment names the one that the frame belongs to. A line with
// echo gives each request back.
TEST_F(Decoding, SeveralRangesAndRoundsByTheComment) {
  constexpr std::string_view kComment = "plc: read V:100..101, M:0 (count, on)";
  const DeviceSpec& plc = plant_.buses[2].devices[0];
  const auto protocol = *make_protocol(plc, {});
  const ReadRequest request{{plc.channels[0].range, plc.channels[1].range}};
  auto exchange = protocol->begin(request, {7});
  Bytes first, poll;
  (void)exchange->start(first);
  const Bytes received{0xE5};
  (void)exchange->on_bytes(received, poll);
  if (poll.empty()) (void)exchange->on_silence(poll);
  // An S7 response with two items: 0x1234 and the byte 02.
  Bytes answer = *from_hex(
      "68 1E 1E 68 00 02 08 32 03 00 00 00 07 00 02 00 0B 00 00 04 02 FF 04 00 10 12 34 FF 04 00 "
      "08 02");
  answer[1] = answer[2] = static_cast<std::uint8_t>(answer.size() - 4);
  std::uint8_t sum = 0;
  for (std::size_t i = 4; i < answer.size(); ++i) sum = static_cast<std::uint8_t>(sum + answer[i]);
  answer.push_back(sum);
  answer.push_back(0x16);
  for (const bool echo : {false, true}) {
    ValueDecoder decoder(plant_.buses[2]);
    const auto send = [&](const Bytes& frame) {
      EXPECT_THAT(decoder.take(Direction::kSent, frame, kComment), IsEmpty());
      if (echo) { EXPECT_THAT(decoder.take(Direction::kSent, frame, kEchoComment), IsEmpty()); }
    };
    send(first);
    EXPECT_THAT(decoder.take(Direction::kReceived, received, {}), IsEmpty());
    send(poll);
    EXPECT_THAT(text(decoder.take(Direction::kReceived, answer, {})),
                ElementsAre("count=4660", "on=true"))
        << echo;
  }
}

TEST_F(Decoding, AResponseToNobodyHasNoValues) {
  ValueDecoder decoder(plant_.buses[0]);
  EXPECT_THAT(decoder.take(Direction::kReceived, *from_hex(kAnswer), {}), IsEmpty());
  (void)decoder.take(Direction::kSent, *from_hex("01 06 00 64 00 01 08 15"), {});
  EXPECT_THAT(decoder.take(Direction::kReceived, *from_hex(kAnswer), {}), IsEmpty());
}

}  // namespace
}  // namespace fieldcast::cli
