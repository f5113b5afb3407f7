#include "tools/sim/families/hostlink_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/codec/checksum.hpp"
#include "tests/support/vectors.hpp"
#include "tests/tools/sim/device_setup.hpp"
#include "tests/tools/sim/listen.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {
namespace {

using fieldcast::test::GoldenVector;

std::string text(ByteView bytes) { return {bytes.begin(), bytes.end()}; }
std::string said(HostLinkDevice& device, const std::string& request) {
  return text(test::listen(*device.open_receiver(), test::bytes(request)).response);
}

std::string framed(const std::string& body, bool last = true) {
  Bytes fcs;
  append_hex(fcs, xor8(test::bytes(body)), 2);
  return body + text(fcs) + (last ? "*\r" : "\r");
}

std::size_t area_of(char letter) {
  return static_cast<std::size_t>(std::ranges::find(kOmronAreas, letter, &OmronArea::letter) -
                                  kOmronAreas.begin());
}

// Fills the memory so that a C-mode response has this data.
void prepare(ItemMemory& memory, const std::string& request, const std::string& data) {
  const std::size_t each = request[4] == 'G' ? 1 : 4,
                    area = request[4] == 'G' ? 9 : area_of(request[4]);
  const auto first = static_cast<std::uint32_t>(std::stoul(request.substr(5, 4)));
  for (std::size_t i = 0; i < data.size() / each; ++i) {
    memory.write(area, first + static_cast<std::uint32_t>(i),
                 std::stoul(data.substr(i * each, each), nullptr, 16));
  }
}

TEST(HostLinkDeviceVectors, CModeRespondsAsPrinted) {
  // Not possible in the simulator: another model or state, or only the form of a response.
  const std::set<std::string> elsewhere{"end_01",  "end_02", "end_04",     "end_18",
                                        "end_19",  "end_21", "ms_program", "ms_fatal",
                                        "ms_fals", "kshr",   "krhr",       "multi_abort_a3"};
  int seen = 0;
  for (const GoldenVector& vector : fieldcast::test::load_vectors("hostlink")) {
    if (vector.kind == "malformed" || elsewhere.contains(vector.name)) continue;
    if (vector.response.empty() && vector.master.empty()) continue;
    SCOPED_TRACE(vector.name);
    HostLinkDevice device(test::device_setup(0));
    std::vector<Bytes> asked = vector.master, printed = vector.slave;
    if (asked.empty()) asked = {vector.request}, printed = {vector.response};
    std::string data;
    for (std::size_t round = 0; round < printed.size(); ++round) {
      const std::string frame = text(printed[round]);
      const std::size_t begin = round == 0 ? 7 : 0,
                        end = frame.size() - (frame[frame.size() - 2] == '*' ? 4 : 3);
      if (begin < end) data += frame.substr(begin, end - begin);
    }
    if (vector.kind == "ok" && asked[0][3] == 'R') prepare(device.memory(), text(asked[0]), data);
    for (std::size_t round = 0; round < asked.size(); ++round)
      EXPECT_EQ(said(device, text(asked[round])), text(printed[round]));
    ++seen;
  }
  EXPECT_GE(seen, 20);
}

TEST(HostLinkDeviceVectors, MalformedFramesAreRefusedAsTheManualSays) {
  const std::map<std::string, std::string> expected{{"fcs_error", "13"},
                                                    {"format", "14"},
                                                    {"empty_text", "14"},
                                                    {"odd_data", "14"},
                                                    {"bad_hex", "15"}};
  int seen = 0;
  for (const GoldenVector& vector : fieldcast::test::load_vectors("hostlink")) {
    if (vector.kind != "malformed" || vector.request.empty()) continue;
    SCOPED_TRACE(vector.name);
    HostLinkDevice device(test::device_setup(0));
    const std::string answer = said(device, text(vector.request));
    const auto code = expected.find(vector.expect);
    const std::string header = text(ByteView(vector.request).subspan(3, 2));
    EXPECT_EQ(answer, code == expected.end() ? "" : framed("@00" + header + code->second));
    EXPECT_EQ(device.statistics().write_requests, 0u);
    ++seen;
  }
  EXPECT_GE(seen, 7);
}

TEST(HostLinkDeviceVectors, FinsRespondsAsPrinted) {
  int seen = 0;
  for (const GoldenVector& vector : fieldcast::test::load_vectors("fins")) {
    const std::string request = text(vector.request), answer = text(vector.response);
    const bool form_only =
        vector.has("note") && vector.texts.at("note").find("does not follow") != std::string::npos;
    if (vector.framing != "hostlink" || request.empty() || answer.empty() || form_only) continue;
    // Not simulated: programs, cycle times, CPU faults; and a code for a valid request.
    const std::set<std::string> elsewhere{"fa_cycle_time_0620", "fa_program_read_last",
                                          "fa_program_write_0307", "fa_end_0040_masked",
                                          "fa_hostlink_endcode_13"};
    if (elsewhere.contains(vector.name)) continue;
    SCOPED_TRACE(vector.name);
    HostLinkDevice device(
        test::device_setup(static_cast<std::uint16_t>(std::stoul(request.substr(1, 2)))));
    const std::size_t head = request[6] == '8' ? 20 : 8;
    const Bytes asked = *from_hex(request.substr(6 + head, request.size() - 4 - 6 - head));
    const Bytes shown = *from_hex(answer.substr(7 + head, answer.size() - 4 - 7 - head));
    if (asked[0] == 0x01 &&
        asked[1] == 0x01) {  // for a read, its data is written first to the same area and address
      Bytes write{0x01, 0x02};
      append(write, ByteView(asked).subspan(2));
      append(write, ByteView(shown).subspan(4));
      EXPECT_EQ(
          said(device, framed("@" + request.substr(1, 2) + "FA000000000" + to_hex(write, '\0')))
              .substr(19, 4),
          "0000");
    }
    if (vector.name == "fa_multi_read_0104") {
      device.memory().write(5, 100, 0x1234);
      device.memory().write(1, 10, 0x5678);
      device.memory().write(0, 20, 1u << 5);
    }
    EXPECT_EQ(said(device, request), answer);
    ++seen;
  }
  EXPECT_GE(seen, 15);
}

TEST(HostLinkDevice, WordsLieWhereTheCommandsSay) {
  HostLinkDevice device(test::device_setup(0));
  EXPECT_EQ(said(device, framed("@00WD01001234ABCD")), framed("@00WD00"));
  EXPECT_EQ(device.memory().read(5, 101, test::kBegin), 0xABCDu);
  EXPECT_EQ(said(device, framed("@00FA0000000000101820064000002")),
            framed("@00FA0040000000010100001234ABCD"));
  EXPECT_EQ(said(device, framed("@00WE0100070042")), framed("@00WE00"));
  EXPECT_EQ(device.memory().read(kOmronEm, kEmBankWords + 7, test::kBegin), 0x42u);
  EXPECT_EQ(said(device, framed("@00WC20550100")),
            framed("@00WC00"));  // counters are located after 2048 timers
  EXPECT_EQ(device.memory().read(8, 7, test::kBegin), 0x100u);
  EXPECT_EQ(said(device, framed("@00FA0000000000101898007000001")),
            framed("@00FA0040000000010100000100"));
  EXPECT_EQ(said(device, framed("@00FA0000000000102310005020001"
                                "01")),
            framed("@00FA00400000000102"
                   "0000"));
  EXPECT_EQ(device.memory().read(1, 5, test::kBegin), 4u);
}

TEST(HostLinkDevice, AWriteOfSeveralFramesIsTakenFrameByFrame) {
  HostLinkDevice device(test::device_setup(0));
  std::string data;
  for (unsigned i = 0; i < 40; ++i)
    data += "00" + to_hex(Bytes{static_cast<std::uint8_t>(i)}, '\0');
  EXPECT_EQ(said(device, framed("@00WD0000" + data.substr(0, 116), false)), "\r");
  EXPECT_EQ(device.statistics().write_requests, 0u);
  EXPECT_EQ(said(device, framed(data.substr(116))), framed("@00WD00"));
  EXPECT_EQ(device.memory().read(5, 39, test::kBegin), 39u);
  // A later frame with a wrong check ends the transfer; XZ aborts it.
  EXPECT_EQ(said(device, framed("@00WD0000FFFF", false)), "\r");
  EXPECT_EQ(said(device, "FFFF77*\r"), framed("@00WDA3"));
  EXPECT_EQ(said(device, framed("@00WD0000FFFF", false)), "\r");
  EXPECT_EQ(said(device, framed("@00XZ")), "");
  EXPECT_EQ(said(device, framed("FFFF")), "");
  EXPECT_EQ(device.memory().read(5, 0, test::kBegin), 0u);
}

TEST(HostLinkDevice, AReplyOfSeveralFramesWaitsForItsDelimiters) {
  HostLinkDevice device(test::device_setup(0));
  EXPECT_EQ(said(device, framed("@00RD00000060")).back(), '\r');
  EXPECT_EQ(said(device, framed("@00MS")).size(), 124u);  // any command counts as a delimiter
  EXPECT_EQ(said(device, "\r"), "");
  EXPECT_EQ(said(device, framed("@00RD00000060")).size(), 130u);
  EXPECT_EQ(said(device, framed("@12RD00000001")), "");  // to another unit: ends the transfer
  EXPECT_EQ(said(device, "\r"), "");
}

TEST(HostLinkDevice, WaitsAsLongAsAFinsRequestSays) {
  HostLinkDevice device(test::device_setup(0));
  Reaction reaction;
  const std::string frame = framed(
      "@00FAF00000000010182000000"
      "0001");
  device.take(test::bytes(frame.substr(0, frame.size() - 1)), test::kBegin, reaction);
  EXPECT_FALSE(reaction.response.empty());
  EXPECT_EQ(reaction.pause, Duration{150'000'000});
}

TEST(HostLinkDevice, AddressesAreReadInOmronsNotation) {
  EXPECT_EQ(parse_omron_address("CIO12.03")->bit, 3);
  EXPECT_EQ(parse_omron_address("DM100")->first, 100u);
  EXPECT_EQ(parse_omron_address("E1_100")->first, kEmBankWords + 100);
  EXPECT_EQ(parse_omron_address("EMC_5")->first, 12 * kEmBankWords + 5);
  EXPECT_EQ(parse_omron_address("TF5")->area, 9u);
  for (const char* wrong : {"", "DM", "E100", "DM1_1", "TF1.0", "DM1.16", "Q1", "EMD_0"})
    EXPECT_FALSE(parse_omron_address(wrong)) << wrong;
}

}  // namespace
}  // namespace fieldcast::sim
