#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <set>

#include "config/loader/loader.hpp"
#include "core/codec/checksum.hpp"
#include "core/protocol/omron_hostlink/hostlink.hpp"
#include "tests/tools/sim/device_setup.hpp"
#include "tests/tools/sim/listen.hpp"
#include "tools/cli/scan/identity.hpp"
#include "tools/cli/scan/scan_plan.hpp"
#include "tools/cli/scan/scan_view.hpp"
#include "tools/cli/scan/scanner.hpp"
#include "tools/sim/families/hostlink_device.hpp"

namespace fieldcast::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

NamedProtocol rtu() { return {find_protocol("modbus-rtu"), {}}; }

std::vector<ScanLine> lines_of(std::size_t formats, std::vector<std::uint16_t> addresses) {
  auto usual = usual_formats(rtu(), {}, {});
  usual.resize(formats);
  return scan_lines(rtu(), usual, addresses);
}

ScanResponse value() { return {.device = true, .took = std::chrono::milliseconds{3}, .bytes = 7}; }
ScanResponse silence() { return {.cause = Cause::kNoResponse}; }
ScanResponse noise() { return {.cause = Cause::kChecksum, .bytes = 3}; }

TEST(ScanPlan, ReadsAddresses) {
  EXPECT_THAT(*addresses_from("1-4"), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(*addresses_from("7,1,10-12,11"), ElementsAre(1, 7, 10, 11, 12));
  EXPECT_THAT(*addresses_from("65535"), ElementsAre(65535));
  for (const char* bad : {"", "x", "1-", "-3", "4-2", "1,,2", "1,", "70000", "1 2"})
    EXPECT_FALSE(addresses_from(bad)) << bad;
}

TEST(ScanPlan, FactoryFormatIsFirstAndNoneComesTwice) {
  for (const ProtocolEntry& entry : protocols()) {
    const auto formats = usual_formats({&entry, {}}, {}, {});
    EXPECT_EQ(formats.front(), entry.factory_line) << entry.name;
    std::set<std::string> texts;
    for (const auto& format : formats) EXPECT_TRUE(texts.insert(to_text(format)).second);
  }
  EXPECT_EQ(usual_formats(rtu(), {}, {}).size(), 12u);
}

TEST(ScanPlan, WhatIsSaidHolds) {
  for (const auto& format : usual_formats(rtu(), 300, {})) EXPECT_EQ(format.baud, 300u);
  const auto one = usual_formats(rtu(), 9600, LineFormat{1, 8, Parity::kOdd, 1});
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(to_text(one.front()), "9600 8O1");
}

TEST(ScanPlan, EveryProtocolHasAQuestionThatItsNotationNames) {
  for (const ProtocolEntry& entry : protocols()) {
    const auto protocol = scan_protocol({&entry, {}});
    ASSERT_TRUE(protocol) << entry.name;
    const auto questions = questions_of({&entry, {}}, *protocol);
    EXPECT_FALSE(questions.empty()) << entry.name;
    for (const auto& question : questions) {
      const auto parsed = protocol->parse_address(question.at);
      ASSERT_TRUE(parsed) << entry.name << ' ' << question.at;
      EXPECT_EQ(parsed->area, question.range.area);
      EXPECT_EQ(parsed->first, question.range.first);
    }
  }
}

TEST(ScanPlan, AddressesThatTheProtocolHasNotAreLeftOut) {
  const auto lines = scan_lines(rtu(), {LineFormat{}}, {0, 1, 247, 248, 300});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(lines.front().addresses, ElementsAre(1, 247));
  EXPECT_THAT(scan_lines(rtu(), {LineFormat{}}, {300}), IsEmpty());
}

std::vector<ScanLine> probed_lines(std::size_t formats, std::vector<std::uint16_t> addresses) {
  auto lines = lines_of(formats, std::move(addresses));
  plan_probes(lines);
  return lines;
}

TEST(ScanPlan, AllUsualSettingsAreProbedWithinTheQuickScan) {
  std::vector<std::uint16_t> addresses(32);
  std::iota(addresses.begin(), addresses.end(), std::uint16_t{1});
  const auto lines = probed_lines(12, addresses);
  EXPECT_GT(silent_scan_time(lines, std::chrono::milliseconds{200}), std::chrono::seconds{150});
  Duration time{};
  for (const ScanLine& line : lines) {
    EXPECT_GE(line.probes.size(), 12u) << to_text(line.format);
    EXPECT_EQ(line.probes.back(), 1) << "the most probable address has the longest wait";
    EXPECT_GE(line.probe_wait, std::chrono::milliseconds{10});
    // Each request is 8 characters.
    time += static_cast<std::int64_t>(line.probes.size()) * line.format.characters(8) +
            static_cast<std::int64_t>(line.probes.size() - 1) * line.probe_wait +
            line.last_probe_wait;
  }
  EXPECT_LT(time, kQuickScan - std::chrono::seconds{1}) << "opening the port takes time, too";
}

TEST(ScanPlan, AKnownSettingIsProbedWithLongWaits) {
  const auto lines = probed_lines(1, {1, 2, 3, 4});
  EXPECT_THAT(lines.front().probes, ElementsAre(2, 3, 4, 1));
  EXPECT_GE(lines.front().probe_wait, std::chrono::milliseconds{150});
}

TEST(Scanner, ASilentLineIsProbedOnce) {
  Scanner scanner(probed_lines(3, {1, 2}));
  std::size_t left = scanner.left();
  while (const auto ask = scanner.next()) {
    EXPECT_EQ(scanner.left(), left--);
    EXPECT_TRUE(ask->wait);
    EXPECT_EQ(ask->first, ask->address == 2);
    scanner.on_response(silence());
  }
  EXPECT_EQ(scanner.asked(), 6u);
  EXPECT_TRUE(scanner.silent());
  const auto text = silence_lines("/dev/ttyUSB0", scanner, true, std::chrono::milliseconds{200});
  ASSERT_EQ(text.size(), 4u);
  EXPECT_EQ(text[0], "no byte was received on /dev/ttyUSB0");
  EXPECT_EQ(text[1],
            "  2 addresses from 1 to 2 were probed: modbus-rtu 19200 8E1, modbus-rtu 9600 8N1, "
            "modbus-rtu 9600 8E1");
  EXPECT_THAT(text[2], HasSubstr("A and B"));
  EXPECT_THAT(text[3], HasSubstr("--all requests every address twice"));
  EXPECT_THAT(text[3], HasSubstr("it takes about 7s"));
}

TEST(Scanner, ALineOnWhichBytesAreReceivedTwiceIsSearched) {
  Scanner scanner(probed_lines(4, {1, 2, 3}));
  std::vector<std::string> asked;
  while (const auto ask = scanner.next()) {
    asked.push_back(std::to_string(ask->line) + (ask->wait ? '?' : ':') +
                    std::to_string(ask->address));
    const bool there = ask->line == 1 && ask->address == 2;
    // The response to a probe is late: it is received while address 3 is probed.
    const bool late = ask->line == 1 && ask->address == 3 && ask->wait.has_value();
    ScanResponse answer = there && !ask->wait ? value() : silence();
    answer.heard = late;
    scanner.on_response(answer);
  }
  EXPECT_THAT(asked, ElementsAre("0?2", "0?3", "0?1", "1?2", "1?3", "1?2", "1?3", "1:1", "1:2",
                                 "1:3", "1:1", "1:3"));
  ASSERT_EQ(scanner.found().size(), 1u);
  EXPECT_EQ(scanner.found()[0].address, 2);
  EXPECT_FALSE(scanner.silent());
}

TEST(Scanner, AByteThatIsReceivedOnceStartsNoSearch) {
  Scanner scanner(probed_lines(3, {1, 2, 3}));
  std::map<std::size_t, unsigned> asked;
  while (const auto ask = scanner.next()) {
    ASSERT_TRUE(ask->wait);
    ScanResponse answer = silence();
    answer.heard = asked[ask->line]++ == 0;
    scanner.on_response(answer);
  }
  EXPECT_EQ(asked[0], 4u);
  EXPECT_TRUE(scanner.silent());
}

TEST(Scanner, AfterALineWithBytesButNoDeviceTheNextIsProbed) {
  Scanner scanner(probed_lines(2, {1, 2}));
  std::set<std::size_t> searched;
  unsigned probes = 0;
  while (const auto ask = scanner.next()) {
    if (ask->wait)
      ++probes;
    else
      searched.insert(ask->line);
    const bool there = ask->line == 1 && ask->address == 2;
    ScanResponse answer = there ? value() : ask->line == 0 ? noise() : silence();
    answer.heard = ask->line == 0;
    scanner.on_response(answer);
  }
  EXPECT_EQ(probes, 3u) << "two of line 0, one of line 1, which brought a value";
  EXPECT_THAT(searched, ElementsAre(0, 1));
  EXPECT_EQ(scanner.found().size(), 1u);
}

TEST(Scanner, AsksEveryLineTwiceWhenNobodyResponds) {
  Scanner scanner(lines_of(3, {1, 2}));
  std::multiset<std::tuple<std::size_t, int, std::size_t>> asked;
  std::size_t left = scanner.left();
  while (const auto ask = scanner.next()) {
    EXPECT_EQ(scanner.left(), left--);
    asked.insert({ask->line, ask->address, ask->question});
    scanner.on_response(silence());
  }
  EXPECT_EQ(asked.size(), 12u);
  EXPECT_EQ((std::set(asked.begin(), asked.end()).size()), 12u);
  EXPECT_EQ(scanner.left(), 0u);
  EXPECT_THAT(scanner.found(), IsEmpty());
}

TEST(Scanner, AResponseSettlesTheLineAndTheSilentAreAskedAgain) {
  Scanner scanner(lines_of(5, {1, 2, 3, 4}));
  std::vector<std::string> asked;
  while (const auto ask = scanner.next()) {
    asked.push_back(std::to_string(ask->line) + ':' + std::to_string(ask->address) + '/' +
                    std::to_string(ask->question));
    const bool first = ask->line == 1 && ask->address == 2;
    const bool second = ask->line == 1 && ask->address == 3 && ask->question == 1;
    scanner.on_response(first || second ? value() : silence());
  }
  EXPECT_THAT(asked, ElementsAre("0:1/0", "0:2/0", "0:3/0", "0:4/0", "1:1/0", "1:2/0", "1:3/0",
                                 "1:4/0", "1:1/1", "1:3/1", "1:4/1"));
  ASSERT_EQ(scanner.found().size(), 2u);
  EXPECT_EQ(scanner.found()[0].address, 2);
  EXPECT_EQ(scanner.found()[1].address, 3);
}

TEST(Scanner, ALineOnWhichOthersSpeakIsLeft) {
  Scanner scanner(lines_of(2, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
  std::map<std::size_t, unsigned> asked;
  while (const auto ask = scanner.next()) {
    ++asked[ask->line];
    scanner.on_response(ask->line == 0 ? noise() : silence());
  }
  EXPECT_EQ(asked[0], Scanner::kBabble + 1);
  EXPECT_EQ(asked[1], 20u);
  EXPECT_THAT(scanner.noisy_lines(), ElementsAre(0));
}

TEST(Scanner, BrokenResponsesThatBeginRightSettleTheLine) {
  Scanner scanner(lines_of(3, {1, 2, 3}));
  std::set<std::size_t> lines;
  while (const auto ask = scanner.next()) {
    lines.insert(ask->line);
    const bool valid = ask->address == 3 && ask->question == 1;
    const ScanResponse broken{
        .cause = Cause::kChecksum, .bytes = 7, .shape = ResponseShape::kWhole};
    scanner.on_response(ask->address == 1 ? silence() : valid ? value() : broken);
  }
  EXPECT_THAT(lines, ElementsAre(0));
  ASSERT_EQ(scanner.broken().size(), 1u) << "address 3 answered the second question";
  EXPECT_EQ(scanner.broken()[0].address, 2);
  EXPECT_EQ(scanner.broken()[0].shape, ResponseShape::kWhole);
}

TEST(Scanner, AnEchoIsNobodyWhoSpeaks) {
  Scanner scanner(lines_of(1, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
  while (scanner.next())
    scanner.on_response({.cause = Cause::kNoResponse, .bytes = 8, .echo_alone = true});
  EXPECT_EQ(scanner.asked(), 20u);
  EXPECT_TRUE(scanner.echoed());
  EXPECT_THAT(scanner.noisy_lines(), IsEmpty());
}

TEST(Scanner, AllRespondTogether) {
  Scanner scanner(lines_of(2, {1, 2}));
  unsigned asked = 0;
  while (scanner.next()) {
    scanner.on_response(value());
    ++asked;
  }
  EXPECT_EQ(asked, 2u);
}

TEST(ScanIdentity, ModbusDevicesNameThemselves) {
  // The example of Modbus Application Protocol V1.1b3, 6.21.
  const std::string vendor = "Company identification", product = "Product code XX",
                    version = "V2.11";
  Bytes answer{5, 0x2B, 0x0E, 1, 1, 0, 0, 3};
  std::uint8_t id = 0;
  for (const auto& text : {vendor, product, version}) {
    answer.push_back(id++);
    answer.push_back(static_cast<std::uint8_t>(text.size()));
    answer.insert(answer.end(), text.begin(), text.end());
  }
  const std::uint16_t crc = crc16_modbus(answer);
  answer.push_back(static_cast<std::uint8_t>(crc));
  answer.push_back(static_cast<std::uint8_t>(crc >> 8));

  const auto exchange = identity_exchange("modbus-rtu", 5);
  Bytes out;
  EXPECT_EQ(exchange->start(out).kind, Step::Kind::kSend);
  EXPECT_EQ(to_hex(ByteView(out).first(5)), "05 2B 0E 01 00");
  for (std::size_t size = 1; size < answer.size(); ++size)
    EXPECT_EQ(exchange->on_bytes(ByteView(answer).first(size), out).kind, Step::Kind::kNeedMore);
  ASSERT_EQ(exchange->on_bytes(answer, out).kind, Step::Kind::kDone);
  const Bytes& items = exchange->reply().front().items;
  EXPECT_EQ(std::string(items.begin(), items.end()), vendor + ", " + product + ", " + version);
}

TEST(ScanIdentity, NothingThatComesBreaksIt) {
  std::uint32_t random = 1;
  for (const char* protocol : {"modbus-rtu", "modbus-ascii", "modbus-tcp", "omron-hostlink"}) {
    for (unsigned run = 0; run < 3000; ++run) {
      const auto exchange = identity_exchange(protocol, 5);
      Bytes out, bytes;
      (void)exchange->start(out);
      for (unsigned i = 0; i < 40; ++i) {
        random = random * 1664525 + 1013904223;
        bytes.push_back(i < 3 && (random >> 30) != 0 ? out[i]
                                                     : static_cast<std::uint8_t>(random >> 24));
      }
      if (exchange->on_bytes(bytes, out).kind == Step::Kind::kDone) {
        EXPECT_EQ(exchange->reply().size(), 1u);
      }
    }
  }
}

TEST(ScanIdentity, ARefusalIsNotAName) {
  Bytes answer{5, 0xAB, 1};
  const std::uint16_t crc = crc16_modbus(answer);
  answer.push_back(static_cast<std::uint8_t>(crc));
  answer.push_back(static_cast<std::uint8_t>(crc >> 8));
  const auto exchange = identity_exchange("modbus-rtu", 5);
  Bytes out;
  (void)exchange->start(out);
  const Step step = exchange->on_bytes(answer, out);
  EXPECT_EQ(step.kind, Step::Kind::kFailed);
  EXPECT_EQ(step.cause, Cause::kDeviceError);
  EXPECT_EQ(identity_exchange("s7-ppi", 5), nullptr);
}

std::string hostlink_frame(const std::string& body) {
  Bytes frame(body.begin(), body.end());
  omron::append_end(frame, 0, true);
  return {frame.begin(), frame.end()};
}
Bytes bytes_of(const std::string& text) { return {text.begin(), text.end()}; }
std::string identity_in(const Exchange& exchange) {
  const Bytes& items = exchange.reply().front().items;
  return {items.begin(), items.end()};
}

TEST(ScanIdentity, AnOlderOmronNamesItsModel) {
  const auto exchange = identity_exchange("omron-hostlink", 7);
  Bytes out;
  EXPECT_EQ(exchange->start(out).kind, Step::Kind::kSend);
  EXPECT_EQ(std::string(out.begin(), out.end()), hostlink_frame("@07MM"));
  const Bytes answer = bytes_of(hostlink_frame("@08MM0001") + hostlink_frame("@07MM0012"));
  for (std::size_t size = 1; size < answer.size(); ++size)
    EXPECT_EQ(exchange->on_bytes(ByteView(answer).first(size), out).kind, Step::Kind::kNeedMore);
  ASSERT_EQ(exchange->on_bytes(answer, out).kind, Step::Kind::kDone);
  EXPECT_EQ(identity_in(*exchange), "C20H/C28H/C40H/C200H/C200HS/C200HX/HG/HE (model code 12)");
}

TEST(ScanIdentity, AnUnknownModelIsShownByItsCode) {
  EXPECT_EQ(hostlink_model_text(0x5A), "unknown model (model code 5A)");
  const auto exchange = identity_exchange("omron-hostlink", 0);
  Bytes out;
  (void)exchange->start(out);
  ASSERT_EQ(exchange->on_bytes(bytes_of(hostlink_frame("@00MM005A")), out).kind, Step::Kind::kDone);
  EXPECT_EQ(identity_in(*exchange), "unknown model (model code 5A)");
}

TEST(ScanIdentity, ANewerOmronIsAskedByFinsToo) {
  sim::HostLinkDevice device(sim::test::device_setup(3));
  const auto receiver = device.open_receiver();
  const auto exchange = identity_exchange("omron-hostlink", 3);
  Bytes out;
  Step step = exchange->start(out);
  for (int question = 0; question < 2; ++question) {
    ASSERT_EQ(step.kind, Step::Kind::kSend);
    const Bytes answer = sim::test::listen(*receiver, out).response;
    EXPECT_EQ(answer.size(), step.characters);
    out.clear();
    step = exchange->on_bytes(answer, out);
  }
  ASSERT_EQ(step.kind, Step::Kind::kDone);
  EXPECT_EQ(identity_in(*exchange), "CS/CJ (model code 30), CS1H-CPU67H, 04.00");
}

TEST(ScanIdentity, TheModelStaysWhereFinsHasNoResponse) {
  for (const char* second : {"", "@00IC", "@00FA18", "@00FA00400000000501040100"}) {
    const auto exchange = identity_exchange("omron-hostlink", 0);
    Bytes out;
    (void)exchange->start(out);
    ASSERT_EQ(exchange->on_bytes(bytes_of(hostlink_frame("@00MM0030")), out).kind,
              Step::Kind::kSend);
    const Step step = *second == '\0' ? exchange->on_silence(out)
                                      : exchange->on_bytes(bytes_of(hostlink_frame(second)), out);
    EXPECT_EQ(step.kind, Step::Kind::kDone) << second;
    EXPECT_EQ(identity_in(*exchange), "CS/CJ (model code 30)") << second;
  }
  const auto refused = identity_exchange("omron-hostlink", 0);
  Bytes out;
  (void)refused->start(out);
  EXPECT_EQ(refused->on_bytes(bytes_of(hostlink_frame("@00MM21")), out).device_code, 0x21);
}

TEST(ScanTemplates, TheIdentityOfADeviceChoosesThem) {
  const auto heads = template_heads(config::disk_reader(), config::default_options());
  EXPECT_GT(heads.size(), 40u);
  const auto of = [&](std::string_view identity, std::string_view protocol = "modbus-rtu") {
    return matching_templates(identity, protocol, heads);
  };
  EXPECT_THAT(of("Siemens AG, SENTRON PAC3200, 2.1"), ElementsAre("siemens-pac3200"));
  EXPECT_THAT(of("Schneider Electric, PM5340, V1.05"), ElementsAre("schneider-pm5000"));
  EXPECT_THAT(of("CARLO GAVAZZI, EM24DINAV93XISX"), ElementsAre("carlo-gavazzi-em24"));
  EXPECT_THAT(of("Carlo Gavazzi, EM24DINAV23XE1", "modbus-tcp"),
              ElementsAre("carlo-gavazzi-em24-ethernet"));
  EXPECT_THAT(of("Huawei, SUN2000"), ElementsAre("huawei-sun2000", "huawei-sun2000-storage"));
  EXPECT_THAT(of("Siemens AG, PAC3200", "s7-ppi"), IsEmpty())
      << "the template has no such protocol";
  EXPECT_THAT(of("Other, PM5340"), IsEmpty()) << "another maker";
  EXPECT_THAT(of("Siemens AG, S7-1200"), IsEmpty()) << "the maker alone";
  EXPECT_THAT(of("Chint, DTSU666H"), ElementsAre("chint-dtsu666"));
  EXPECT_THAT(of(""), IsEmpty());
}

TEST(ScanTemplates, AHeadIsReadFromTheText) {
  const auto head = template_head("x",
                                  "# Device:  Acme X100; not the Y200\r\ndescription: A meter\n"
                                  "protocols: [modbus-rtu, s7-ppi]\n");
  EXPECT_EQ(head.device, "Acme X100; not the Y200");
  EXPECT_EQ(head.description, "A meter");
  EXPECT_THAT(head.protocols, ElementsAre("modbus-rtu", "s7-ppi"));
  EXPECT_THAT(matching_templates("Acme Y200", "modbus-rtu", {head}), IsEmpty());
}

TEST(ScanTemplates, AreWrittenIntoTheConfiguration) {
  Scanner scanner(lines_of(1, {1, 2, 3}));
  for (int i = 0; i < 3; ++i) scanner.on_response(value());
  scanner.set_templates(0, {"siemens-pac3200"});
  scanner.set_templates(1, {"huawei-sun2000", "huawei-sun2000-storage"});
  const std::string text = configuration_text("/dev/ttyUSB0", true, scanner);
  EXPECT_THAT(text, HasSubstr("address: 1\n        template: siemens-pac3200\n      - name"));
  EXPECT_THAT(text, HasSubstr("in place of the channels: template: huawei-sun2000-storage\n"));
  const auto loaded =
      config::load_text(text, "found.yaml", config::disk_reader(), config::default_options());
  ASSERT_TRUE(loaded) << config::to_text(loaded.error().front());
  EXPECT_GT(loaded->buses.front().devices.front().channels.size(), 10u);
  EXPECT_THAT(template_lines(scanner),
              ElementsAre("address 1: template: siemens-pac3200",
                          "address 2: template: huawei-sun2000 or huawei-sun2000-storage",
                          HasSubstr("--out FILE")));
}

TEST(ScanView, WhatDevicesSayStaysAComment) {
  Scanner scanner(lines_of(1, {1, 2}));
  scanner.on_response(value());
  scanner.on_response({.device = true, .cause = Cause::kDeviceError, .device_code = 2, .bytes = 5});
  scanner.set_identity(0, "Evil\n      - name: more\x1b[2J");
  const std::string text = configuration_text("/dev/ttyUSB0", true, scanner);
  EXPECT_THAT(text, HasSubstr("baud: 19200, format: 8E1"));
  EXPECT_THAT(text, HasSubstr("# it says: Evil\\n      - name: more\\x1B[2J\n"));
  EXPECT_THAT(text, HasSubstr("# it responds, but refuses: 02 illegal data address"));
}

}  // namespace
}  // namespace fieldcast::cli
