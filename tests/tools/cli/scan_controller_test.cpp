#include "config/loader/loader.hpp"
#include "tests/tools/cli/scan_support.hpp"
#include "tests/tools/sim/device_setup.hpp"
#include "tests/tools/sim/listen.hpp"
#include "tools/cli/scan/identity.hpp"
#include "tools/cli/scan/scan_view.hpp"
#include "tools/sim/families/fins_tcp_device.hpp"
#include "tools/sim/families/mc_device.hpp"
#include "tools/sim/families/s7_tcp_device.hpp"

namespace fieldcast::cli {
namespace {

using testing::Contains;
using testing::SizeIs;

std::vector<ScanLine> links_of(std::string_view protocol) {
  const NamedProtocol named{find_protocol(protocol), {}};
  return scan_lines(named, {named.factory_line()}, {1, 2, 3});
}

Bytes bytes(std::string_view digits) { return *from_hex(digits); }

std::string text_of(const Exchange& exchange) {
  const Bytes& items = exchange.reply().front().items;
  return {items.begin(), items.end()};
}

TEST(ScanController, EachUsualLinkIsTriedOnce) {
  std::vector<Bytes> connects;
  for (const ScanLine& line : links_of("s7-tcp")) {
    ASSERT_THAT(line.addresses, SizeIs(1));
    const auto protocol = scan_protocol(line, line.addresses.front());
    ASSERT_NE(protocol, nullptr) << line_text(line, false);
    const auto questions = questions_of(line.protocol, *protocol);
    ASSERT_FALSE(questions.empty()) << line_text(line, false);
    Bytes out;
    (void)protocol->begin(ReadRequest{{questions.front().range}}, {})->start(out);
    EXPECT_THAT(connects, testing::Not(Contains(out)));
    connects.push_back(out);
  }
  EXPECT_EQ(connects[0], bytes("0300001611E00000000100C0010AC1020100C2020301"));
  EXPECT_EQ(connects[5], bytes("0300001611E00000000100C0010AC1020300C2020200"));
  EXPECT_THAT(links_of("mitsubishi-mc"), SizeIs(4));
  EXPECT_THAT(links_of("omron-fins"), SizeIs(1));
  EXPECT_THAT(links_of("modbus-tcp"), SizeIs(1));
}

TEST(ScanController, TheConfigurationHasTheOptionsThatWork) {
  Scanner scanner(links_of("s7-tcp"));
  while (scanner.next()->line < 5) scanner.on_response({.cause = Cause::kPortClosed});
  scanner.on_response(value());
  while (scanner.next()) scanner.on_response(silence());
  ASSERT_THAT(scanner.found(), SizeIs(1));
  const std::string text = configuration_text("10.0.0.7:102", false, scanner);
  EXPECT_THAT(text, HasSubstr("        address: 0\n        options: { cpu: \"s7-200\", "
                              "local-tsap: \"03.00\", tsap: \"02.00\" }\n"));
  EXPECT_TRUE(
      config::load_text(text, "found.yaml", config::disk_reader(), config::default_options()))
      << text;
  const Json json = found_json("10.0.0.7:102", scanner.lines()[5], scanner.found()[0], false);
  EXPECT_THAT(json.text(), HasSubstr(R"("tsap":"02.00")"));
}

// Speaks with a simulated device until the exchange ends.
Step speak(Exchange& exchange, sim::Receiver& receiver) {
  Bytes out;
  Step step = exchange.start(out);
  while (step.kind == Step::Kind::kSend) {
    const Bytes request = std::exchange(out, {});
    const Bytes response = sim::test::listen(receiver, request).response;
    for (std::size_t size = 0; size < response.size(); ++size)
      EXPECT_EQ(exchange.on_bytes(ByteView(response).first(size), out).kind, Step::Kind::kNeedMore);
    step = exchange.on_bytes(response, out);
    EXPECT_NE(step.kind, Step::Kind::kNeedMore) << to_hex(request) << " got " << to_hex(response);
  }
  return step;
}

// The first question of the scan, which connects, then the identity on the same connection.
std::string identity_of(const ScanLine& line, sim::SimDevice& device) {
  const auto receiver = device.open_receiver();
  const auto protocol = scan_protocol(line, line.addresses.front());
  Bytes session;
  const ReadRequest first{{questions_of(line.protocol, *protocol).front().range}};
  EXPECT_EQ(speak(*protocol->begin(first, {1, &session}), *receiver).kind, Step::Kind::kDone);
  const auto exchange = identity_exchange(line, line.addresses.front(), {2, &session});
  EXPECT_EQ(speak(*exchange, *receiver).kind, Step::Kind::kDone);
  return text_of(*exchange);
}

TEST(ScanController, ASimulatedControllerNamesItself) {
  for (const ScanLine& line : links_of("mitsubishi-mc")) {
    auto setup = sim::test::device_setup(line.addresses.front());
    setup.spec.link.options = line.options;
    sim::McDevice device(setup);
    EXPECT_EQ(identity_of(line, device), "Q03UDECPU (code 0268)") << line_text(line, false);
  }
  auto setup = sim::test::device_setup(0);
  setup.first_on_bus = true;
  sim::FinsTcpDevice fins(setup);
  EXPECT_THAT(identity_of(links_of("omron-fins").front(), fins), HasSubstr("CS1H-CPU67H"));
  const auto s7 = sim::make_s7_tcp_device(sim::test::device_setup(1));
  EXPECT_EQ(identity_of(links_of("s7-tcp").front(), **s7),
            "CPU 1511-1 PN, 6ES7 511-1AK02-0AB0, V2.9.4, PDU 960 bytes, 16 connections");
}

TEST(ScanController, WhatIsRefusedIsMissing) {
  const auto exchange = controller_identity(links_of("s7-tcp").front(), {1});
  Bytes out;
  EXPECT_EQ(exchange->start(out).kind, Step::Kind::kSend);
  EXPECT_EQ(out, bytes("0300002102F080 320700000001 0008 0008 0001120411440100 FF090004 001C0000"));
  const Bytes refusal =
      bytes("0300002102F080 320700000001 000C 0004 000112081284010100 00D401 0A000000");
  out.clear();
  EXPECT_EQ(exchange->on_bytes(refusal, out).kind, Step::Kind::kSend);
  EXPECT_EQ(out, bytes("0300002102F080 320700000001 0008 0008 0001120411440100 FF090004 00110000"));
  EXPECT_EQ(exchange->on_bytes(refusal, out).kind, Step::Kind::kSend);
  EXPECT_EQ(exchange->on_bytes(refusal, out).kind, Step::Kind::kFailed);
}

TEST(ScanController, OmronNamesItselfWithTheNodesOfTheConnection) {
  const ScanLine line = links_of("omron-fins").front();
  EXPECT_EQ(controller_identity(line, {1}), nullptr) << "no greeting yet";
  Bytes session{0x0A, 0x01};
  const auto exchange = controller_identity(line, {7, &session});
  Bytes out;
  EXPECT_EQ(exchange->start(out).kind, Step::Kind::kSend);
  EXPECT_EQ(out, bytes("46494E53 00000015 00000002 00000000 80000200010000 0A0007 050100"));
  Bytes response = bytes("46494E53 0000003E 00000002 00000000 C00002000A00000100 07 0501 0000");
  for (const std::string_view text : {"CJ2M-CPU35          ", "02.01               "})
    response.insert(response.end(), text.begin(), text.end());
  ASSERT_EQ(exchange->on_bytes(response, out).kind, Step::Kind::kDone);
  EXPECT_EQ(text_of(*exchange), "CJ2M-CPU35, 02.01");
}

}  // namespace
}  // namespace fieldcast::cli
