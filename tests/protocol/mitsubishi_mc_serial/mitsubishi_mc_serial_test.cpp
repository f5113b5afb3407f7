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

Device module_at(const Options& options = {}, std::uint16_t station = 0) {
  return {"mitsubishi-mc-serial", station, options};
}
const Options k4c2{{"format", "2"}}, k4c3{{"format", "3"}}, k4c4{{"format", "4"}};
const Options k4c5{{"format", "5"}}, k3c{{"frame", "3c"}};
const Options k3c2{{"frame", "3c"}, {"format", "2"}}, k3c3{{"frame", "3c"}, {"format", "3"}};
const Options k3c4{{"frame", "3c"}, {"format", "4"}};
const Options k1c2{{"frame", "1c"}, {"format", "2"}}, k1c3{{"frame", "1c"}, {"format", "3"}};
const Options k1c{{"frame", "1c"}}, k1c4{{"frame", "1c"}, {"format", "4"}};
const Options kAna{{"frame", "1c"}, {"commands", "ana"}}, kFx{{"frame", "1c"}, {"commands", "fx"}};
const Options kNoSum{{"sum-check", "false"}};

Bytes hex(std::string_view digits) { return from_hex(digits).value_or(Bytes{}); }

// "<ENQ>", "<STX>" and so on are their characters, and other characters are themselves.
Bytes text(std::string_view characters) {
  static constexpr std::pair<std::string_view, std::uint8_t> kMarks[] = {
      {"<STX>", 2}, {"<ETX>", 3}, {"<ENQ>", 5}, {"<ACK>", 6}, {"<NAK>", 21}, {"<CRLF>", 13}};
  Bytes bytes;
  while (!characters.empty()) {
    const auto mark = std::ranges::find_if(
        kMarks, [&](const auto& each) { return characters.starts_with(each.first); });
    if (mark == std::end(kMarks)) {
      bytes.push_back(static_cast<std::uint8_t>(characters[0]));
      characters.remove_prefix(1);
      continue;
    }
    bytes.push_back(mark->second);
    if (mark->second == 13) bytes.push_back(10);
    characters.remove_prefix(mark->first.size());
  }
  return bytes;
}

Outcome run(const Device& device, const Request& request, const Bytes& response) {
  const auto exchange = device.begin(request);
  return drive(*exchange, response);
}
Bytes values(const Device& device, const Request& request, const Bytes& response) {
  const Outcome outcome = run(device, request, response);
  EXPECT_TRUE(outcome.done()) << to_text(outcome);
  Bytes all;
  for (const RangeReply& range : outcome.reply) append(all, range.items);
  return all;
}

// Commands and data are the communication examples of SH-080008, 8.2 (D100 to D102 = 1995, 1202,
// 1130). The whole frames are the vectors A.7 to A.19 of the specification mc-protocol-frame-spec
// 1.0, which its author derived from SH-080008, chapter 4, with an encoder of his own.
struct Golden {
  std::string_view name;
  Options options;
  Bytes read, data, write, done, refusal;
  std::uint16_t code = 0x7151;
};

const std::vector<Golden>& golden_frames() {
  static const std::vector<Golden> all{
      {"4C format 1",
       {},
       text("<ENQ>F80000FF03FF000004010000D*000100000350"),
       text("<STX>F80000FF03FF0000199512021130<ETX>DE"),
       text("<ENQ>F80000FF03FF000014010000D*0001000003199512021130B3"),
       text("<ACK>F80000FF03FF0000"),
       text("<NAK>F80000FF03FF00007151")},
      {"4C format 2", k4c2, text("<ENQ>00F80000FF03FF000004010000D*0001000003B0"),
       text("<STX>00F80000FF03FF0000199512021130<ETX>3E"),
       text("<ENQ>00F80000FF03FF000014010000D*000100000319951202113013"),
       text("<ACK>00F80000FF03FF0000"), text("<NAK>00F80000FF03FF00007151")},
      {"4C format 3", k4c3, text("<STX>F80000FF03FF000004010000D*0001000003<ETX>53"),
       text("<STX>F80000FF03FF0000QACK199512021130<ETX>FE"),
       text("<STX>F80000FF03FF000014010000D*0001000003199512021130<ETX>B6"),
       text("<STX>F80000FF03FF0000QACK<ETX>"), text("<STX>F80000FF03FF0000QNAK7151<ETX>")},
      {"4C format 4", k4c4, text("<ENQ>F80000FF03FF000004010000D*000100000350<CRLF>"),
       text("<STX>F80000FF03FF0000199512021130<ETX>DE<CRLF>"),
       text("<ENQ>F80000FF03FF000014010000D*0001000003199512021130B3<CRLF>"),
       text("<ACK>F80000FF03FF0000<CRLF>"), text("<NAK>F80000FF03FF00007151<CRLF>")},
      {"4C format 5", k4c5,
       hex("10 02 12 00 F8 00 00 FF FF 03 00 00 01 04 00 00 64 00 00 A8 03 00 10 03 31 46"),
       hex("10 02 12 00 F8 00 00 FF FF 03 00 00 FF FF 00 00 95 19 02 12 30 11 10 03 30 43"),
       hex("10 02 18 00 F8 00 00 FF FF 03 00 00 01 14 00 00 64 00 00 A8 03 00 95 19 02 12 30 11 "
           "10 03 33 38"),
       hex("10 02 0C 00 F8 00 00 FF FF 03 00 00 FF FF 00 00 10 03 30 33"),
       hex("10 02 0C 00 F8 00 00 FF FF 03 00 00 FF FF 51 71 10 03 43 35")},
      {"3C format 1",
       k3c,
       text("<ENQ>F90000FF0004010000D*000100000302"),
       text("<STX>F90000FF00199512021130<ETX>90"),
       {},
       text("<ACK>F90000FF00"),
       text("<NAK>F90000FF007151")},
      {"3C format 2",
       k3c2,
       text("<ENQ>00F90000FF0004010000D*000100000362"),
       text("<STX>00F90000FF00199512021130<ETX>F0"),
       {},
       text("<ACK>00F90000FF00"),
       text("<NAK>00F90000FF007151")},
      {"3C format 3",
       k3c3,
       text("<STX>F90000FF0004010000D*0001000003<ETX>05"),
       text("<STX>F90000FF00QACK199512021130<ETX>B0"),
       {},
       text("<STX>F90000FF00QACK<ETX>"),
       text("<STX>F90000FF00QNAK7151<ETX>")},
      {"3C format 4",
       k3c4,
       text("<ENQ>F90000FF0004010000D*000100000302<CRLF>"),
       text("<STX>F90000FF00199512021130<ETX>90<CRLF>"),
       {},
       text("<ACK>F90000FF00<CRLF>"),
       text("<NAK>F90000FF007151<CRLF>")},
      {"1C format 2", k1c2, text("<ENQ>0000FFWR0D0100038D"), text("<STX>0000FF199512021130<ETX>B1"),
       text("<ENQ>0000FFWW0D010003199512021130F4"), text("<ACK>0000FF"), text("<NAK>0000FF06"),
       0x06},
      {"1C format 3", k1c3, text("<STX>00FFWR0D010003<ETX>30"),
       text("<STX>00FFGG199512021130<ETX>DF"), text("<STX>00FFWW0D010003199512021130<ETX>97"),
       text("<STX>00FFGG<ETX>"), text("<STX>00FFNN06<ETX>"), 0x06},
      {"4C format 1 without sum",
       kNoSum,
       text("<ENQ>F80000FF03FF000004010000D*0001000003"),
       {},
       {},
       text("<ACK>F80000FF03FF0000"),
       text("<NAK>F80000FF03FF00007151")}};
  return all;
}

TEST(MitsubishiMcSerial, FramesAreThoseOfTheManual) {
  for (const Golden& golden : golden_frames()) {
    SCOPED_TRACE(golden.name);
    const Device device = module_at(golden.options);
    const Request read = device.read("D100", 3), write = device.write("D100", "1995 1202 1130");
    EXPECT_EQ(device.request_bytes(read), golden.read);
    const auto size = device.protocol().size(read);
    ASSERT_TRUE(size);
    EXPECT_EQ(size->request_characters, golden.read.size());
    if (!golden.write.empty()) { EXPECT_EQ(device.request_bytes(write), golden.write); }
    if (!golden.data.empty()) {
      EXPECT_EQ(size->response_characters, golden.data.size());
      EXPECT_EQ(values(device, read, golden.data), (Bytes{0x19, 0x95, 0x12, 0x02, 0x11, 0x30}));
    }
    EXPECT_EQ(device.protocol().size(write)->response_characters, golden.done.size());
    EXPECT_TRUE(run(device, write, golden.done).done());
    const Outcome refused = run(device, read, golden.refusal);
    EXPECT_EQ(refused.cause, Cause::kDeviceError);
    EXPECT_EQ(refused.code, golden.code);
  }
}

// 3C writes bits in the same specification, A.12.
TEST(MitsubishiMcSerial, WritesBitsAsTheManualShows) {
  const Device device = module_at(k3c);
  EXPECT_EQ(device.request_bytes(device.write("M100", "01 01 00 00 01 01 00 00")),
            text("<ENQ>F90000FF0014010001M*00010000081100110096"));
}

// Examples of SH-080008, chapter 18, without their wait of 100 ms: TN123, M903 = 0 1 1 0 1, D0 =
// 1234 ACD7; and the same specification, A.16.
TEST(MitsubishiMcSerial, ShortCommandsAreThoseOfTheManual) {
  const Device a = module_at(k1c), ana = module_at(kAna);
  const auto content = [](const Device& device, const Request& request) {
    const Bytes frame = device.request_bytes(request);
    return Bytes(frame.begin() + 5, frame.end() - 2);
  };
  EXPECT_EQ(content(a, a.read("TN123", 2)), text("WR0TN12302"));
  EXPECT_EQ(content(ana, ana.read("TN123", 2)), text("QR0TN0012302"));
  EXPECT_EQ(content(ana, ana.read("X40", 5)), text("JR0X00004005"));
  EXPECT_EQ(content(a, a.write("M903", "00 01 01 00 01")), text("BW0M09030501101"));
  EXPECT_EQ(content(a, a.write("D0", "1234 ACD7")), text("WW0D0000021234ACD7"));
  EXPECT_EQ(a.request_bytes(a.read("M0", 256)), text("<ENQ>00FFBR0M0000001D"));
  EXPECT_EQ(values(a, a.read("M100", 8), text("<STX>00FF00010011<ETX>72")),
            (Bytes{0, 0, 0, 1, 0, 0, 1, 1}));
}

// X40 to X44 of station 5 in the AJ71C24-S6 user's manual, 8.7.2.
TEST(MitsubishiMcSerial, ReadsBitsOfAStationAsTheComputerLinkManualShows) {
  const Device device = module_at(kAna, 5);
  EXPECT_EQ(values(device, device.read("X40", 5), text("<STX>05FF01101<ETX>E7")),
            (Bytes{0, 1, 1, 0, 1}));
}

TEST(MitsubishiMcSerial, AnFxHasOctalInputs) {
  const Device device = module_at(kFx, 5);
  EXPECT_EQ(device.address("X40"), "X:32/1");
  EXPECT_EQ(device.request_bytes(device.read("X40", 8)), text("<ENQ>05FFBR0X00400839"));
  expect_texts([&](const std::string& at) { return device.suggestion(at); },
               {"X8 -> X0", "T5 -> TN5", "d100 -> D100"});
  EXPECT_TRUE(device.address("CN200").starts_with("fault: ")) << "a counter of 32 bits";
  EXPECT_TRUE(device.address("W5").starts_with("fault: "));
  EXPECT_TRUE(module_at(k1c).address("S3").starts_with("fault: "));
}

TEST(MitsubishiMcSerial, LimitsOfShortCommandsAreThoseOfTheManual) {
  const Device device = module_at(k1c);
  const auto allows = [&](const Request& request) {
    return device.protocol().size(request).has_value();
  };
  EXPECT_TRUE(allows(device.read("D0", 64)) && allows(device.read("M0", 256)));
  EXPECT_FALSE(allows(device.read("D0", 65)) || allows(device.read("M0", 257)));
  EXPECT_FALSE(allows(ReadRequest{{device.range("D0"), device.range("D5")}}));
  const auto bits = [&](std::uint32_t count) {
    return WriteRequest{.range = device.range("M0", count), .items = Bytes(count, 1)};
  };
  EXPECT_TRUE(allows(bits(160)));
  EXPECT_FALSE(allows(bits(161)));
  EXPECT_EQ(device.protocol().traits().max_ranges, 1);
}

TEST(MitsubishiMcSerial, ShortCodesHaveTwoDigits) {
  const Device device = module_at(k1c);
  EXPECT_EQ(run(device, device.read("D0"), text("<NAK>00FF02")).cause, Cause::kChecksum);
  EXPECT_EQ(run(device, device.read("D0"), text("<NAK>00FF08")).cause, Cause::kDeviceBusy);
  const Outcome disabled = run(device, device.write("D0", "0001"), text("<NAK>00FF00"));
  EXPECT_EQ(disabled.cause, Cause::kDeviceError);
  EXPECT_EQ(run(device, device.read("M0"), text("<STX>00FF2<ETX>21")).cause, Cause::kMalformed);
}

// The example of the sum in SH-080008, 4.3: station 5 of network 7, PC 3, module 4, its station 1.
TEST(MitsubishiMcSerial, TheRouteIsThatOfTheAddressAndTheOptions) {
  const Options route{
      {"format", "5"}, {"network", "7"}, {"pc", "3"}, {"module", "4"}, {"unit", "1"}};
  const Device device = module_at(route, 5);
  EXPECT_EQ(device.request_bytes(device.read("X40", 5)),
            hex("10 02 12 00 F8 05 07 03 04 00 01 00 01 04 01 00 40 00 00 9C 05 00 10 03 30 35"));
  const Device own = module_at({{"frame", "3c"}, {"own-station", "31"}}, 10);
  const Bytes request = own.request_bytes(own.read("D0"));
  EXPECT_EQ(Bytes(request.begin(), request.begin() + 11), text("<ENQ>F90A00FF1F"));
}

// The second 10 of D16 and of its value 1010 (the same specification, A.11).
TEST(MitsubishiMcSerial, Format5SendsEach10Twice) {
  const Device device = module_at(k4c5);
  EXPECT_EQ(
      device.request_bytes(device.read("D16")),
      hex("10 02 12 00 F8 00 00 FF FF 03 00 00 01 04 00 00 10 10 00 00 A8 01 00 10 03 43 39"));
  EXPECT_EQ(device.protocol().size(device.read("D16"))->request_characters, 27u);
  const Bytes response =
      hex("10 02 0E 00 F8 00 00 FF FF 03 00 00 FF FF 00 00 10 10 10 10 10 03 32 35");
  EXPECT_EQ(values(device, device.read("D16"), response), (Bytes{0x10, 0x10}));
}

TEST(MitsubishiMcSerial, ResponsesOfOtherStationsAreForeign) {
  const Device device = module_at(k3c, 1);
  const Bytes other = text("<STX>F90200FF001234<ETX>FA"), own = text("<STX>F90100FF001234<ETX>F9");
  EXPECT_EQ(run(device, device.read("D0"), other).cause, Cause::kForeign);
  EXPECT_EQ(values(device, device.read("D0"), own), (Bytes{0x12, 0x34}));
  Bytes both = other;
  append(both, own);
  EXPECT_EQ(values(device, device.read("D0"), both), (Bytes{0x12, 0x34}));
  EXPECT_EQ(run(device, device.read("D0"), text("<NAK>F90200FF007F22")).cause, Cause::kForeign);
}

TEST(MitsubishiMcSerial, ARefusalOfWrongCharactersIsCausedByTheLine) {
  const Device device = module_at();
  const Request read = device.read("D0");
  EXPECT_EQ(run(device, read, text("<NAK>F80000FF03FF00007F24")).cause, Cause::kChecksum);
  EXPECT_EQ(run(device, read, text("<NAK>F80000FF03FF00007E47")).cause, Cause::kDeviceBusy);
  EXPECT_EQ(run(device, read, text("<NAK>F80000FF03FF00004031")).cause, Cause::kDeviceError);
}

TEST(MitsubishiMcSerial, AnAcknowledgementIsWhole) {
  const Device device = module_at(), line_end = module_at(k4c4);
  const Request write = device.write("D0", "0001");
  EXPECT_EQ(run(device, write, text("<ACK>F80000FF03FF000")).cause, Cause::kTruncated);
  EXPECT_EQ(run(device, write, text("<ACK>F80000FF03FF00001234")).cause, Cause::kChecksum);
  EXPECT_EQ(run(line_end, write, text("<ACK>F80000FF03FF0000")).cause, Cause::kTruncated);
  EXPECT_EQ(run(device, write, text("<STX>F80000FF03FF00001234<ETX>46")).cause, Cause::kMalformed);
  EXPECT_EQ(run(device, device.read("D0"), text("<ACK>F80000FF03FF0000")).cause, Cause::kMalformed);
  EXPECT_TRUE(run(device, write, text("\xFF<ACK>F80000FF03FF0000\xFF")).done());
}

TEST(MitsubishiMcSerial, AnotherBlockNumberIsAnotherResponse) {
  const Device device = module_at(k3c2);
  const Request read = device.read("D0"), write = device.write("D0", "0001");
  EXPECT_EQ(device.request_bytes(read, 0x17A), text("<ENQ>7AF90000FF0004010000D*000000000177"));
  const auto answered = [&](const Request& request, std::string_view response) {
    const auto exchange = device.begin(request, 0x17A);
    return drive(*exchange, text(response));
  };
  EXPECT_EQ(answered(read, "<STX>79F90000FF001234<ETX>68").cause, Cause::kForeign);
  EXPECT_EQ(answered(read, "<NAK>79F90000FF007151").cause, Cause::kForeign);
  EXPECT_EQ(answered(write, "<ACK>79F90000FF00").cause, Cause::kForeign);
  EXPECT_TRUE(answered(read, "<STX>79F90000FF001234<ETX>68<STX>7AF90000FF001234<ETX>70").done());
  EXPECT_TRUE(answered(write, "<ACK>7AF90000FF00").done());
  EXPECT_EQ(device.protocol().traits().identity, ResponseIdentity::kSequence);
  EXPECT_FALSE(device.protocol().mistakable(read, {1}, read, {2}));
  EXPECT_TRUE(device.protocol().mistakable(read, {1}, write, {0x101}));
}

TEST(MitsubishiMcSerial, Format3HasEndCodes) {
  const Device device = module_at(k3c3), a = module_at(k1c3);
  const Request read = device.read("D0"), write = device.write("D0", "0001");
  EXPECT_EQ(run(device, write, text("<STX>F90000FF00QACK")).cause, Cause::kTruncated);
  EXPECT_EQ(run(device, write, text("<STX>F90000FF00QACK<ETX>34")).cause, Cause::kChecksum);
  EXPECT_EQ(run(device, write, text("<STX>F90000FF00QACC<ETX>")).cause, Cause::kChecksum);
  EXPECT_EQ(run(device, write, text("<STX>F90000FF00GG<ETX>")).cause, Cause::kChecksum);
  EXPECT_EQ(run(device, write, text("<STX>F90000FF00QNAK715<ETX>")).cause, Cause::kChecksum);
  EXPECT_EQ(run(device, write, text("<ACK>F90000FF00")).cause, Cause::kChecksum);
  EXPECT_EQ(run(device, read, text("<STX>F90000FF00QACK<ETX>")).cause, Cause::kMalformed);
  EXPECT_EQ(run(device, read, text("<STX>F90100FF00QNAK7151<ETX>")).cause, Cause::kForeign);
  EXPECT_EQ(run(device, read, text("<STX>F90000FF00QNAK7F24<ETX>")).cause, Cause::kChecksum);
  EXPECT_TRUE(run(device, write, text("\xFF<STX>F90000FF00QACK<ETX>\xFF")).done());
  EXPECT_EQ(run(a, a.write("D0", "0001"), text("<STX>00FFQACK<ETX>")).cause, Cause::kChecksum);
  Bytes echoed = device.request_bytes(read);
  append(echoed, text("<STX>F90000FF00QACK1234<ETX>18"));
  EXPECT_EQ(values(device, read, echoed), (Bytes{0x12, 0x34}));
}

TEST(MitsubishiMcSerial, LateResponsesAreKnownByTheirLength) {
  const Device device = module_at();
  const auto alike = [&](const Request& earlier, const Request& later) {
    return device.protocol().mistakable(earlier, {1}, later, {2});
  };
  EXPECT_EQ(device.protocol().traits().identity, ResponseIdentity::kAddress);
  EXPECT_TRUE(alike(device.read("D0", 3), device.read("W0", 3)));
  EXPECT_FALSE(alike(device.read("D0", 3), device.read("D0", 4)));
  EXPECT_FALSE(alike(device.read("D0"), device.write("D0", "0001")));
  EXPECT_TRUE(alike(device.write("M0", "01"), device.write("D0", "0001")));
}

TEST(MitsubishiMcSerial, EveryDisturbanceIsRefused) {
  for (const Golden& golden : golden_frames()) {
    SCOPED_TRACE(golden.name);
    if (golden.data.empty()) continue;
    const Device device = module_at(golden.options);
    const MatrixCase read{.begin = [&] { return device.begin(device.read("D100", 3)); },
                          .answers = {golden.data}};
    expect_matrix(read);
    expect_random_bytes_are_refused(read, 5, 2000);
    const MatrixCase write{.begin = [&] { return device.begin(device.write("D100", "1995")); },
                           .answers = {golden.done}};
    expect_matrix(write);
  }
}

TEST(MitsubishiMcSerial, AnInvalidOptionIsAFault) {
  const auto refused = [](const Options& options, const std::string& name) {
    const auto made = find_protocol("mitsubishi-mc-serial")->make({.options = options});
    return !made.has_value() && made.error().option == name;
  };
  for (const auto& [name, value] : Options{{"frame", "3e"},
                                           {"format", "6"},
                                           {"sum-check", "yes"},
                                           {"series", "fx"},
                                           {"network", "240"},
                                           {"pc", "256"},
                                           {"module", "1024"},
                                           {"unit", "32"},
                                           {"own-station", "32"}})
    EXPECT_TRUE(refused({{name, value}}, name)) << name;
  EXPECT_TRUE(refused({{"frame", "3c"}, {"format", "5"}}, "format"));
  EXPECT_TRUE(refused({{"frame", "3c"}, {"module", "4"}}, "module"));
  EXPECT_TRUE(refused({{"frame", "3c"}, {"unit", "4"}}, "unit"));
  EXPECT_TRUE(refused({{"frame", "1c"}, {"network", "4"}}, "network"));
  EXPECT_TRUE(refused({{"frame", "1c"}, {"series", "iqr"}}, "series"));
  EXPECT_TRUE(refused({{"frame", "1c"}, {"format", "5"}}, "format"));
  EXPECT_TRUE(refused({{"commands", "ana"}}, "commands"));
  const auto seven = find_protocol("mitsubishi-mc-serial")
                         ->make({.options = k4c5, .line = {19200, 7, Parity::kEven, 1}});
  EXPECT_FALSE(seven.has_value());
}

TEST(MitsubishiMcSerial, AFrameIsExplained) {
  const auto explain = [](const Bytes& frame) {
    std::string all, faults;
    for (const FrameField& field : find_protocol("mitsubishi-mc-serial")->explain(frame)) {
      all += field.name + "=" + field.value + " ";
      faults += field.fault;
    }
    return std::pair{all, faults};
  };
  for (const Golden& golden : golden_frames()) {
    SCOPED_TRACE(golden.name);
    for (const Bytes& frame : {golden.read, golden.data, golden.done, golden.refusal}) {
      if (frame.empty()) continue;
      EXPECT_EQ(explain(frame).second, "") << explain(frame).first;
    }
    Bytes broken = golden.read;
    broken[broken.size() - 8] ^= 1;
    if (golden.name != "4C format 1 without sum") { EXPECT_NE(explain(broken).second, ""); }
  }
  EXPECT_NE(explain(golden_frames()[0].read).first.find("command=0401 batch read "),
            std::string::npos);
  EXPECT_NE(explain(golden_frames().back().read).first.find("without a sum"), std::string::npos);
  EXPECT_NE(explain(text("<NAK>F80000FF03FF00007F24")).first.find("7F24 wrong sum"),
            std::string::npos);
  const auto explained = [&](std::string_view frame, std::string_view part) {
    const auto [all, faults] = explain(text(frame));
    EXPECT_EQ(faults, "") << frame;
    EXPECT_NE(all.find(part), std::string::npos) << all;
  };
  // FX communication user's manual, 8.2; AJ71C24-S6 user's manual, 8.7.2; LJ71C24 manual, 6.4.
  explained("<ENQ>05FFWR0X00400248", "command=WR read words wait=0 ms parameters=X004002 sum=48");
  explained("<ENQ>05FFJRAX00004005AF", "command=JR read bits wait=100 ms");
  explained("<ENQ>00FFTT005ABCDE78", "command=TT loopback test");
  explained("<NAK>00FF00", "code=00 writes while the CPU runs are disabled");
  explained("<STX>F90000FF0004010000D*0001000003<ETX>05", "3C request, format 3 frame=F9 ");
  explained("<STX>F90000FF00QACK1995<ETX>26", "3C response, format 3 frame=F9 station=00 ");
  explained("<STX>F90000FF00QACK1995<ETX>26", "end code=QACK data=1995 sum=26");
  explained("<STX>00FFGG<ETX>", "1C response without data, format 3 station=00 PC=FF end code=GG ");
  explained("<STX>00FFNN06<ETX>", "1C refusal, format 3 station=00 PC=FF end code=NN code=06 the");
  explained("<ENQ>7A00FFWR0D010003A5", "1C request, format 2 block=7A station=00 PC=FF command=WR");
  explained("<STX>F8F80000FF03FF00001234<ETX>C4", "4C response, format 2 block=F8 frame=F8 ");
  explained("<ACK>7A00FF", "1C response without data, format 2 block=7A station=00 PC=FF ");
  explained("<NAK>7A00FF06", "1C refusal, format 2 block=7A station=00 PC=FF code=06 the");
  EXPECT_NE(explain(text("F80000")).second, "");
  EXPECT_NE(explain({}).second, "");
  EXPECT_NE(explain(text("<STX>F80000FF")).second, "");
}

}  // namespace
}  // namespace fieldcast::test
