#include "tools/cli/command/line/inspect.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/tools/cli/parsed_json.hpp"
#include "tools/cli/view/check_view.hpp"

namespace fieldcast::cli {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct Inspected {
  ExitCode code;
  std::string out, err;
};

Inspected run(InspectOptions options, const std::string& input = {}) {
  std::istringstream in(input);
  std::ostringstream out;
  std::ostringstream err;
  const auto code = inspect(options, Streams{in, out, err});
  return {code, out.str(), err.str()};
}

// unit 42 reads input registers 0x10..0x12; source: stepfunc/rodbus, rodbus/src/serial/frame.rs
constexpr const char* kReadInputs = "2A0400100003B7D5";

TEST(Inspect, WholeFrameHasNoFault) {
  const auto inspected = run({"modbus-rtu", {kReadInputs}, false});
  EXPECT_EQ(inspected.code, ExitCode::kOk);
  EXPECT_THAT(inspected.out, HasSubstr("modbus-rtu, 8 bytes: no fault"));
  EXPECT_THAT(inspected.out, HasSubstr("42"));
}

TEST(Inspect, WrongChecksumIsFound) {
  const auto inspected = run({"modbus-rtu", {"2A 04 00 10", "00 03 B7 D6"}, false});
  EXPECT_EQ(inspected.code, ExitCode::kFound);
  EXPECT_THAT(inspected.out, HasSubstr("!!"));
}

TEST(Inspect, ReadsStandardInputWhenThereIsNoArgument) {
  const auto inspected = run({"modbus-rtu", {}, true}, std::string(kReadInputs) + "\n");
  EXPECT_EQ(inspected.code, ExitCode::kOk);
  const auto json = parsed(inspected.out);
  EXPECT_EQ(json["frame"], kReadInputs);
  EXPECT_EQ(json["faults"], 0);
}

TEST(Inspect, UnknownProtocolIsRefusedWithTheListAndASuggestion) {
  const auto inspected = run({"modbus-rut", {kReadInputs}, false});
  EXPECT_EQ(inspected.code, ExitCode::kUsage);
  EXPECT_THAT(inspected.err, HasSubstr("did you mean modbus-rtu?"));
  EXPECT_THAT(inspected.err, HasSubstr("\n  modbus-tcp"));
}

// A configuration next to the directory would resolve the name.
TEST(Inspect, OfADeclarationTheFileIsNamed) {
  const auto before = std::filesystem::current_path();
  const auto folder = std::filesystem::path(testing::TempDir()) / "fieldcast-inspect";
  std::filesystem::create_directories(folder / "protocols");
  std::ofstream(folder / "protocols/mine.yaml") << "summary: mine\n";
  std::filesystem::current_path(folder);
  const auto inspected = run({"mine", {kReadInputs}, false});
  std::filesystem::current_path(before);
  std::filesystem::remove_all(folder);
  EXPECT_THAT(inspected.err,
              HasSubstr("a declaration is named by its file: ./protocols/mine.yaml"));
}

TEST(Inspect, RefusesWhatIsNotHexadecimal) {
  for (const auto* hex : {"", "0", "zz", "01 0"})
    EXPECT_EQ(run({"modbus-rtu", {hex}, false}).code, ExitCode::kUsage) << hex;
  EXPECT_EQ(run({"modbus-rtu", {}, false}, std::string(100'000, '0')).code, ExitCode::kUsage);
}

const Bytes kFrame{0x01, 0x03, 0x00, 0x64, 0x00, 0x02, 0x85, 0xD5};
const std::vector<FrameField> kFields{{0, 0, 1, "unit", "1", ""},
                                      {0, 1, 5, "request", "03 read holding registers", ""},
                                      {1, 2, 2, "first", "100", ""},
                                      {0, 6, 2, "CRC", "D585", "D485 is right"}};

TEST(InspectView, IndentsFieldsAndMarksFaults) {
  const auto lines = inspect_lines("modbus-rtu", kFrame, kFields, {});
  ASSERT_EQ(lines.size(), 6u);
  EXPECT_THAT(lines[3], HasSubstr("00 64           "));
  EXPECT_THAT(lines[3], HasSubstr("   first"));
  EXPECT_THAT(lines[4], StartsWith("!!"));
  EXPECT_THAT(lines[4], HasSubstr("<- D485 is right"));
  EXPECT_EQ(lines[5], "modbus-rtu, 8 bytes: 1 fault");
}

TEST(InspectView, FieldBeyondTheFrameShowsNoBytes) {
  const std::vector<FrameField> fields{{0, 7, 9, "data", "", "cut off"},
                                       {0, 100, 1, "CRC", "", "missing"}};
  const auto lines = inspect_lines("modbus-rtu", kFrame, fields, {});
  EXPECT_THAT(lines[1], HasSubstr("D5"));
  EXPECT_THAT(lines[2], HasSubstr("missing"));
}

TEST(InspectView, JsonCountsFaults) {
  const auto json = parsed(inspect_json("modbus-rtu", kFrame, kFields));
  EXPECT_EQ(json["frame"], "01030064000285D5");
  EXPECT_EQ(json["faults"], 1);
  EXPECT_EQ(json["fields"][2]["depth"], 1);
  EXPECT_EQ(json["fields"][3]["fault"], "D485 is right");
}

}  // namespace
}  // namespace fieldcast::cli
