#include "config/loader/loader.hpp"
#include "core/codec/checksum.hpp"
#include "core/protocol/omron_hostlink/hostlink.hpp"
#include "tests/tools/cli/scan_support.hpp"
#include "tests/tools/sim/device_setup.hpp"
#include "tests/tools/sim/listen.hpp"
#include "tools/cli/scan/identity.hpp"
#include "tools/cli/scan/scan_view.hpp"
#include "tools/sim/families/hostlink_device.hpp"

namespace fieldcast::cli {
namespace {

std::unique_ptr<Exchange> identity_of(std::string_view protocol, std::uint16_t address) {
  return identity_exchange({.protocol = {find_protocol(protocol), {}}}, address);
}

TEST(ScanIdentity, NothingThatComesBreaksIt) {
  std::uint32_t random = 1;
  for (unsigned run = 0; run < 3000; ++run) {
    const auto exchange = identity_of("omron-hostlink", 5);
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
  const auto exchange = identity_of("omron-hostlink", 7);
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
  const auto exchange = identity_of("omron-hostlink", 0);
  Bytes out;
  (void)exchange->start(out);
  ASSERT_EQ(exchange->on_bytes(bytes_of(hostlink_frame("@00MM005A")), out).kind, Step::Kind::kDone);
  EXPECT_EQ(identity_in(*exchange), "unknown model (model code 5A)");
}

TEST(ScanIdentity, ANewerOmronIsAskedByFinsToo) {
  sim::HostLinkDevice device(sim::test::device_setup(3));
  const auto receiver = device.open_receiver();
  const auto exchange = identity_of("omron-hostlink", 3);
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
    const auto exchange = identity_of("omron-hostlink", 0);
    Bytes out;
    (void)exchange->start(out);
    ASSERT_EQ(exchange->on_bytes(bytes_of(hostlink_frame("@00MM0030")), out).kind,
              Step::Kind::kSend);
    const Step step = *second == '\0' ? exchange->on_silence(out)
                                      : exchange->on_bytes(bytes_of(hostlink_frame(second)), out);
    EXPECT_EQ(step.kind, Step::Kind::kDone) << second;
    EXPECT_EQ(identity_in(*exchange), "CS/CJ (model code 30)") << second;
  }
  const auto refused = identity_of("omron-hostlink", 0);
  Bytes out;
  (void)refused->start(out);
  EXPECT_EQ(refused->on_bytes(bytes_of(hostlink_frame("@00MM21")), out).device_code, 0x21);
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
