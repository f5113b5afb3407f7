#include "core/model/bus_spec.hpp"
#include "tests/support/text_cases.hpp"
#include "tests/tools/cli/direct_fixture.hpp"
#include "tools/cli/direct/meanings.hpp"
#include "tools/cli/model/address_notation.hpp"

namespace fieldcast::cli {
namespace {

std::unique_ptr<Protocol> protocol(const char* name) {
  return find_protocol(name)->make(DeviceLink{}).value();
}

TEST(AddressSteps, CountInTheNotationOfTheFamily) {
  const auto modbus = protocol("modbus-rtu");
  EXPECT_EQ(address_behind(*modbus, "holding:100", 2), "holding:102");
  EXPECT_EQ(address_behind(*modbus, "40009", 2), "40011");
  EXPECT_EQ(address_behind(*modbus, "holding:65535", 1), std::nullopt);
  EXPECT_EQ(address_behind(*modbus, "nonsense", 1), std::nullopt);
  EXPECT_EQ(address_behind(*protocol("s7-ppi"), "VW100", 2), "VW102");
  EXPECT_EQ(address_behind(*protocol("omron-hostlink"), "DM0009", 1), "DM0010");
}

TEST(Meanings, OfARegisterPairInEveryOrder) {
  const auto meanings = meanings_of("float32,int16");
  ASSERT_TRUE(meanings);
  EXPECT_EQ(meanings->size(), 6u);
  // 1.5 as an IEEE 754 single is 3FC00000.
  const Bytes image{0x3F, 0xC0, 0x00, 0x00};
  const std::vector<std::string> addresses{"holding:0", "holding:1"};
  const auto lines = meaning_lines(addresses, 16, image, *meanings, {});
  std::string text;
  for (const auto& line : lines) text += line + '\n';
  EXPECT_THAT(text, HasSubstr("holding:0  3F C0\n"));
  EXPECT_THAT(text, HasSubstr("  float32                  1.5\n"));
  EXPECT_THAT(text, HasSubstr("  int16                    16320\n"));
  EXPECT_THAT(text, HasSubstr("  int16 bytes swapped      -16321\n"));
}

TEST(Meanings, AllTypesAndWhatIsNone) {
  const auto all = meanings_of("all");
  ASSERT_TRUE(all);
  EXPECT_GT(all->size(), 20u);
  EXPECT_FALSE(meanings_of("flaot32"));
  EXPECT_FALSE(meanings_of(""));
  EXPECT_FALSE(meanings_of("int16,"));
}

TEST_F(DirectTest, ReadsValuesOneBehindTheOther) {
  const auto ended = read({.line = line(), .addresses = {"holding:100"}, .count = 3});
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  EXPECT_EQ(ended.out, "holding:100 = 100\nholding:101 = 101\nholding:102 = 102\n");
}

TEST_F(DirectTest, ReadsMoreThanOneRequestHolds) {
  const auto ended = read({.line = line(), .addresses = {"holding:0"}, .count = 300, .json = true});
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr(",298,299]"));
  EXPECT_EQ(device.reads(), 3u);
}

TEST_F(DirectTest, ShowsWhatRegistersMean) {
  const auto ended = read({.line = line(), .addresses = {"holding:7"}, .count = 2, .as = "uint32"});
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("uint32                   458760"));  // 7 << 16 | 8
  EXPECT_THAT(ended.out, HasSubstr("uint32 words swapped     524295"));
}

TEST_F(DirectTest, SaysWhatADeviceRefuses) {
  const auto ended = read({.line = line(), .addresses = {"coil:1", "holding:5"}});
  EXPECT_EQ(ended.code, ExitCode::kFailed);
  EXPECT_THAT(ended.err, HasSubstr("illegal function"));
  EXPECT_THAT(ended.out, HasSubstr("holding:5 = 5"));
}

TEST_F(DirectTest, SaysWhatIsNotAnAddress) {
  const auto ended = read({.line = line(), .addresses = {"holdin:1"}});
  EXPECT_EQ(ended.code, ExitCode::kUsage);
  EXPECT_THAT(ended.err, HasSubstr("did you mean holding:1?"));
  EXPECT_EQ(device.reads(), 0u);
}

TEST_F(DirectTest, WritesAndReadsBack) {
  const auto ended = poke({.line = line(), .assignments = {"holding:40=1234"}, .verify = true});
  EXPECT_EQ(ended.code, ExitCode::kOk) << ended.err;
  EXPECT_EQ(ended.out, "holding:40 = 1234: verified (read back 1234)\n");
  EXPECT_EQ(device.held(40), 1234);
}

TEST_F(DirectTest, AWrongValueIsFoundBeforeAnythingIsWritten) {
  const auto ended = poke({.line = line(), .assignments = {"holding:40=1", "holding:41=x"}});
  EXPECT_EQ(ended.code, ExitCode::kUsage);
  EXPECT_THAT(ended.err, HasSubstr("'x' is no number"));
  EXPECT_EQ(device.writes(), 0u);
}

TEST_F(DirectTest, AValueThatDoesNotFitIsFoundBeforeAnythingIsWritten) {
  const auto ended = poke({.line = line(), .assignments = {"holding:40=1", "holding:41=99999"}});
  EXPECT_EQ(ended.code, ExitCode::kRejected);
  EXPECT_EQ(ended.err,
            "holding:41 = 99999: rejected: 99999 does not fit uint16; nothing is written\n");
  EXPECT_EQ(device.writes(), 0u);
}

TEST_F(DirectTest, TheEndOfTheAddressesIsSaid) {
  const auto ended = read({.line = line(), .addresses = {"holding:65535"}, .count = 2});
  EXPECT_EQ(ended.code, ExitCode::kUsage);
  EXPECT_THAT(ended.err, HasSubstr("holding:65535: with 2 values it reaches beyond the end of "
                                   "holding; there is room for 1"));
}

TEST_F(DirectTest, AnAddressThatNoDeviceHasIsSaidByItsOption) {
  LineOptions options = line();
  options.address = "248";
  const auto ended = read({.line = options, .addresses = {"holding:1"}});
  EXPECT_EQ(ended.code, ExitCode::kUsage);
  EXPECT_THAT(ended.err, HasSubstr("--address: address 248 is outside"));
}

TEST(LineOptions, SetTakesOneWordEach) {
  LineOptions options;
  std::vector<std::string> addresses;
  CommandLine line("test", "");
  add_line_options(line, options);
  line.texts("ADDRESS", addresses, "").required();
  const std::vector<const char*> words{"test",       "/dev/ttyS0", "--set",  "mode=fins",
                                       "DM110=1e10", "--set",      "node=3", "DM111=1"};
  const auto ended = line.parse(static_cast<int>(words.size()), words.data());
  EXPECT_FALSE(ended) << ended->text;
  EXPECT_EQ(options.settings, (std::vector<std::string>{"mode=fins", "node=3"}));
  EXPECT_EQ(addresses, (std::vector<std::string>{"DM110=1e10", "DM111=1"}));
}

TEST_F(DirectTest, ASilentDeviceIsSaidToBeSilent) {
  device.set_silent(true);
  const auto ended = read({.line = line(), .addresses = {"holding:5"}});
  EXPECT_EQ(ended.code, ExitCode::kFailed);
  EXPECT_THAT(ended.err, HasSubstr("holding:5: "));
}

TEST(FullPort, NamesOfSerialPortsAreCompleted) {
  test::expect_texts(full_port, {"ttyUSB0 -> /dev/ttyUSB0", "null -> /dev/null", "./x -> ./x",
                                 "/dev/ttyS1 -> /dev/ttyS1", "10.0.0.7:502 -> 10.0.0.7:502"});
  EXPECT_EQ(full_port("plc.local"), "plc.local") << "still no HOST:PORT";
}

TEST_F(DirectTest, APortThatIsNotThereIsSaid) {
  const auto ended = scan({.port = "/dev/fieldcast-none", .addresses = "1"});
  EXPECT_EQ(ended.code, ExitCode::kTrouble);
  EXPECT_THAT(ended.err, HasSubstr("/dev/fieldcast-none"));
}

}  // namespace
}  // namespace fieldcast::cli
