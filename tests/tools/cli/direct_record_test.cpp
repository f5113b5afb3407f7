#include <filesystem>
#include <fstream>

#include "core/model/bus_spec.hpp"
#include "tests/tools/cli/direct_fixture.hpp"
#include "tools/cli/model/address_notation.hpp"
#include "tools/cli/scan/scan_plan.hpp"

namespace fieldcast::cli {
namespace {

// A device that responds with one record of values of several widths.
struct RecordTest : DirectTest {
  RecordTest() {
    std::filesystem::create_directory(folder);
    std::ofstream(file) << R"(
summary: a scale
addresses: { from: 1, to: 9 }
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    request:
      - { name: start, constant: "R" }
      - { is: address }
      - { is: checksum, kind: xor, of: start..address }
    answer: &state
      - { name: start, constant: "A" }
      - { is: address }
      - { name: weight, is: value, text: "+000.00" }
      - { name: label, is: value, text: 4 }
      - { name: tare, is: value, bytes: 2, signed: true }
      - { name: drift, is: value, text: "000" }
      - { is: checksum, kind: crc16-modbus, of: start..drift, bytes: 2 }
  - name: set
    write: state
    request:
      - { name: start, constant: "W" }
      - { is: address }
      - { name: tare, is: value, bytes: 2, signed: true }
      - { is: checksum, kind: xor, of: start..tare }
    answer: *state
)";
  }
  ~RecordTest() override { std::filesystem::remove_all(folder); }
  LineOptions line() const {
    LineOptions options = DirectTest::line();
    options.protocol = file;
    return options;
  }
  std::string type_of(const char* at) const {
    std::ostringstream err;
    const auto named = named_protocol(file, "read", err);
    EXPECT_TRUE(named) << err.str();
    const auto bus = bus_of(line(), *named);
    EXPECT_TRUE(bus) << bus.error();
    return type_at(at, {}, **make_protocol(bus->devices.front(), LineFormat{})).value_or("?");
  }

  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("fieldcast-record-" + std::to_string(::getpid()));
  const std::string file = folder / "scale.yaml";
};

TEST_F(RecordTest, AValueHasTheTypeOfItsField) {
  EXPECT_EQ(type_of("weight"), "float64");
  EXPECT_EQ(type_of("label"), "string(4)");
  EXPECT_EQ(type_of("tare"), "int16");
  EXPECT_EQ(type_of("tare.3"), "bool");
}

TEST_F(RecordTest, ATextNumberIsAsLongAsItsText) {
  EXPECT_EQ(type_of("drift"), "float64");
  const auto ended = read({.line = line(), .addresses = {"drift"}});
  EXPECT_EQ(ended.code, ExitCode::kFailed) << "the device does not respond: " << ended.err;
}

TEST_F(RecordTest, LongNumbersAndTextsAreAddresses) {
  const auto fault_of = [&](const std::string& protocol, const std::string& address) {
    LineOptions options = DirectTest::line();
    options.protocol = protocol;
    options.address = address;
    std::ostringstream err;
    const auto named = named_protocol(protocol, "read", err);
    if (!named) return err.str();
    const auto bus = bus_of(options, *named);
    return bus ? std::string() : bus.error();
  };
  EXPECT_EQ(fault_of("dlt645-2007", "112233445566"), "");
  EXPECT_EQ(fault_of("m-bus-secondary", "00001234"), "");
  EXPECT_EQ(fault_of("m-bus-secondary", "12345678"), "");
  const std::string named = (folder / "named.yaml").string();
  std::ofstream(named) << R"(
summary: a scale with a name
addresses: { text: 2 }
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    request: [{ is: address, text: 2 }, { name: ask, constant: "?" }]
    answer: [{ is: address, text: 2 }, { name: tell, constant: "=" },
             { name: weight, is: value, text: "000" }]
)";
  EXPECT_EQ(fault_of(named, "Q7"), "");
  EXPECT_THAT(fault_of(named, "Q77"), HasSubstr("address 'Q77' is outside"));
  EXPECT_THAT(fault_of("dlt645-2007", "1122334455667"), HasSubstr("address '1122334455667' is"));
  EXPECT_EQ(fault_of("dlt645-2007", "a1"), "--address 'a1' is no number 0 to 65535");
  EXPECT_EQ(fault_of("modbus-rtu", "65536"), "--address '65536' is no number 0 to 65535");
}

TEST_F(RecordTest, AValueHasNoNeighbours) {
  const auto ended = read({.line = line(), .addresses = {"weight"}, .count = 2});
  EXPECT_EQ(ended.code, ExitCode::kUsage);
  EXPECT_THAT(ended.err, HasSubstr("weight is one value; --count is for what has neighbours"));
  const auto more = poke({.line = line(), .assignments = {"tare=1,2"}});
  EXPECT_EQ(more.code, ExitCode::kRejected);
  EXPECT_THAT(more.err, HasSubstr("'tare' with 2 values reaches beyond the field"));
}

TEST_F(RecordTest, AScanReadsTheRecordWhole) {
  std::ostringstream err;
  const auto named = named_protocol(file, "scan", err);
  ASSERT_TRUE(named) << err.str();
  const auto protocol = scan_protocol(*named);
  const auto questions = questions_of(*named, *protocol);
  ASSERT_EQ(questions.size(), 1u);
  EXPECT_EQ(questions[0].at, "weight");
  EXPECT_EQ(questions[0].range.count, protocol->areas()[0].items);
  const auto lines = scan_lines(*named, {LineFormat{}}, {0, 9, 10});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].addresses, (std::vector<std::uint16_t>{9}));
}

TEST_F(RecordTest, AValueThatNoOperationWritesIsReadOnly) {
  const auto ended = poke({.line = line(), .assignments = {"weight=2.5"}});
  EXPECT_EQ(ended.code, ExitCode::kRejected);
  EXPECT_THAT(ended.err, HasSubstr("'weight' is read-only: the protocol has no operation that "
                                   "writes it alone"));
}

}  // namespace
}  // namespace fieldcast::cli
