#include "tests/support/vectors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/protocol/modbus/framing.hpp"
#include "tests/protocol/modbus/reference.hpp"
#include "tests/support/drive.hpp"

namespace fieldcast::modbus {
namespace {

using reference::Meant;
using test::GoldenVector;
using test::Outcome;

const Framing& framing_of(const GoldenVector& vector) {
  if (vector.framing == "ascii") return ascii_framing();
  return vector.framing == "tcp" ? tcp_framing() : rtu_framing();
}
Explainer explainer_of(const GoldenVector& vector) {
  if (vector.framing == "ascii") return explain_ascii;
  return vector.framing == "tcp" ? explain_tcp : explain_rtu;
}
std::string fault_in(const std::vector<FrameField>& fields) {
  for (const FrameField& field : fields) {
    if (!field.fault.empty()) return field.name + ": " + field.fault;
  }
  return {};
}

// Functions of the standard that Fieldcast never sends.
bool is_unused_function(ByteView pdu) {
  static const std::set<int> used{1, 2, 3, 4, 5, 6, 15, 16, 20, 21, 23, 24, 43};
  if (!pdu.empty() && pdu[0] == 43 && pdu.size() > 2 && pdu[2] != 4)
    return true;  // see AStreamOfObjectsIsRead
  return pdu.empty() || !used.contains(pdu[0] & 0x7F);
}

class ModbusVectors : public testing::TestWithParam<GoldenVector> {
 protected:
  const GoldenVector& vector() const { return GetParam(); }

  // The request of the vector; derived from its response if it has none that may be sent.
  struct Asked {
    Meant meant;
    Header header;
  };
  std::optional<Asked> asked(ByteView answer_frame) const {
    if (const auto request = reference::open(vector().framing, vector().request)) {
      auto meant = reference::request_of(request->pdu);
      if (meant && pdu_sizes(meant->request, meant->options))
        return Asked{*meant, {request->unit, request->transaction}};
    }
    const auto answer = reference::open(vector().framing, answer_frame);
    if (!answer) return std::nullopt;
    auto meant = reference::request_for(answer->pdu);
    if (!meant) return std::nullopt;
    return Asked{*meant, {answer->unit, answer->transaction}};
  }
  Outcome outcome(const Asked& asked, const Bytes& answer) const {
    ModbusExchange exchange(framing_of(vector()), asked.header, asked.meant.request,
                            asked.meant.options);
    return test::drive(exchange, answer);
  }
};

TEST_P(ModbusVectors, OurRequestIsTheirs) {
  const auto opened = reference::open(vector().framing, vector().request);
  if (vector().kind != "ok" || !opened || is_unused_function(opened->pdu)) return;
  const auto meant = reference::request_of(opened->pdu);
  ASSERT_TRUE(meant.has_value());
  ASSERT_TRUE(pdu_sizes(meant->request, meant->options).has_value());
  ModbusExchange exchange(framing_of(vector()), Header{opened->unit, opened->transaction},
                          meant->request, meant->options);
  Bytes ours;
  (void)exchange.start(ours);
  if (vector().name == "rtu_fc15_rodbus") {  // it sets bits beyond the quantity; the standard and
                                             // Fieldcast pad with zeros
    const auto again = reference::open("rtu", ours);
    ASSERT_TRUE(again.has_value());
    EXPECT_EQ(to_hex(again->pdu), "0F 00 10 00 0A 02 12 00");
    return;
  }
  EXPECT_EQ(to_hex(ours), to_hex(vector().request));
}

TEST_P(ModbusVectors, TheirResponseIsRead) {
  const auto answer = reference::open(vector().framing, vector().response);
  if (vector().kind != "ok" || !answer || is_unused_function(answer->pdu)) return;
  if (vector().name == "tcp_split_fc02_pymodbus")
    return;  // has the form of a request: see AMalformedResponseHasNoValue
  const auto request = asked(vector().response);
  ASSERT_TRUE(request.has_value());
  const Outcome result = outcome(*request, vector().response);
  ASSERT_TRUE(result.done()) << to_text(result);
  EXPECT_EQ(to_hex(result.reply.back().items),
            to_hex(reference::items_of(answer->pdu, request->meant.request)));
}

TEST_P(ModbusVectors, AnExceptionIsItsCode) {
  const auto answer = reference::open(vector().framing, vector().response);
  if (vector().kind != "exception" || is_unused_function(answer.value().pdu)) return;
  const auto request = asked(vector().response);
  ASSERT_TRUE(request.has_value());
  const Outcome result = outcome(*request, vector().response);
  const int code = answer->pdu[1];
  EXPECT_EQ(result.cause, code <= 3 || code == 7 ? Cause::kDeviceError : Cause::kDeviceBusy);
  EXPECT_EQ(result.code, code);
}

TEST_P(ModbusVectors, ARequestThatMustBeRefusedIsNeverSent) {
  const auto opened = reference::open(vector().framing, vector().request);
  const bool by_quantity = vector().texts.at("meaning").find("quantity") != std::string::npos ||
                           vector().texts.at("meaning").find("exceeds") != std::string::npos;
  if (vector().kind != "exception" || !by_quantity || !opened) return;
  const auto meant = reference::request_of(opened->pdu);
  if (meant) { EXPECT_FALSE(pdu_sizes(meant->request, meant->options).has_value()); }
}

TEST_P(ModbusVectors, AMalformedResponseHasNoValue) {
  const bool shape = vector().name == "tcp_split_fc02_pymodbus";
  if ((vector().kind != "malformed" && !shape) || vector().response.empty() ||
      vector().expect == "resync_optional")
    return;
  auto request = asked(vector().response);
  if (!request) {  // the vector has no request: assume one holding register
    request = Asked{{ReadRequest{{{2, 0, 1}}}, {}}, {vector().response[0], 0}};
  }
  const Outcome result = outcome(*request, vector().response);
  EXPECT_FALSE(result.done()) << to_text(result);
  static const std::map<std::string, std::set<Cause>> expected{
      {"crc_error", {Cause::kChecksum}},
      {"lrc_error", {Cause::kChecksum}},
      {"mismatched_function",
       {Cause::kForeign, Cause::kChecksum}},  // a length-driven parser finds another end
      {"wrong_unit", {Cause::kForeign}},
      {"pdu_length_error", {Cause::kMalformed, Cause::kForeign}},
      {"protocol_id", {Cause::kMalformed}},
      {"length_error", {Cause::kMalformed}},
      {"incomplete", {Cause::kTruncated}},
  };
  const auto row = expected.find(vector().expect);
  if (row != expected.end()) {
    EXPECT_TRUE(row->second.contains(result.cause)) << to_text(result.cause);
  }
}

TEST_P(ModbusVectors, TheExplanationFindsAFaultWhereThereIsOne) {
  const Explainer explain = explainer_of(vector());
  if (vector().kind == "ok" && !vector().request.empty()) {
    EXPECT_EQ(fault_in(explain(vector().request)), "");
  }
  if (vector().kind != "malformed" && !vector().response.empty()) {
    EXPECT_EQ(fault_in(explain(vector().response)), "");
  }
  static const std::set<std::string> inner{
      "crc_error",          "lrc_error",      "pdu_length_error", "protocol_id",
      "length_error",       "syntax_error",   "incomplete",       "frame_ok_illegal_function",
      "frame_ok_pdu_short", "resync_optional"};
  if (vector().kind != "malformed" || !inner.contains(vector().expect)) return;
  if (vector().name == "tcp_fc05like_pymodbus" || vector().name == "tcp_fc03like_pymodbus")
    return;  // valid as requests
  const Bytes& frame = vector().response.empty() ? vector().request : vector().response;
  EXPECT_NE(fault_in(explain(frame)), "") << to_hex(frame);
}

INSTANTIATE_TEST_SUITE_P(Golden, ModbusVectors, testing::ValuesIn(test::load_vectors("modbus")),
                         [](const auto& instance) {
                           std::string name = instance.param.name;
                           std::replace_if(
                               name.begin(), name.end(),
                               [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
                           return name;
                         });

GoldenVector named(const std::string& name) {
  for (const GoldenVector& vector : test::load_vectors("modbus")) {
    if (vector.name == name) return vector;
  }
  ADD_FAILURE() << "no vector " << name;
  return {};
}

TEST(ModbusVector, ALateResponseIsPassedOverForTheRightOne) {
  const GoldenVector late = named("late_response_after_timeout");
  const auto request = reference::open("rtu", late.hex("second_request"));
  ASSERT_TRUE(request.has_value());
  ModbusExchange exchange(rtu_framing(), Header{request->unit, 0},
                          reference::request_of(request->pdu)->request, {});
  Bytes stream = late.response;
  append(stream, late.hex("second_response"));
  const Outcome result = test::drive_bytewise(exchange, {&stream, 1});
  ASSERT_TRUE(result.done()) << to_text(result);
  EXPECT_EQ(to_hex(result.reply[0].items), "00 01 00 02");
}

TEST(ModbusVector, AGoodFrameBehindABadOneIsRead) {
  const GoldenVector stream = named("rtu_stream_bad_then_good");
  ModbusExchange exchange(rtu_framing(), Header{0, 0}, ReadRequest{{{2, 124, 2}}}, {});
  const Outcome result = test::drive(exchange, stream.response);
  EXPECT_EQ(result.cause, Cause::kDeviceError);
  EXPECT_EQ(result.code, 2);
}

// A scan reads them. Address id:basic.
TEST(ModbusVector, AStreamOfObjectsIsOneText) {
  for (const char* framing : {"rtu", "ascii", "tcp"}) {
    const GoldenVector basic = named("spec_" + std::string(framing) + "_fc43_14_basic");
    const Range all{static_cast<AreaIndex>(Table::kIdentity), kBasicObjects * kObjectCharacters,
                    kObjectCharacters};
    ModbusExchange exchange(framing_of(basic), Header{17, 0x1501}, ReadRequest{{all}}, {});
    Bytes request;
    (void)exchange.start(request);
    EXPECT_EQ(to_hex(request), to_hex(basic.request));
    const Outcome result = test::drive(exchange, basic.response);
    ASSERT_TRUE(result.done()) << to_text(result);
    const Bytes& items = result.reply.at(0).items;
    EXPECT_EQ(items.size(), kObjectCharacters);
    EXPECT_STREQ(std::string(items.begin(), items.end()).c_str(),
                 "Company identification, Product code XX, V2.11");
  }
}

TEST(ModbusVector, AMaskWriteIsTheStandardsExampleForOneBit) {
  // V1.1b3, 6.16 writes several bits, Fieldcast one. The masks differ, the frame does not.
  ModbusExchange exchange(tcp_framing(), Header{17, 0x1501},
                          WriteRequest{.range = {2, 4, 1}, .items = {0, 0x20}, .bit = 5},
                          {.mask_write = true});
  Bytes request;
  (void)exchange.start(request);
  EXPECT_EQ(to_hex(request), "15 01 00 00 00 08 11 16 00 04 FF DF 00 20");
}

}  // namespace
}  // namespace fieldcast::modbus
