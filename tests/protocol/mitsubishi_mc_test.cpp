#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "core/protocol/families/registry.hpp"
#include "tests/support/device.hpp"
#include "tests/support/drive.hpp"
#include "tests/support/matrix.hpp"
#include "tests/support/text_cases.hpp"

namespace fieldcast::test {
namespace {

using Options = std::map<std::string, std::string>;

Device mc_plc(const Options& options = {}, std::uint16_t address = 0) {
  return {"mitsubishi-mc", address, options};
}
const Options kFour{{"frame", "4e"}}, kAscii{{"code", "ascii"}}, kSeriesR{{"series", "iqr"}};
const Options kFourAscii{{"frame", "4e"}, {"code", "ascii"}};
const Options kSeriesRAscii{{"series", "iqr"}, {"code", "ascii"}};

Bytes hex(std::string_view digits) { return from_hex(digits).value_or(Bytes{}); }
Bytes text(std::string_view characters) { return {characters.begin(), characters.end()}; }

Outcome run(const Device& device, const Request& request, const Bytes& answer,
            std::uint16_t sequence = 0) {
  const auto exchange = device.begin(request, sequence);
  return drive(*exchange, answer);
}
Bytes values(const Device& device, const Request& request, const Bytes& answer,
             std::uint16_t sequence = 0) {
  const Outcome outcome = run(device, request, answer, sequence);
  EXPECT_TRUE(outcome.done()) << to_text(outcome);
  Bytes all;
  for (const RangeReply& range : outcome.reply) append(all, range.items);
  return all;
}

// The commands and their data are the communication examples of SH-080008, 8.2 and 8.3; the frame
// around them follows 5.2, with the route of the connected station and a timer of 1 s.
struct Golden {
  std::string_view name;
  Options options;
  std::uint16_t sequence;
  Bytes request, response;
};

const std::vector<Golden>& reads_of_timers() {
  static const std::vector<Golden> all{
      {"3E binary",
       {},
       0,
       hex("50 00 00 FF FF 03 00 0C 00 04 00 01 04 00 00 64 00 00 C2 03 00"),
       hex("D0 00 00 FF FF 03 00 08 00 00 00 34 12 02 00 EF 1D")},
      {"3E ASCII", kAscii, 0, text("500000FF03FF000018000404010000TN0001000003"),
       text("D00000FF03FF0000100000123400021DEF")},
      {"4E binary", kFour, 0x1234,
       hex("54 00 34 12 00 00 00 FF FF 03 00 0C 00 04 00 01 04 00 00 64 00 00 C2 03 00"),
       hex("D4 00 34 12 00 00 00 FF FF 03 00 08 00 00 00 34 12 02 00 EF 1D")},
      {"4E ASCII", kFourAscii, 0x1234, text("54001234000000FF03FF000018000404010000TN0001000003"),
       text("D4001234000000FF03FF0000100000123400021DEF")},
      {"iQ-R binary", kSeriesR, 0,
       hex("50 00 00 FF FF 03 00 0E 00 04 00 01 04 02 00 64 00 00 00 C2 00 03 00"),
       hex("D0 00 00 FF FF 03 00 08 00 00 00 34 12 02 00 EF 1D")},
      {"iQ-R ASCII", kSeriesRAscii, 0, text("500000FF03FF00001C000404010002TN**000001000003"),
       text("D00000FF03FF0000100000123400021DEF")},
  };
  return all;
}

TEST(MitsubishiMc, ReadsWordsAsTheManualShows) {
  for (const Golden& golden : reads_of_timers()) {
    SCOPED_TRACE(golden.name);
    const Device device = mc_plc(golden.options);
    const Request request = device.read("TN100", 3);
    EXPECT_EQ(device.request_bytes(request, golden.sequence), golden.request);
    EXPECT_EQ(values(device, request, golden.response, golden.sequence),
              (Bytes{0x12, 0x34, 0x00, 0x02, 0x1D, 0xEF}));
    const auto size = device.protocol().size(request);
    ASSERT_TRUE(size);
    EXPECT_EQ(size->request_characters, golden.request.size());
    EXPECT_EQ(size->response_characters, golden.response.size());
  }
}

TEST(MitsubishiMc, ReadsBitsAsTheManualShows) {
  const Bytes bits{0, 0, 0, 1, 0, 0, 1, 1};
  const Device binary = mc_plc(), ascii = mc_plc(kAscii);
  EXPECT_EQ(binary.request_bytes(binary.read("M100", 8)),
            hex("50 00 00 FF FF 03 00 0C 00 04 00 01 04 01 00 64 00 00 90 08 00"));
  EXPECT_EQ(
      values(binary, binary.read("M100", 8), hex("D0 00 00 FF FF 03 00 06 00 00 00 00 01 00 11")),
      bits);
  EXPECT_EQ(ascii.request_bytes(ascii.read("M100", 8)),
            text("500000FF03FF000018000404010001M*0001000008"));
  EXPECT_EQ(values(ascii, ascii.read("M100", 8), text("D00000FF03FF00000C000000010011")), bits);
}

TEST(MitsubishiMc, WritesAsTheManualShows) {
  const Device binary = mc_plc(), ascii = mc_plc(kAscii);
  EXPECT_EQ(
      binary.request_bytes(binary.write("D100", "1995 1202 1130")),
      hex("50 00 00 FF FF 03 00 12 00 04 00 01 14 00 00 64 00 00 A8 03 00 95 19 02 12 30 11"));
  EXPECT_EQ(ascii.request_bytes(ascii.write("D100", "1995 1202 1130")),
            text("500000FF03FF000024000414010000D*0001000003199512021130"));
  const std::string_view bits = "01 01 00 00 01 01 00 00";
  EXPECT_EQ(binary.request_bytes(binary.write("M100", bits)),
            hex("50 00 00 FF FF 03 00 10 00 04 00 01 14 01 00 64 00 00 90 08 00 11 00 11 00"));
  EXPECT_EQ(ascii.request_bytes(ascii.write("M100", bits)),
            text("500000FF03FF000020000414010001M*000100000811001100"));
  EXPECT_TRUE(
      run(binary, binary.write("D100", "1995"), hex("D0 00 00 FF FF 03 00 02 00 00 00")).done());
  EXPECT_TRUE(run(ascii, ascii.write("D100", "1995"), text("D00000FF03FF0000040000")).done());
}

// The example of the random read without its double words and M100, which does not begin at a
// multiple of 16.
TEST(MitsubishiMc, ReadsAListAsTheManualShows) {
  const Device binary = mc_plc(), ascii = mc_plc(kAscii);
  const Request request =
      ReadRequest{{binary.range("D0"), binary.range("TN0"), binary.range("X20", 16)}};
  EXPECT_EQ(binary.request_bytes(request),
            hex("50 00 00 FF FF 03 00 14 00 04 00 03 04 00 00 03 00 00 00 00 A8 00 00 00 C2 20 00 "
                "00 9C"));
  EXPECT_EQ(ascii.request_bytes(request),
            text("500000FF03FF0000280004040300000300D*000000TN000000X*000020"));
  const Bytes expected{0x19, 0x95, 0x12, 0x02, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0};
  EXPECT_EQ(values(binary, request, hex("D0 00 00 FF FF 03 00 08 00 00 00 95 19 02 12 49 48")),
            expected);
  EXPECT_EQ(values(ascii, request, text("D00000FF03FF0000100000199512024849")), expected);
}

TEST(MitsubishiMc, BitsOfAListAreReadInWholeWords) {
  const Device device = mc_plc();
  const Request request = ReadRequest{{device.range("M15", 2), device.range("D5")}};
  EXPECT_EQ(device.request_bytes(request),
            hex("50 00 00 FF FF 03 00 14 00 04 00 03 04 00 00 03 00 00 00 00 90 10 00 00 90 05 00 "
                "00 A8"));
  EXPECT_EQ(values(device, request, hex("D0 00 00 FF FF 03 00 08 00 00 00 00 80 01 00 07 00")),
            (Bytes{1, 1, 0x00, 0x07}));
}

TEST(MitsubishiMc, FileRegistersHaveDecimalNumbersThatAsciiCodeWritesInHexadecimal) {
  const Device ascii = mc_plc(kAscii), binary = mc_plc();
  EXPECT_EQ(ascii.request_bytes(ascii.read("ZR393215")),
            text("500000FF03FF000018000404010000ZR05FFFF0001"));
  EXPECT_EQ(binary.request_bytes(binary.read("ZR393215")),
            hex("50 00 00 FF FF 03 00 0C 00 04 00 01 04 00 00 FF FF 05 B0 01 00"));
}

// Recorded at a QnUDV CPU by the project plc-comm-slmp (range probe of 2026-07-03), which waits 4 s
// instead of 1 s.
TEST(MitsubishiMc, RecordedResponsesOfARealPlc) {
  const Device device = mc_plc();
  EXPECT_EQ(values(device, device.read("R32767"), hex("D0 00 00 FF FF 03 00 04 00 00 00 BB 06")),
            (Bytes{0x06, 0xBB}));
  EXPECT_EQ(values(device, device.read("ZR393215"), hex("D0 00 00 FF FF 03 00 04 00 00 00 EB B5")),
            (Bytes{0xB5, 0xEB}));
  const Outcome beyond = run(device, device.read("Z20"),
                             hex("D0 00 00 FF FF 03 00 0B 00 31 40 00 FF FF 03 00 01 04 00 00"));
  EXPECT_EQ(beyond.cause, Cause::kDeviceError);
  EXPECT_EQ(beyond.code, 0x4031);
  EXPECT_EQ(device_code_text(device.protocol().traits().codes, beyond.code),
            "the number of the device is out of range");
}

TEST(MitsubishiMc, AddressAndOptionsAreTheRoute) {
  const Device device = mc_plc({{"network", "2"}, {"module", "993"}, {"unit", "5"}}, 3);
  EXPECT_EQ(device.request_bytes(device.read("D100")),
            hex("50 00 02 03 E1 03 05 0C 00 08 00 01 04 00 00 64 00 00 A8 01 00"));
  const Device own = mc_plc({}, 255);
  EXPECT_EQ(own.request_bytes(own.read("D100")), mc_plc().request_bytes(mc_plc().read("D100")));
}

TEST(MitsubishiMc, AResponseOfAnotherRouteIsForeign) {
  const Device device = mc_plc();
  const Bytes own = hex("D0 00 00 FF FF 03 00 04 00 00 00 34 12");
  for (const std::size_t at : {2u, 3u, 4u, 5u, 6u}) {
    Bytes other = own;
    other[at] ^= 1;
    EXPECT_EQ(run(device, device.read("D100"), other).cause, Cause::kForeign) << at;
    append(other, own);
    EXPECT_TRUE(run(device, device.read("D100"), other).done()) << at;
  }
}

TEST(MitsubishiMc, AnotherSerialNumberIsALateResponse) {
  const Device device = mc_plc(kFour);
  Bytes late = hex("D4 00 06 00 00 00 00 FF FF 03 00 04 00 00 00 34 12");
  EXPECT_EQ(run(device, device.read("D100"), late, 7).cause, Cause::kForeign);
  append(late, hex("D4 00 07 00 00 00 00 FF FF 03 00 04 00 00 00 78 56"));
  EXPECT_EQ(values(device, device.read("D100"), late, 7), (Bytes{0x56, 0x78}));
}

TEST(MitsubishiMc, ABrokenStreamFailsImmediately) {
  const auto expect_hopeless = [](const Options& options, const Bytes& stream) {
    const Device device = mc_plc(options);
    const Outcome outcome = run(device, device.read("D100"), stream);
    EXPECT_EQ(outcome.cause, Cause::kMalformed) << to_hex(stream);
    EXPECT_FALSE(outcome.waited) << to_hex(stream);
  };
  for (const std::string_view stream :
       {"50", "D4 00", "D0 01", "D0 00 00 FF FF 03 00 01 00", "D0 00 00 FF FF 03 00 03 0E",
        "D0 00 00 FF FF 03 00 FF FF", "44 30 30 30"})
    expect_hopeless({}, hex(stream));
  for (const std::string_view stream :
       {"5000", "d000", "D400", "D00000FF03FF000003", "D00000FF03FF00FFFF", "D00000FF03FF0000G8",
        "D00000fF03FF000008", "D00000FF03FF0000040O00"})
    expect_hopeless(kAscii, text(stream));
  for (const std::string_view stream : {"D0 00", "D4 00 34 12 01", "D4 00 34 12 00 02"})
    expect_hopeless(kFour, hex(stream));
}

TEST(MitsubishiMc, WrongContentsAreMalformed) {
  const Device device = mc_plc(), ascii = mc_plc(kAscii);
  for (const std::string_view answer :
       {"D0 00 00 FF FF 03 00 02 00 00 00", "D0 00 00 FF FF 03 00 03 00 00 00 34",
        "D0 00 00 FF FF 03 00 06 00 00 00 34 12 34 12",
        "D0 00 00 FF FF 03 00 02 00 31 40",  // without an error part
        "D0 00 00 FF FF 03 00 0C 00 31 40 00 FF FF 03 00 01 04 00 00 00"})
    EXPECT_EQ(run(device, device.read("D100"), hex(answer)).cause, Cause::kMalformed) << answer;
  EXPECT_EQ(run(device, device.read("M0", 2), hex("D0 00 00 FF FF 03 00 03 00 00 00 12")).cause,
            Cause::kMalformed)
      << "a bit that is 2";
  EXPECT_EQ(run(ascii, ascii.read("D100"), text("D00000FF03FF000008000012 4")).cause,
            Cause::kMalformed);
  EXPECT_EQ(run(ascii, ascii.read("M0"), text("D00000FF03FF00000500002")).cause, Cause::kMalformed);
}

TEST(MitsubishiMc, ARefusalIsThatOfItsCommand) {
  const Device device = mc_plc(), ascii = mc_plc(kAscii);
  const Bytes refusal = hex("D0 00 00 FF FF 03 00 0B 00 51 C0 00 FF FF 03 00 01 04 00 00");
  EXPECT_EQ(run(device, device.read("D100"), refusal).code, 0xC051);
  EXPECT_EQ(run(device, device.read("M100"), refusal).cause, Cause::kForeign) << "bit units";
  EXPECT_EQ(run(device, device.write("D100", "0001"), refusal).cause, Cause::kForeign);
  EXPECT_EQ(run(ascii, ascii.read("D100"), text("D00000FF03FF000016C05100FF03FF0004010000")).code,
            0xC051);
  const Outcome busy = run(device, device.read("D100"),
                           hex("D0 00 00 FF FF 03 00 0B 00 E0 CE 00 FF FF 03 00 01 04 00 00"));
  EXPECT_EQ(busy.cause, Cause::kDeviceBusy);
  const Outcome station = run(device, device.read("D100"),
                              hex("D0 00 00 FF FF 03 00 0B 00 71 CF 02 03 FF 03 00 01 04 00 00"));
  EXPECT_EQ(station.code, 0xCF71) << "the station with the error may be another one";
}

TEST(MitsubishiMc, LimitsAreThoseOfTheManual) {
  const auto allows = [](const Options& options, std::string_view at, std::uint32_t count) {
    const Device device = mc_plc(options);
    return device.protocol().size(device.read(at, count)).has_value();
  };
  EXPECT_TRUE(allows({}, "D0", 960) && allows(kAscii, "D0", 960));
  EXPECT_FALSE(allows({}, "D0", 961) || allows(kAscii, "D0", 961));
  EXPECT_TRUE(allows({}, "M0", 7168) && allows(kAscii, "M0", 3584));
  EXPECT_FALSE(allows({}, "M0", 7169) || allows(kAscii, "M0", 3585));
  const auto allows_list = [](const Options& options, std::uint32_t words) {
    const Device device = mc_plc(options);
    return device.protocol()
        .size(ReadRequest{{device.range("D0", words - 1), device.range("M3", 5)}})
        .has_value();
  };
  EXPECT_TRUE(allows_list({}, 192) && allows_list(kSeriesR, 96));
  EXPECT_FALSE(allows_list({}, 193) || allows_list(kSeriesR, 97));
}

TEST(MitsubishiMc, AddressesAreThoseOfTheProgrammingSoftware) {
  const Device device = mc_plc();
  expect_texts([&](const std::string& at) { return device.address(at); },
               {"D100 -> D:100/0", "D100.5 -> D:100.5/1", "D100.F -> D:100.15/1",
                "D100.10 -> D:100.10/1", "W1A0 -> W:416/0", "WB.3 -> W:11.3/1", "X1F -> X:31/1",
                "BCC5 -> B:3269/1", "SB1F -> SB:31/1", "SC5 -> SC:5/1", "STN7 -> SN:7/0",
                "TN5 -> TN:5/0", "ZR393215 -> ZR:393215/0"});
  expect_texts([&](const std::string& at) { return device.suggestion(at); },
               {"d100 -> D100", "T5 -> TN5", "C5 -> CN5", "ST5 -> STN5", "D100.16 -> D100.0",
                "M5.1 -> M5", "DM100 -> D0", "SG5 -> S0", "G5 -> "});
}

// The random read of the manual shows D1501 and D1500 as the double word 4C544F4E.
TEST(MitsubishiMc, TheLowWordIsFirst) {
  const auto areas = mc_plc().protocol().areas();
  EXPECT_EQ(areas[0].name, "D");
  EXPECT_EQ(areas[0].word_order, WordOrder::kLittleEndian);
  EXPECT_EQ(areas[0].text_order, ByteOrder::kLittleEndian);
}

TEST(MitsubishiMc, LateResponsesOf3eAreKnownByTheirLength) {
  const Device three = mc_plc(), four = mc_plc(kFour);
  const auto alike = [](const Device& device, const Request& earlier, const Request& later) {
    return device.protocol().mistakable(earlier, {7}, later, {8});
  };
  EXPECT_TRUE(alike(three, three.read("D0", 3), three.read("W0", 3)));
  EXPECT_FALSE(alike(three, three.read("D0", 3), three.read("D0", 4)));
  EXPECT_FALSE(alike(three, three.read("D0"), three.write("D0", "0001")));
  EXPECT_TRUE(alike(three, three.write("M0", "01"), three.write("D0", "0001")));
  EXPECT_FALSE(alike(four, four.read("D0", 3), four.read("W0", 3)));
}

TEST(MitsubishiMc, AnInvalidOptionIsAFault) {
  for (const auto& [name, value] : Options{{"frame", "1e"},
                                           {"code", "bcd"},
                                           {"series", "fx"},
                                           {"network", "240"},
                                           {"module", "1024"},
                                           {"unit", "32"}}) {
    const auto made =
        find_protocol("mitsubishi-mc")->make({.address = 0, .options = {{name, value}}});
    ASSERT_FALSE(made.has_value()) << name;
    EXPECT_EQ(made.error().option, name);
  }
}

TEST(MitsubishiMc, EveryDisturbanceIsRefused) {
  for (const Golden& golden : reads_of_timers()) {
    SCOPED_TRACE(golden.name);
    const Device device = mc_plc(golden.options);
    const MatrixCase matrix{
        .begin = [&] { return device.begin(device.read("TN100", 3), golden.sequence); },
        .answers = {golden.response},
        .checked = false,
        .noise_recovers = false};
    expect_matrix(matrix);
    expect_random_bytes_are_refused(matrix, 5, 2000);
  }
}

TEST(MitsubishiMc, AFrameIsExplained) {
  const auto faults = [](const Bytes& frame) {
    std::string all;
    for (const FrameField& field : find_protocol("mitsubishi-mc")->explain(frame))
      all += field.fault;
    return all;
  };
  for (const Golden& golden : reads_of_timers()) {
    for (const Bytes& frame : {golden.request, golden.response}) {
      EXPECT_EQ(faults(frame), "") << golden.name;
      EXPECT_NE(faults(Bytes(frame.begin(), frame.end() - 1)), "") << golden.name;
    }
  }
  EXPECT_NE(faults(hex("51 00 00 FF")), "");
  EXPECT_NE(faults({}), "");
}

}  // namespace
}  // namespace fieldcast::test
