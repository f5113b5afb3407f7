// What `fieldcast inspect --learn` finds in captures of the shipped declarations. The frames come
// from the simulated devices; the expected fields are those of the declarations.
#include "tests/tools/cli/learn_plant.hpp"

namespace fieldcast::learn {
namespace {

TEST(Learn, ModbusRtu) {
  Plant plant("modbus-rtu-declared");
  read_all(plant, {"1", "2", "17"}, {"holding", "input-register", "coil"},
           {0, 100, 300, 1000, 4000}, {1, 2, 10, 17});
  const Proposal proposal = plant.learned();
  const auto learned = declared_by(proposal);
  expect_same(*learned, plant.declaration(),
              {"read holding registers", "read input registers", "read coils"});
  EXPECT_EQ(proposal.operations[0].command, 3u);
  EXPECT_EQ(proposal.operations[2].command, 1u);
}

TEST(Learn, DeltaDvpRtu) {
  Plant plant("delta-dvp-rtu");
  read_all(plant, {"1", "5"}, {"D", "M"}, {0, 100, 300, 1000}, {1, 2, 9, 40});
  const auto learned = declared_by(plant);
  Declaration expected = plant.declaration();
  expect_same(*learned, expected, {"read registers", "read relays"});
}

TEST(Learn, Dlt645) {
  Plant plant("dlt645-2007");
  for (const char* address : {"398192000337", "652022122003", "100486215775"}) {
    plant.use(address);
    for (const std::uint32_t first : {0u, 1u, 2u, 3u, 0x100u, 0x200u, 0x010000u, 0x010300u})
      plant.read({"energy", first});
  }
  const auto learned = declared_by(plant);
  expect_same(*learned, plant.declaration(), {"read energy"});
}

TEST(Learn, FatekFacon) {
  Plant plant("fatek-facon");
  read_all(plant, {"1", "2", "26"}, {"R", "X", "D"}, {0, 15, 100, 1234}, {1, 2, 12, 40});
  const auto learned = declared_by(plant);
  expect_same(*learned, plant.declaration(),
              {"read registers R", "read inputs", "read registers D"});
}

TEST(Learn, PanasonicMewtocol) {
  Plant plant("panasonic-mewtocol");
  read_all(plant, {"1", "2", "18"}, {"DT", "LD"}, {0, 15, 100, 1234}, {1, 2, 12, 20});
  const auto learned = declared_by(plant);
  expect_same(*learned, plant.declaration(), {"read data registers", "read link registers"});
}

TEST(Learn, Adam4000) {
  Plant plant("adam-4000");
  plant.text_of = [&](const declared::Place&) {
    return fmt::format("{}{}.{:04}", plant.random() % 2 ? '+' : '-', plant.random() % 10,
                       plant.random() % 10000);
  };
  for (const char* address : {"1", "2", "33", "42"}) {
    plant.use(address);
    for (int i = 0; i < 6; ++i) plant.read({"analog"}), plant.read({"digital"});
  }
  const auto learned = declared_by(plant);
  const Declaration& shipped = plant.declaration();
  ASSERT_EQ(learned->operations.size(), 2u);
  for (const bool response : {false, true})
    EXPECT_EQ(lines_of(learned->operations[0], response),
              lines_of(operation(shipped, "read eight analog inputs"), response));
  EXPECT_EQ(lines_of(learned->operations[1], false),
            lines_of(operation(shipped, "read digital inputs and outputs"), false));
  // The capture does not show that the four digits are two values.
  EXPECT_EQ(lines_of(learned->operations[1], true),
            (Lines{"0 fixed 21", "1 value 4h", "5 fixed 30 30 0D"}));
}

TEST(Learn, MtSics) {
  Plant plant("mt-sics");
  plant.use("1");
  for (const double weight : {0.01, 100.0, -20.5, 123456.78, -123456.7, 12.34}) {
    plant.text_of = [&](const declared::Place& place) {
      if (place.name == "state") return std::string(weight < 0 ? "D" : "S");
      return place.name == "unit" ? weight > 50 ? "kg" : "g" : fmt::format("{:>10.2f}", weight);
    };
    plant.read({"weighing"});
  }
  const auto learned = declared_by(plant);
  expect_same(*learned, plant.declaration(), {"read the weight"});
}

TEST(Learn, Iec62056) {
  Plant plant("iec62056-21");
  plant.use("1");
  for (int i = 0; i < 8; ++i) {
    plant.text_of = [&](const declared::Place& place) {
      return place.characters > 12
                 ? "12345678"
                 : fmt::format("{}.{}", plant.random() % 1000000 >> plant.random() % 8,
                               plant.random() % 10);
    };
    plant.read({"readout"});
  }
  const auto learned = declared_by(plant);
  ASSERT_EQ(learned->operations.size(), 2u);  // the greeting is an operation of its own
  const auto& expected = operation(plant.declaration(), "read all values");
  EXPECT_EQ(lines_of(learned->operations[1], false), lines_of(expected, false));
  // The codes are constants here, and keys in the shipped declaration.
  const Lines found = lines_of(learned->operations[1], true), wanted = lines_of(expected, true);
  EXPECT_EQ(found.back(), wanted.back());
  EXPECT_THAT(found.back(), HasSubstr("checksum 1b of 1..-1 kind 2"));
}

// The simulated meter sends all values; these have some of them.
void add_shorter(Plant& plant) {
  for (std::uint8_t count = 1; count < 5; ++count) {
    Bytes request{0x10, 0x5B, count}, data{0x08, count, 0x72, 0x76,  0x00, count, 0x21, 0x18,
                                           0x4E, 0x31,  0x04, count, 0x00, 0x00,  0x00};
    for (std::uint8_t i = 0; i < count; ++i)
      append(data, Bytes{0x0C, 0x13, static_cast<std::uint8_t>(0x10 + i), 0x98, 0x79, count});
    const auto length = static_cast<std::uint8_t>(data.size());
    Bytes response{0x68, length, length, 0x68};
    append(response, data);
    const auto end = [](Bytes& frame, std::size_t from) {
      std::uint8_t sum = 0;
      for (std::size_t i = from; i < frame.size(); ++i)
        sum = static_cast<std::uint8_t>(sum + frame[i]);
      append(frame, Bytes{sum, 0x16});
    };
    end(request, 1);
    end(response, 4);
    plant.take(request, response);
  }
}

TEST(Learn, MBus) {
  Plant plant("m-bus");
  for (const char* address : {"1", "2", "33"}) {
    plant.use(address);
    for (int i = 0; i < 6; ++i) plant.read({"meter"});
  }
  add_shorter(plant);
  const auto learned = declared_by(plant);
  const Declaration& shipped = plant.declaration();
  ASSERT_EQ(learned->operations.size(), 2u);
  EXPECT_EQ(lines_of(learned->operations[0], false), lines_of(shipped.login[0], false));
  EXPECT_EQ(lines_of(learned->operations[0], true), lines_of(shipped.login[0], true));
  const auto& expected = operation(shipped, "read the data");
  EXPECT_EQ(lines_of(learned->operations[1], false), lines_of(expected, false));
  // The control field is constant in the capture, and the data are one text.
  const Lines found = lines_of(learned->operations[1], true), wanted = lines_of(expected, true);
  ASSERT_EQ(found.size(), 9u);
  EXPECT_EQ(Lines(found.begin(), found.begin() + 3), Lines(wanted.begin(), wanted.begin() + 3));
  EXPECT_EQ(found[3], "3 fixed 68 08");
  EXPECT_EQ(found[4], "5 address 1b");
  EXPECT_THAT(found[5], HasSubstr("6 fixed 72"));
  EXPECT_EQ(Lines(found.end() - 2, found.end()), Lines(wanted.end() - 2, wanted.end()));
}

// Three registers of a PLC that sends numbers without leading zeros.
TEST(Learn, TextsOfVariableWidth) {
  constexpr std::string_view kText = R"(
summary: registers
addresses: { from: 1, to: 1 }
areas: [{ name: registers, record: true }]
operations:
  - name: read registers
    read: registers
    request: [{ name: ask, constant: "RDS DM0.U 3\r" }]
    answer:
      - { name: DM0, is: value, text: decimal(6), variable: true }
      - { name: gap-0, constant: " " }
      - { name: DM1, is: value, text: decimal(6), variable: true }
      - { name: gap-1, constant: " " }
      - { name: DM2, is: value, text: decimal(6), variable: true }
      - { name: end, constant: "\r\n" }
)";
  const auto loaded = config::load_declaration_text(kText, "registers.yaml");
  ASSERT_TRUE(loaded) << config::to_text(std::span(loaded.error()));
  Plant plant(loaded->value);
  plant.use("1");
  for (int i = 0; i < 24; ++i) {
    plant.text_of = [&](const declared::Place&) {
      return fmt::format("{}", (plant.random() & 0xFFFF) >> plant.random() % 12);
    };
    plant.read({"registers"});
  }
  const auto learned = declared_by(plant);
  expect_same(*learned, plant.declaration(), {"read registers"});
}

TEST(Learn, DeltaDvpAscii) {
  Plant plant("delta-dvp-ascii");
  read_all(plant, {"1", "5", "26"}, {"D", "M"}, {0, 100, 300, 1000}, {1, 2, 9, 40});
  const auto learned = declared_by(plant);
  expect_same(*learned, plant.declaration(), {"read registers", "read relays"});
}

// Only the first digit of 01 and 11 differs; the checksum is over bytes.
TEST(Learn, DigitsOfAByteStayTogether) {
  Plant plant("delta-dvp-ascii");
  read_all(plant, {"1", "17"}, {"D"}, {0, 100, 300, 1000}, {1, 2, 9, 40});
  const auto learned = declared_by(plant);
  expect_same(*learned, plant.declaration(), {"read registers"});
  EXPECT_EQ(learned->highest_address, 255u);
}

// By the programming port of Mitsubishi FX: the sum is over ETX and what precedes it.
TEST(Learn, AMarkBeforeTheChecksumIsNotAnItem) {
  Plant plant("modbus-rtu-declared");
  const auto framed = [](std::string text) {
    unsigned sum = 0;
    for (const char c : text += '\x03') sum += static_cast<unsigned char>(c);
    text = '\x02' + text + fmt::format("{:02X}", sum & 0xFF);
    return Bytes(text.begin(), text.end());
  };
  for (unsigned i = 0; i < 40; ++i) {
    const unsigned count = 1 + i % 3;
    std::string items;
    for (unsigned k = 0; k < count; ++k) items += fmt::format("{:02X}", plant.random() & 0xFF);
    plant.take(framed(fmt::format("0{:04X}{:02}", 0x1000 + 37 * i, count)), framed(items));
  }
  const auto learned = declared_by(plant);
  ASSERT_EQ(learned->operations.size(), 1u);
  EXPECT_EQ(lines_of(learned->operations[0], true),
            (Lines{"0 fixed 02", "1 items 2h", "-3 fixed 03",
                   "-2 checksum 2h of 1..-2 kind 0 complement 0 crc 16/8005/FFFF/0/truetrue"}));
}

// The fields of few exchanges have the evidence of these alone.
TEST(Learn, EvidenceIsThatOfTheOperation) {
  Plant plant("modbus-rtu-declared");
  read_all(plant, {"1", "2"}, {"holding"}, {0, 100, 300, 1000}, {1, 2, 10});
  read_all(plant, {"1", "2"}, {"coil"}, {7}, {9});
  const Proposal proposal = plant.learned();
  ASSERT_EQ(proposal.operations.size(), 2u);
  for (const auto* fields : {&proposal.operations[1].request, &proposal.operations[1].response}) {
    for (const LearnedField& field : *fields) EXPECT_EQ(field.evidence.of, 2u) << field.name;
  }
}

// One exchange of Modbus TCP: 16 bits of transaction, protocol 0, length, unit, PDU.
void take_tcp(Plant& plant, std::uint16_t transaction, std::uint8_t unit, std::uint16_t first,
              std::uint8_t count) {
  Bytes request, response;
  append_u16(request, transaction);
  append(request, Bytes{0, 0, 0, 6, unit, 3});
  append_u16(request, first);
  append(request, Bytes{0, count});
  append_u16(response, transaction);
  append(response, Bytes{0, 0, 0, static_cast<std::uint8_t>(3 + 2 * count), unit, 3,
                         static_cast<std::uint8_t>(2 * count)});
  for (int i = 0; i < 2 * count; ++i) response.push_back(static_cast<std::uint8_t>(plant.random()));
  plant.take(request, response);
}

TEST(Learn, SequenceNumber) {
  Plant plant("modbus-rtu-declared");
  for (std::uint16_t i = 0; i < 300; ++i)
    take_tcp(plant, static_cast<std::uint16_t>(0x1FE0 + i), static_cast<std::uint8_t>(1 + i % 3),
             static_cast<std::uint16_t>(plant.random() % 5000),
             static_cast<std::uint8_t>(1 + plant.random() % 20));
  const auto learned = declared_by(plant);
  ASSERT_EQ(learned->operations.size(), 1u);
  EXPECT_EQ(lines_of(learned->operations[0], false),
            (Lines{"0 sequence 2b", "2 fixed 00 00", "4 length 2b of 6..-0 plus 0 counts 0",
                   "6 address 1b", "7 fixed 03", "8 first 2b", "10 count 2b"}));
  EXPECT_EQ(
      lines_of(learned->operations[0], true),
      (Lines{"0 sequence 2b", "2 fixed 00 00", "4 length 2b of 6..-0 plus 0 counts 0",
             "6 address 1b", "7 fixed 03", "8 length 1b of 9..-0 plus 0 counts 0", "9 items 2b"}));
}

// A bridge that polls its channels asks for few different items: the count of the coils is found by
// that of the registers, and constant digits belong to the number of the item.
TEST(Learn, FewDifferentRequests) {
  for (const std::string protocol : {"modbus-rtu-declared", "fatek-facon"}) {
    Plant plant(protocol);
    const bool modbus = protocol == "modbus-rtu-declared";
    const std::string words = modbus ? "holding" : "R", bits = modbus ? "coil" : "X";
    for (int i = 0; i < 8; ++i) {
      plant.use("1");
      plant.read({words, 0, 2}), plant.read({words, 300, 1}), plant.read({bits, 7, 1});
      plant.use("26");
      plant.read({words, 5, 2}), plant.read({words, 1200, 17}), plant.read({bits, 17, 24});
    }
    const auto learned = declared_by(plant);
    expect_same(*learned, plant.declaration(),
                modbus ? Lines{"read holding registers", "read coils"}
                       : Lines{"read registers R", "read inputs"});
  }
}

}  // namespace
}  // namespace fieldcast::learn
