// What `fieldcast inspect` shows of frames of declared protocols.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "config/loader/loader.hpp"
#include "core/program/last_request.hpp"
#include "core/protocol/declared/declaration.hpp"
#include "tests/support/declared_device.hpp"

namespace fieldcast::test {
namespace {

using declared::Sender;

// "response: read; begin 0+1=68; ..", with the fault behind "!!".
std::string explained(const declared::Declaration& declaration, const std::string& hex,
                      Sender sender = Sender::kUnknown) {
  std::string text;
  for (const FrameField& field : declared::explain(declaration, *from_hex(hex), sender)) {
    text += text.empty()
                ? field.value
                : fmt::format("; {} {}+{}={}", field.name, field.offset, field.length, field.value);
    if (!field.fault.empty()) text += " !! " + field.fault;
  }
  return text;
}

// `begin` is empty for COBS, which has no mark there.
std::shared_ptr<const declared::Declaration> escaped(const std::string& escape,
                                                     const std::string& begin,
                                                     const std::string& end) {
  const std::string first =
      begin.empty() ? "" : fmt::format("{{ name: begin, constant: [{}] }}, ", begin);
  const auto loaded = config::load_declaration_text(fmt::format(R"(
summary: escaped frames
addresses: {{ from: 1, to: 1 }}
escape: {0}
areas: [{{ name: word, items: 256 }}]
operations:
  - name: read
    read: word
    request: [{1}{{ is: first }}, {{ name: end, constant: [{2}] }}]
    answer: [{1}{{ is: first }}, {{ is: items }}, {{ is: checksum, kind: sum, of: first..items }},
             {{ name: end, constant: [{2}] }}]
)",
                                                                escape, first, end),
                                                    "test.yaml");
  if (!loaded) throw std::runtime_error(config::to_text(std::span(loaded.error())));
  return loaded->value;
}

// Constructed by the rules of each escape (core/protocol/declared/escape.hpp).
TEST(Explain, EscapedFieldsHaveTheirPlacesOnTheWire) {
  const auto read = [](const std::string& escape, const std::string& begin, const std::string& end,
                       const std::string& hex) {
    return explained(*escaped(escape, begin, end), hex);
  };
  EXPECT_EQ(read("dle", "0x10, 0x02", "0x10, 0x03", "10 02 10 10 12 10 10 32 10 03"),
            "response: read; begin 0+2=10 02; first 2+2=word:16; items 4+3=12 10; checksum 7+1=32; "
            "end 8+2=10 03");
  EXPECT_EQ(read("slip", "0xC0", "0xC0", "C0 DB DC DB DD 01 9C C0"),
            "response: read; begin 0+1=C0; first 1+2=word:192; items 3+3=DB 01; checksum 6+1=9C; "
            "end 7+1=C0");
  EXPECT_EQ(read("hdlc", "0x7E", "0x7E", "7E 7D 5E 01 02 81 7E"),
            "response: read; begin 0+1=7E; first 1+2=word:126; items 3+2=01 02; checksum 5+1=81; "
            "end 6+1=7E");
  // The code before a group belongs to the field behind it.
  EXPECT_EQ(read("cobs", "", "0x00", "02 05 01 02 05 00"),
            "response: read; first 0+2=word:5; items 2+2=00 00; checksum 4+1=05; end 5+1=00");
}

// Digits that are not a number are shown as on the wire, and marks as characters.
TEST(Explain, TextFramesAreShownAsText) {
  const std::string frame = "%01$RD0000E10062\r";
  EXPECT_EQ(
      explained(*declaration("panasonic-mewtocol"), to_hex(Bytes(frame.begin(), frame.end()))),
      "response: read data registers or 2 others; head 0+1=%; address 1+2=1; "
      "done 3+3=$RD; items "
      "6+8=0000 E100; checksum 14+2=62; end 16+1=0D");
}

TEST(Explain, AnInvalidEscapeIsAFault) {
  EXPECT_NE(explained(*escaped("slip", "0xC0", "0xC0"), "C0 05 DB 01 00 C0")
                .find("escape 2+1= !! no escape of a byte"),
            std::string::npos);
}

constexpr const char* kEnergy = "68 37 03 00 92 81 39 68 91 08 33 33 34 33 37 33 33 33 8C 16";

TEST(Explain, WakeUpBytesAreNotAFault) {
  const auto meter = declaration("dlt645-2007");
  EXPECT_EQ(explained(*meter, kEnergy),
            "response: read energy; begin 0+1=68; address 1+6=398192000337; again 7+1=68; command "
            "8+1=91; length 9+1=8; first 10+4=energy:10000; items 14+4=4; checksum 18+1=8C; end "
            "19+1=16");
  EXPECT_EQ(explained(*meter, std::string("FE FE FE ") + kEnergy).substr(0, 58),
            "response: read energy; lead 0+3=FE FE FE; begin 3+1=68; ad");
  const std::string request = "68 37 03 00 92 81 39 68 11 04 33 33 34 33 38 16";
  EXPECT_EQ(explained(*meter, "FE FE FE FE FE FE " + request).find("!!"), std::string::npos);
  EXPECT_EQ(explained(*meter, "FE " + request).substr(0, 84),
            "request: read energy; wake 0+1=FE !! should be FE FE FE FE; begin 1+1=68; address 2+");
  const auto modbus = declaration("modbus-rtu-declared");
  EXPECT_EQ(explained(*modbus, "00 01 03 00 00 00 02 C4 0B").substr(0, 63),
            "request: read holding registers; lead 0+1=00; address 1+1=1; co");
  // A byte that no driver and no wake-up sends.
  EXPECT_NE(explained(*modbus, "41 01 03 00 00 00 02 C4 0B").find("!!"), std::string::npos);
}

TEST(Explain, AResponseWithAWrongLengthIsAResponse) {
  const auto modbus = declaration("modbus-rtu-declared");
  const std::string whole = "01 03 04 00 01 00 02 2A 32";
  EXPECT_EQ(explained(*modbus, whole).find("!!"), std::string::npos);
  for (const char* length : {"00", "01", "02", "03", "05", "08", "55", "FF"}) {
    std::string broken = whole;
    broken.replace(6, 2, length);
    const std::string text = explained(*modbus, broken);
    EXPECT_EQ(text.substr(0, 32), "response: read holding registers") << broken << ' ' << text;
    EXPECT_NE(text.find("!! should be"), std::string::npos) << text;
  }
}

TEST(Explain, TheLengthOfACutFrameIsRight) {
  EXPECT_EQ(explained(*declaration("modbus-rtu-declared"), "01 03 04 00 01 00"),
            "response: read holding registers; address 0+1=1; command 1+1=03; length 2+1=4; items "
            "3+3= !! the frame ends before it is whole; checksum 6+0= !! the frame ends before it "
            "is whole");
}

TEST(Explain, BytesBehindTheFrameDoNotSpoilItsChecksum) {
  EXPECT_EQ(explained(*declaration("modbus-rtu-declared"), "01 03 04 00 01 00 02 2A 32 00"),
            "response: read holding registers; address 0+1=1; command 1+1=03; length 2+1=4; items "
            "3+4=00 01 00 02; checksum 7+2=2A 32; rest 9+1= !! bytes behind the end of the frame");
}

// These eight bytes are a request of coils, and a response with three bytes of them.
TEST(Explain, TheSenderDecidesBetweenEqualReadings) {
  const auto modbus = declaration("modbus-rtu-declared");
  const std::string both = "01 01 03 E8 00 08 BD BC";
  EXPECT_EQ(explained(*modbus, both).substr(0, 19), "request: read coils");
  EXPECT_EQ(explained(*modbus, both, Sender::kDevice).substr(0, 20), "response: read coils");
  EXPECT_EQ(explained(*modbus, both, Sender::kBridge).substr(0, 19), "request: read coils");
}

// The relays S, X, Y, T, M and C of Delta are read with one command.
TEST(Explain, AFrameOfSeveralOperationsIsCalledSo) {
  const auto delta = declaration("delta-dvp-rtu");
  EXPECT_EQ(explained(*delta, "05 01 01 00 50 B8").substr(0, 38),
            "response: read step relays or 5 others");
  EXPECT_EQ(explained(*delta, "05 01 08 1F 00 01 CF E8").substr(0, 30),
            "request: read relays; address ");
}

TEST(Explain, ItemsAndCountsOutsideTheAreaAreFaults) {
  const auto modbus = declaration("modbus-rtu-declared");
  EXPECT_NE(explained(*modbus, "01 03 00 00 00 00 45 CA", Sender::kBridge)
                .find("count 4+2=0 !! should be 1..125 items"),
            std::string::npos);
}

TEST(Explain, TheLastRequestOfASessionHasTheNameOfItsOperation) {
  program::LastRequest last("test", {escaped("slip", "0xC0", "0xC0")});
  const auto decoded = [&](const std::string& hex) {
    last.on_sent(*from_hex(hex), {});
    last.on_received();
    const auto request = last.take();
    return request ? request->text : "none";
  };
  EXPECT_EQ(decoded("C0 05 C0"), "read, first word:5");
  EXPECT_EQ(decoded("C0 DB DC C0"), "read, first word:192");
  EXPECT_EQ(decoded("C0 DB 05 C0"), "none") << "an invalid escape";
  EXPECT_EQ(decoded("05"), "none");
}

TEST(CheckedResponse, IsAResponseOrARefusalWithTheRightChecksum) {
  const auto modbus = declaration("modbus-rtu-declared");
  const auto begins = [&](const std::string& bytes) {
    return declared::begins_checked_response(*modbus, *from_hex(bytes));
  };
  EXPECT_TRUE(begins("01 03 02 12 34 B5 33"));
  EXPECT_TRUE(begins("01 03 02 12 34 B5 33 FF"));
  EXPECT_TRUE(begins("01 83 02 C0 F1")) << "a refusal";
  EXPECT_FALSE(begins("01 03 02 12 34 B5 00"));
  EXPECT_FALSE(begins("01 03 02 12 34 B5"));
  EXPECT_FALSE(begins(""));
}

}  // namespace
}  // namespace fieldcast::test
