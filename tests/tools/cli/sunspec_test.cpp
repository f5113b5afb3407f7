// SunSpec discovery: the walk over the models of devices that behave, that lie and that break off,
// and the configuration that a scan writes for them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "config/loader/loader.hpp"
#include "tests/tools/cli/parsed_json.hpp"
#include "tools/cli/scan/scan_view.hpp"
#include "tools/cli/scan/sunspec_view.hpp"
#include "tools/cli/scan/sunspec_walk.hpp"

namespace fieldcast::cli {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// Holding registers; a missing register is refused.
class Registers {
 public:
  void put(std::uint32_t at, std::initializer_list<std::uint16_t> values) {
    for (const std::uint16_t value : values) registers_[at++] = value;
  }
  void put_text(std::uint32_t at, std::string text, std::size_t registers) {
    text.resize(2 * registers);
    for (std::size_t i = 0; i < text.size(); i += 2)
      registers_[at++] = static_cast<std::uint16_t>(static_cast<std::uint8_t>(text[i]) << 8 |
                                                    static_cast<std::uint8_t>(text[i + 1]));
  }
  void fill(std::uint32_t at, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) registers_.emplace(at + i, std::uint16_t{0});
  }
  [[nodiscard]] std::optional<Bytes> read(const SunSpecWalk::Read& read) const {
    Bytes bytes;
    for (std::uint32_t at = read.first; at < read.first + read.count; ++at) {
      const auto found = registers_.find(at);
      if (found == registers_.end()) return std::nullopt;
      append_u16(bytes, found->second);
    }
    return bytes;
  }

 private:
  std::map<std::uint32_t, std::uint16_t> registers_;
};

// A marker, a common model and further models of (number, length), and the end.
Registers device(std::uint32_t base,
                 const std::vector<std::pair<std::uint16_t, std::uint16_t>>& models) {
  Registers registers;
  registers.put(base, {0x5375, 0x6E53, 1, 66});
  registers.fill(base + 4, 66);
  registers.put_text(base + 4, "SolarEdge", 16);
  registers.put_text(base + 20, "SE10K", 16);
  registers.put_text(base + 44, "4.18", 8);
  registers.put_text(base + 52, "7F12", 16);
  std::uint32_t at = base + 70;
  for (const auto& [number, length] : models) {
    registers.put(at, {number, length});
    registers.fill(at + 2, length);
    at += 2u + length;
  }
  registers.put(at, {0xFFFF, 0});
  return registers;
}

struct Walked {
  SunSpecWalk walk;
  std::vector<std::uint32_t> reads;  // first registers
};
Walked walk_over(const Registers& registers) {
  Walked walked;
  while (const auto read = walked.walk.next()) {
    walked.reads.push_back(read->first);
    EXPECT_LE(walked.reads.size(), 2 * SunSpecWalk::kMostModels + 10) << "endless";
    EXPECT_LE(read->first + read->count, 65536u);
    EXPECT_GE(read->count, 1u);
    EXPECT_LE(read->count, 125u);
    const auto bytes = registers.read(*read);
    if (bytes)
      walked.walk.on_response(*bytes);
    else
      walked.walk.failed(Cause::kDeviceError);
  }
  return walked;
}

TEST(SunSpecWalk, FindsTheModelsAtEachBase) {
  for (const std::uint32_t base : SunSpecWalk::kBases) {
    const auto map = walk_over(device(base, {{103, 50}, {160, 48}, {64001, 7}})).walk.map();
    ASSERT_TRUE(map) << base;
    EXPECT_EQ(map->base, base);
    EXPECT_EQ(map->manufacturer, "SolarEdge");
    EXPECT_EQ(map->model, "SE10K");
    EXPECT_EQ(map->version, "4.18");
    EXPECT_EQ(map->serial_number, "7F12");
    EXPECT_EQ(map->incomplete, "");
    EXPECT_THAT(map->models,
                ElementsAre(SunSpecModel{1, base + 2, 66}, SunSpecModel{103, base + 70, 50},
                            SunSpecModel{160, base + 122, 48}, SunSpecModel{64001, base + 172, 7}));
  }
}

TEST(SunSpecWalk, ADeviceWithoutTheMarkerIsReadThreeTimes) {
  Registers registers;
  registers.fill(0, 100);
  const Walked walked = walk_over(registers);
  EXPECT_FALSE(walked.walk.map());
  EXPECT_THAT(walked.reads, ElementsAre(40000, 50000, 0));
}

TEST(SunSpecWalk, ADeviceThatIsSilentAtTheMarkerCostsOneTimeout) {
  SunSpecWalk walk;
  walk.failed(Cause::kNoResponse);
  EXPECT_FALSE(walk.next());
  EXPECT_FALSE(walk.map());
}

TEST(SunSpecWalk, ABrokenResponseIsReadAgain) {
  SunSpecWalk walk;
  for (unsigned tries = 1; tries < SunSpecWalk::kMostTries; ++tries) {
    walk.failed(Cause::kChecksum);
    ASSERT_TRUE(walk.next());
    EXPECT_EQ(walk.next()->first, 40000u);
  }
  walk.failed(Cause::kChecksum);
  EXPECT_FALSE(walk.next());
}

TEST(SunSpecWalk, AResponseThatIsCutEndsTheListWithAReason) {
  const Registers registers = device(40000, {{103, 50}});
  SunSpecWalk walk;
  unsigned reads = 0;
  while (const auto read = walk.next()) {
    ASSERT_LE(++reads, 20u);
    Bytes bytes = registers.read(*read).value();
    if (read->first == 40070) bytes.pop_back();
    walk.on_response(bytes);
  }
  ASSERT_TRUE(walk.map());
  EXPECT_EQ(walk.map()->models.size(), 1u);
  EXPECT_EQ(walk.map()->incomplete,
            "the header at holding:40070 cannot be read: malformed response");
}

TEST(SunSpecWalk, ARefusedModelEndsTheListWithAReason) {
  Registers registers;
  registers.put(0, {0x5375, 0x6E53, 1, 66});
  const auto map = walk_over(registers).walk.map();
  ASSERT_TRUE(map);
  EXPECT_EQ(map->models.size(), 1u) << "without its texts, which are refused too";
  EXPECT_EQ(map->manufacturer, "");
  EXPECT_THAT(map->incomplete, HasSubstr("the header at holding:70 cannot be read: "));
}

TEST(SunSpecWalk, ModelsWithoutEndAreLimited) {
  Registers registers = device(0, {});
  for (std::uint32_t at = 70; at < 1000; at += 2) registers.put(at, {103, 0});
  const Walked walked = walk_over(registers);
  ASSERT_TRUE(walked.walk.map());
  EXPECT_EQ(walked.walk.map()->models.size(), SunSpecWalk::kMostModels);
  EXPECT_EQ(walked.walk.map()->incomplete, "there are more than 64 models");
  EXPECT_THAT(sunspec_channels(*walked.walk.map()), Not(Contains(HasSubstr("inverter"))))
      << "no point is inside a model of length 0";
}

TEST(SunSpecWalk, ALengthBeyondTheAddressSpaceEndsTheList) {
  Registers registers = device(40000, {});
  registers.put(40070, {103, 0xFFFF});
  const auto map = walk_over(registers).walk.map();
  ASSERT_TRUE(map);
  EXPECT_EQ(map->models.size(), 1u);
  EXPECT_THAT(map->incomplete, HasSubstr("model 103 at holding:40070 has a length of 65535"));
  // The model ends at the last register, so no end mark follows.
  registers.put(40070, {103, static_cast<std::uint16_t>(65536 - 40072)});
  const auto full = walk_over(registers).walk.map();
  ASSERT_TRUE(full);
  EXPECT_EQ(full->models.size(), 2u);
  EXPECT_EQ(full->incomplete, "the last model has no end mark behind it");
}

TEST(SunSpecWalk, ZerosAreNotAModel) {
  Registers registers;
  registers.fill(40000, 100);
  registers.put(40000, {0x5375, 0x6E53});
  const auto map = walk_over(registers).walk.map();
  ASSERT_TRUE(map);
  EXPECT_THAT(map->models, IsEmpty());
  EXPECT_EQ(map->incomplete, "the model at holding:40002 has the number 0");
}

TEST(SunSpecWalk, AShortCommonModelHasThePartsThatAreThere) {
  Registers registers;
  registers.put(0, {0x5375, 0x6E53, 1, 17});
  registers.put_text(4, "Maker", 16);
  registers.put(20, {0x4142, 0xFFFF, 0});
  const auto map = walk_over(registers).walk.map();
  ASSERT_TRUE(map);
  EXPECT_EQ(map->manufacturer, "Maker");
  EXPECT_EQ(map->model, "AB");
  EXPECT_EQ(map->version, "");
  EXPECT_EQ(map->incomplete, "");
}

TEST(SunSpecWalk, EndsWhateverADeviceSends) {
  std::uint32_t random = 1;
  for (unsigned run = 0; run < 3000; ++run) {
    SunSpecWalk walk;
    unsigned reads = 0;
    while (const auto read = walk.next()) {
      ASSERT_LE(++reads, 3 * 2 * SunSpecWalk::kMostModels + 20) << "endless";
      ASSERT_LE(read->first + read->count, 65536u);
      random = random * 1664525 + 1013904223;
      Bytes bytes(2 * read->count);
      for (auto& byte : bytes) {
        random = random * 1664525 + 1013904223;
        byte = static_cast<std::uint8_t>(random >> 24 & (random >> 20 & 1 ? 0xFF : 0x03));
      }
      if (!walk.map()) bytes = {'S', 'u', 'n', 'S'};
      if (random >> 28 == 0) bytes.pop_back();
      if (random >> 28 == 1)
        walk.failed(Cause::kNoResponse);
      else
        walk.on_response(bytes);
    }
    if (walk.map()) (void)sunspec_channels(*walk.map());
  }
}

TEST(SunSpecChannels, HaveExponentAndNotAvailable) {
  const auto lines =
      sunspec_channels({40000, {{103, 40069, 50}, {203, 40121, 105}}, {}, {}, {}, {}, {}});
  EXPECT_THAT(
      lines,
      Contains("{ name: inverter-ac-power, at: \"holding:40083\", type: int16, not-available: "
               "0x8000, exponent-from: \"holding:40084\", unit: \"W\" }"));
  EXPECT_THAT(lines, Contains("{ name: inverter-energy, at: \"holding:40093\", type: uint32, "
                              "exponent-from: \"holding:40095\", unit: \"Wh\" }"));
  EXPECT_THAT(lines, Contains("{ name: meter-energy-import, at: \"holding:40167\", type: uint32, "
                              "exponent-from: \"holding:40175\", unit: \"Wh\" }"));
}

TEST(SunSpecChannels, OnePhaseHasNoOthers) {
  const auto one = sunspec_channels({0, {{101, 70, 50}, {201, 122, 105}}, {}, {}, {}, {}, {}});
  EXPECT_THAT(one, Contains(HasSubstr("inverter-ac-voltage-l1,")));
  EXPECT_THAT(one, Not(Contains(HasSubstr("-l2"))));
  const auto split = sunspec_channels({0, {{102, 70, 50}, {202, 122, 105}}, {}, {}, {}, {}, {}});
  EXPECT_THAT(split, Contains(HasSubstr("meter-current-l2,")));
  EXPECT_THAT(split, Not(Contains(HasSubstr("-l3"))));
}

TEST(SunSpecChannels, InputsOfAModelAndSecondModelsHaveNumbers) {
  const auto lines =
      sunspec_channels({0, {{160, 70, 48}, {203, 120, 105}, {204, 227, 105}}, {}, {}, {}, {}, {}});
  EXPECT_THAT(lines,
              Contains("{ name: input-dc2-current, at: \"holding:109\", type: uint16, "
                       "not-available: 0xFFFF, exponent-from: \"holding:72\", unit: \"A\" }"));
  EXPECT_THAT(lines, Not(Contains(HasSubstr("dc3"))));
  EXPECT_THAT(lines, Contains(HasSubstr("{ name: meter-current,")));
  EXPECT_THAT(lines, Contains(HasSubstr("{ name: meter-2-current,")));
  const auto many = sunspec_channels({0, {{160, 70, 168}}, {}, {}, {}, {}, {}});
  EXPECT_THAT(many, Contains(HasSubstr("input-dc6-energy")));
  EXPECT_THAT(many, Not(Contains(HasSubstr("dc7")))) << "its exponent is too far away for one read";
}

// The bridge's loader accepts the output of a scan, with any text that a device returns.
TEST(SunSpecChannels, TheConfigurationOfAScanLoads) {
  std::vector<ScanLine> scan_line{{{find_protocol("modbus-tcp"), {}}, LineFormat{}, {1, 2}}};
  Scanner scanner(scan_line);
  scanner.on_response({.device = true});
  scanner.on_response({.device = true, .cause = Cause::kDeviceError, .device_code = 2});
  Registers registers = device(40000, {{101, 50},
                                       {102, 50},
                                       {103, 50},
                                       {160, 648},
                                       {201, 105},
                                       {202, 105},
                                       {203, 105},
                                       {204, 105},
                                       {1, 66},
                                       {103, 50}});
  registers.put_text(40004, "Evil\n  - x: \x1b[2J\xFF", 16);
  scanner.set_sunspec(0, walk_over(registers).walk.map().value());
  scanner.set_sunspec(1, walk_over(device(0, {{64001, 7}})).walk.map().value());
  const std::string text = configuration_text("127.0.0.1:502", false, scanner);
  const auto loaded = config::load_text(text, "scan.yaml", {});
  ASSERT_TRUE(loaded) << config::to_text(std::span<const config::Fault>(loaded.error()));
  const auto& devices = loaded->buses[0].devices;
  ASSERT_EQ(devices.size(), 2u);
  EXPECT_GT(devices[0].channels.size(), 200u);
  EXPECT_EQ(devices[1].channels.size(), 4u) << "those of the common model";
  EXPECT_THAT(text, HasSubstr("# it says: SolarEdge, SE10K, 4.18, serial number 7F12\n"));
  EXPECT_THAT(text, HasSubstr("# SunSpec models from holding:0 on: 1 (common), 64001\n"));
  EXPECT_THAT(text, HasSubstr("# it says: Evil\\n  - x: \\x1B[2J\\xFF, SE10K"));
}

TEST(SunSpecView, SaysWhatIsMissing) {
  const SunSpecMap map{40000, {{103, 40002, 50}}, "A\xFF", "B", "", "C", "it broke off"};
  EXPECT_THAT(sunspec_lines(7, map),
              ElementsAre("address 7: SunSpec models from holding:40000 on: 103 (inverter, three "
                          "phases)",
                          "address 7: the list of models is not whole: it broke off"));
  const auto json = parsed(sunspec_json(map));
  EXPECT_EQ(json["models"][0]["at"], 40002);
  EXPECT_EQ(json["incomplete"], "it broke off");
  EXPECT_EQ(json["manufacturer"], "A\uFFFD") << "bytes that are not UTF-8";
}

}  // namespace
}  // namespace fieldcast::cli
