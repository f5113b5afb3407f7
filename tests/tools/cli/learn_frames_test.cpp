// What `fieldcast inspect --learn` finds in captures with refusals, writes, escapes, echoes, and
// frames without a request.
#include "tests/tools/cli/learn_plant.hpp"

namespace fieldcast::learn {
namespace {

// Modbus RTU by hand; one in twelve requests is refused.
void take_rtu(Plant& plant, int i, std::uint8_t unit) {
  const auto count = static_cast<std::uint8_t>(1 + plant.random() % 6);
  const auto low = static_cast<std::uint8_t>(plant.random()),
             high = static_cast<std::uint8_t>(plant.random() % 16);
  Bytes request{unit, 3, high, low, 0, count}, response{unit, 0x83, 2};
  if (i % 12 != 5) {
    response = {unit, 3, static_cast<std::uint8_t>(2 * count)};
    for (int k = 0; k < 2 * count; ++k)
      response.push_back(static_cast<std::uint8_t>(plant.random()));
  }
  append_crc16(request);
  append_crc16(response);
  plant.take(request, response);
}

TEST(Learn, RefusalsAreLeftOut) {
  Plant plant("modbus-rtu-declared");
  for (int i = 0; i < 96; ++i) take_rtu(plant, i, static_cast<std::uint8_t>(1 + i % 3));
  const Proposal proposal = plant.learned();
  expect_same(*declared_by(proposal), plant.declaration(), {"read holding registers"});
  EXPECT_THAT(proposal.notes, testing::Contains(HasSubstr("8 exchanges have another length")));
}

TEST(Learn, OneDeviceIsReported) {
  Plant plant("modbus-rtu-declared");
  for (int i = 0; i < 40; ++i) take_rtu(plant, 0, 17);
  const Proposal proposal = plant.learned();
  expect_same(*declared_by(proposal), plant.declaration(), {"read holding registers"});
  EXPECT_THAT(proposal.notes, testing::Contains(HasSubstr("only one device in the capture")));
}

// A response without a value is a command. A write that carries a value is not declared.
TEST(Learn, WritesAreComments) {
  Plant plant("modbus-rtu-declared");
  read_all(plant, {"1", "2"}, {"holding"}, {0, 100, 300, 1000}, {1, 2, 10});
  for (std::uint32_t i = 0; i < 12; ++i)
    plant.write("holding", 40 * i,
                {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(7 * i)});
  const Proposal proposal = plant.learned();
  ASSERT_EQ(proposal.operations.size(), 2u);
  EXPECT_EQ(proposal.operations[0].refusal, "");
  EXPECT_NE(proposal.operations[1].refusal, "");
  EXPECT_THAT(declaration_text(proposal), HasSubstr("  # operation 2, 12 exchanges: "));
}

// Modbus RTU in other frames.
class OtherFrames : public testing::Test {
 protected:
  using Change = std::function<Bytes(const Bytes&)>;
  std::shared_ptr<const Declaration> learned(const Change& request, const Change& response) {
    Plant rtu("modbus-rtu-declared"), plant("modbus-rtu-declared");
    read_all(rtu, {"1", "2", "17"}, {"holding"}, {0, 100, 0xC0, 0xDB7D, 0x1010}, {1, 2, 10, 16});
    (void)rtu.learned();
    for (const Exchange& each : rtu.exchanges)
      plant.take(request(each.request), response(each.response));
    proposal_ = plant.learned();
    const auto made = declared_by(proposal_);
    EXPECT_EQ(explained_by(*made, plant.exchanges).holds, 2 * plant.exchanges.size());
    EXPECT_EQ(made->operations.size(), 1u);
    return made;
  }
  Proposal proposal_;
};

const Lines kRtuRequest{"0 address 1b", "1 fixed 03", "2 first 2b", "4 count 2b",
                        "6 checksum 2b< of 0..6 kind 3 complement 0 crc 16/8005/FFFF/0/truetrue"};

TEST_F(OtherFrames, EscapedFrames) {
  struct Form {
    declared::Escape escape;
    Bytes begin, end;
  };
  const Form kForms[] = {{declared::Escape::kDle, {0x10, 0x02}, {0x10, 0x03}},
                         {declared::Escape::kSlip, {0xC0}, {0xC0}},
                         {declared::Escape::kCobs, {}, {0x00}},
                         {declared::Escape::kHdlc, {0x7E}, {0x7E}}};
  for (const Form& form : kForms) {
    const auto framed = [&](const Bytes& plain) {
      Bytes frame = form.begin;
      append(frame, declared::escaped(form.escape, plain));
      append(frame, form.end);
      return frame;
    };
    const auto made = learned(framed, framed);
    EXPECT_EQ(made->operations.at(0).request.escape, form.escape) << proposal_.escape;
    const Lines lines = lines_of(made->operations[0], false);
    ASSERT_EQ(lines.size(), kRtuRequest.size() + 1 + (form.begin.empty() ? 0 : 1))
        << proposal_.escape;
    EXPECT_EQ(lines.back(), fmt::format("{} fixed {}", form.begin.size() + 8, to_hex(form.end)));
    EXPECT_THAT(lines[lines.size() - 2], HasSubstr("checksum 2b<"));
  }
}

TEST_F(OtherFrames, WakeUpBytesAreNotFields) {
  std::size_t count = 0;
  const auto awake = [&](const Bytes& plain) {
    Bytes frame(++count % 3, 0xFF);
    append(frame, plain);
    return frame;
  };
  const auto made = learned([](const Bytes& plain) { return plain; }, awake);
  EXPECT_EQ(lines_of(made->operations.at(0), false), kRtuRequest);
  EXPECT_THAT(proposal_.notes, testing::Contains(HasSubstr("which the bridge skips")));
}

// An RS-485 adapter that receives what it sends.
TEST(Learn, EchoesAreNotFields) {
  Plant rtu("modbus-rtu-declared"), plant("modbus-rtu-declared");
  read_all(rtu, {"1", "2", "17"}, {"holding"}, {0, 100, 300, 4000}, {1, 2, 10});
  (void)rtu.learned();
  for (const Exchange& each : rtu.exchanges) {
    Bytes echoed = each.request;
    append(echoed, each.response);
    plant.take(each.request, echoed);
  }
  expect_same(*declared_by(plant), plant.declaration(), {"read holding registers"});
}

// Five items in turn are not a sequence number.
TEST(Learn, ItemsInTurnAreNotASequence) {
  Plant plant("dlt645-2007");
  for (int i = 0; i < 8; ++i) {
    plant.use("398192000337");
    for (const std::uint32_t first : {0u, 1u, 2u, 3u, 4u}) plant.read({"energy", first});
  }
  const auto learned = declared_by(plant);
  ASSERT_FALSE(learned->operations.empty());
  for (const auto& field : learned->operations[0].request.fields)
    EXPECT_NE(field.kind, FieldKind::kSequence);
}

// Scales that send by themselves.
TEST(Learn, FramesWithoutARequest) {
  ExchangePairing pairing;
  std::mt19937 random(3);
  for (int i = 0; i < 40; ++i) {
    const std::string text = fmt::format("{},GS,{:+09.1f}kg\r\n", i % 3 == 0 ? "ST" : "US",
                                         static_cast<double>(random() % 100000) / 10 - 2000);
    pairing.take(Direction::kReceived, Bytes(text.begin(), text.end()));
  }
  const auto learned = declared_by(learn(pairing.finish()));
  ASSERT_EQ(learned->operations.size(), 1u);
  EXPECT_GT(learned->operations[0].unsolicited, Duration::zero());
  EXPECT_EQ(lines_of(learned->operations[0], true),
            (Lines{"0 value text 2 number 0", "2 fixed 2C 47 53 2C", "6 value text 9 number 1",
                   "15 fixed 6B 67 0D 0A"}));
}

}  // namespace
}  // namespace fieldcast::learn
