// What `fieldcast inspect --learn` finds in captures of the shipped declarations. The frames come
// from the simulated devices, in virtual time; the expected fields are those of the declarations.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <random>

#include "config/loader/loader.hpp"
#include "core/codec/checksum.hpp"
#include "tools/cli/inspect/learn/proposal.hpp"
#include "tools/sim/check/requests.hpp"

namespace fieldcast::learn {
namespace {

using declared::Declaration;
using declared::Field;
using declared::FieldKind;
using testing::HasSubstr;

std::shared_ptr<const Declaration> shipped(const std::string& name) {
  const auto loaded = config::load_declaration(name);
  if (!loaded) throw std::runtime_error(config::to_text(std::span(loaded.error())));
  return loaded->value;
}

struct Read {
  std::string area;
  std::uint32_t first = 0, count = 1;
};

// A line with devices of a declared protocol; random contents.
class Plant {
 public:
  explicit Plant(const std::string& protocol) : declaration_(shipped(protocol)) {}

  void use(const std::string& address) {
    auto subject = sim::subjects_of(declared::SharedDeclaration{declaration_}).front();
    subject.device.link.long_address = address;
    protocol_ = subject.protocol();
    device_ = std::make_unique<sim::LiveDevice>(subject);
  }

  void read(const Read& read) {
    const auto& areas = declaration_->areas;
    const auto area = std::ranges::find(areas, read.area, &declared::DeclaredArea::name);
    ASSERT_NE(area, areas.end()) << read.area;
    const auto index = static_cast<AreaIndex>(area - areas.begin());
    for (std::uint32_t i = 0; i < read.count && area->places.empty(); ++i)
      EXPECT_TRUE(device_->device().poke(read.area, read.first + i, contents(*area)));
    for (const declared::Place& place : area->places) set_place(read.area, place);
    const bool whole = !area->places.empty();
    const Range range{index, read.first, whole ? area->items : read.count};
    run(ReadRequest{{range}});
  }
  void write(const std::string& area, std::uint32_t first, Bytes items) {
    const auto& areas = declaration_->areas;
    const auto index = static_cast<AreaIndex>(
        std::ranges::find(areas, area, &declared::DeclaredArea::name) - areas.begin());
    run(WriteRequest{.range = {index, first, 1}, .items = std::move(items)});
  }

  void take(ByteView request, ByteView response) {
    pairing_.take(Direction::kSent, request);
    pairing_.take(Direction::kReceived, response);
  }
  // A text of a place.
  std::function<std::string(const declared::Place&)> text_of;

  Proposal learned() { return learn(exchanges = pairing_.finish()); }
  std::vector<Exchange> exchanges;
  const Declaration& declaration() const { return *declaration_; }
  std::mt19937 random{7};

 private:
  void run(const Request& request) {
    Bytes out;
    auto exchange = protocol_->begin(request, device_->context(0));
    const auto outcome = device_->run(std::move(exchange));
    ASSERT_TRUE(outcome.done) << outcome.text() << ' ' << sim::frames(outcome.sent);
    for (std::size_t i = 0; i < outcome.sent.size(); ++i)
      take(outcome.sent[i], outcome.responses[i]);
  }
  std::uint64_t contents(const declared::DeclaredArea& area) {
    if (declaration_->name == "dlt645-2007") return random() % 100000000;
    return random() & (UINT64_MAX >> (64 - area.item_bits));
  }
  void set_place(const std::string& area, const declared::Place& place) {
    std::string text = text_of ? text_of(place) : "";
    for (std::uint32_t i = 0; i < place.items; ++i) {
      std::uint64_t item = random() & 0xFFFF;
      if (place.characters != 0) {
        const auto at = [&](std::size_t n) {
          return static_cast<std::uint8_t>(n < text.size() ? text[n] : 0);
        };
        item = static_cast<std::uint64_t>(at(2 * i) << 8 | at(2 * i + 1));
      } else if (place.name == "state" && !text.empty()) {
        item = static_cast<std::uint8_t>(text.front());
      } else if (place.bits < 16) {
        item &= (1u << place.bits) - 1u;
      }
      (void)device_->device().poke(area, place.first + i, item);
    }
  }

  std::shared_ptr<const Declaration> declaration_;
  std::unique_ptr<Protocol> protocol_;
  std::unique_ptr<sim::LiveDevice> device_;
  ExchangePairing pairing_;
};

// A frame as one line for each field: position, kind and notation. Fixed characters are one line,
// as a capture shows no difference between a constant, a command and the code of no error.
class FrameLines {
 public:
  FrameLines(const declared::Frame& frame, const declared::Operation& operation)
      : frame_(frame), command_(operation.command) {}

  std::vector<std::string> run() {
    for (std::size_t i = 0; i < frame_.fields.size(); ++i) add(i);
    flush();
    return std::move(lines_);
  }

 private:
  static bool is_open(const Field& field) {
    return field.kind == FieldKind::kItems || field.variable || !field.key.empty();
  }
  static std::size_t size_of(const Field& field) {
    if (field.text_size != 0) return field.text_size;
    return field.text.empty() ? field.word.characters : field.text.size();
  }
  // From the start of the frame, or from its end behind a field of open length, or the field.
  std::string edge(std::size_t at) const {
    std::size_t size = 0;
    for (std::size_t i = 0; i < frame_.fields.size(); ++i) {
      if (i == at) return fmt::format("{}", size);
      if (is_open(frame_.fields[i])) break;
      size += size_of(frame_.fields[i]);
    }
    size = 0;
    for (std::size_t i = at; i < frame_.fields.size(); ++i) {
      if (is_open(frame_.fields[i])) return fmt::format("#{}", lines_.size());
      size += size_of(frame_.fields[i]);
    }
    return fmt::format("-{}", size);
  }
  std::string span(const Field& field) const {
    return fmt::format("{}..{}", edge(field.of.from), edge(field.of.to + 1u));
  }
  static std::string word(const Field& field) {
    // No capture shows the byte order of values, and of numbers of devices.
    const bool shown = field.kind != FieldKind::kItems && field.kind != FieldKind::kAddress;
    return fmt::format(
        "{}{}{}{}", field.word.characters,
        std::vector{"b", "h", "d", "c"}[static_cast<std::size_t>(field.word.notation)],
        shown && field.word.little_endian && field.word.characters > 1 ? "<" : "",
        field.transform.add != 0 ? fmt::format(" add {:02X}", field.transform.add) : "");
  }

  void add(std::size_t i) {
    const Field& field = frame_.fields[i];
    const bool command = field.kind == FieldKind::kCommand;
    if (field.kind == FieldKind::kConstant || command || field.kind == FieldKind::kError) {
      if (fixed_.empty()) fixed_at_ = edge(i);
      if (!field.text.empty())
        append(fixed_, ByteView(reinterpret_cast<const std::uint8_t*>(field.text.data()),
                                field.text.size()));
      else
        declared::append_word(
            fixed_, field.word,
            command ? command_ + static_cast<std::uint64_t>(field.plus) : field.number);
      return;
    }
    flush();
    std::string text;
    switch (field.kind) {
      case FieldKind::kAddress: text = "address " + word(field); break;
      case FieldKind::kFirst: text = "first " + word(field); break;
      case FieldKind::kCount: text = "count " + word(field); break;
      case FieldKind::kLast: text = "last " + word(field); break;
      case FieldKind::kLength:
        text = fmt::format("length {} of {} plus {} counts {}", word(field), span(field),
                           field.plus, static_cast<int>(field.counts));
        break;
      case FieldKind::kItems: text = field.packed ? "items of bits" : "items " + word(field); break;
      case FieldKind::kValue:
        text = field.text_size == 0
                   ? "value " + word(field)
                   : fmt::format("value text {} number {}", field.variable ? 0 : field.text_size,
                                 static_cast<int>(field.text_number.kind));
        break;
      case FieldKind::kChecksum:
        text = fmt::format("checksum {} of {} kind {} complement {} crc {}/{:X}/{:X}/{:X}/{}{}{}",
                           word(field), span(field), static_cast<int>(field.check.kind),
                           static_cast<int>(field.check.complement), field.check.crc.width,
                           field.check.crc.polynomial, field.check.crc.start,
                           field.check.crc.final_xor, field.check.crc.reflect_in,
                           field.check.crc.reflect_out, field.check.over_bytes ? " bytes" : "");
        break;
      case FieldKind::kSequence: text = "sequence " + word(field); break;
      default: text = "unused " + word(field); break;
    }
    lines_.push_back(edge(i) + ' ' + text);
  }

  void flush() {
    if (!fixed_.empty()) lines_.push_back(fixed_at_ + " fixed " + to_hex(fixed_));
    fixed_.clear();
  }

  const declared::Frame& frame_;
  const std::uint64_t command_;
  std::vector<std::string> lines_;
  Bytes fixed_;
  std::string fixed_at_;
};

using Lines = std::vector<std::string>;
Lines lines_of(const declared::Operation& operation, bool response) {
  return FrameLines(response ? operation.response : operation.request, operation).run();
}

// The declaration as the loader reads it; it must accept every proposal.
std::shared_ptr<const Declaration> declared_by(const Proposal& proposal) {
  const std::string text = declaration_text(proposal);
  const auto loaded = config::load_declaration_text(text, "learned.yaml");
  if (!loaded) {
    ADD_FAILURE() << config::to_text(std::span(loaded.error())) << text;
    return std::make_shared<Declaration>();
  }
  if (std::getenv("FIELDCAST_SHOW") != nullptr) std::puts(text.c_str());
  return loaded->value;
}

// The declaration finds no fault in any frame of the capture.
std::shared_ptr<const Declaration> declared_by(Plant& plant) {
  const auto learned = declared_by(plant.learned());
  const Evidence explained = explained_by(*learned, plant.exchanges);
  EXPECT_EQ(explained.holds, explained.of);
  EXPECT_EQ(explained.of, 2 * plant.exchanges.size());
  return learned;
}

const declared::Operation& operation(const Declaration& declaration, std::string_view name) {
  const auto found = std::ranges::find(declaration.operations, name, &declared::Operation::name);
  if (found == declaration.operations.end()) throw std::runtime_error(std::string(name));
  return *found;
}

// The learned operations, in their order, are these of the shipped declaration.
void expect_same(const Declaration& learned, const Declaration& shipped,
                 const std::vector<std::string>& names) {
  ASSERT_EQ(learned.operations.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto& expected = operation(shipped, names[i]);
    EXPECT_EQ(lines_of(learned.operations[i], false), lines_of(expected, false)) << names[i];
    EXPECT_EQ(lines_of(learned.operations[i], true), lines_of(expected, true)) << names[i];
  }
}

// Reads of different items and lengths, from each device.
void read_all(Plant& plant, std::initializer_list<const char*> addresses,
              const std::vector<std::string>& areas, std::initializer_list<std::uint32_t> firsts,
              std::initializer_list<std::uint32_t> counts) {
  for (const char* address : addresses) {
    plant.use(address);
    for (const std::uint32_t first : firsts) {
      for (const std::uint32_t count : counts) {
        for (const std::string& area : areas) plant.read({area, first, count});
      }
    }
  }
}

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
    for (const std::uint32_t first : {0u, 1u, 2u, 3u, 0x100u, 0x200u, 0x010000u, 0x020100u})
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

TEST(Learn, KeyenceKv) {
  Plant plant("keyence-kv");
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
