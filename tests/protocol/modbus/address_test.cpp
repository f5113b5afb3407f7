#include <gtest/gtest.h>

#include "core/protocol/modbus/areas.hpp"

namespace fieldcast::modbus {
namespace {

struct Case {
  std::string_view at;
  Table table;
  std::uint32_t first;
  std::optional<std::uint8_t> bit = {};
};

class Notation : public testing::TestWithParam<Case> {};

TEST_P(Notation, IsUnderstood) {
  const Case& expected = GetParam();
  const auto parsed = parse_address(expected.at);
  ASSERT_TRUE(parsed.has_value()) << parsed.error().what;
  EXPECT_EQ(parsed->area, static_cast<AreaIndex>(expected.table));
  EXPECT_EQ(parsed->first, expected.first);
  EXPECT_EQ(parsed->bit, expected.bit);
  const bool bit_wide =
      expected.table == Table::kCoil || expected.table == Table::kInput || expected.bit;
  EXPECT_EQ(parsed->width_bits, bit_wide ? std::optional<unsigned>{1} : std::nullopt);
}

INSTANTIATE_TEST_SUITE_P(
    Named, Notation,
    testing::Values(Case{"coil:3", Table::kCoil, 3}, Case{"input:0", Table::kInput, 0},
                    Case{"discrete-input:7", Table::kInput, 7},
                    Case{"holding:65535", Table::kHolding, 65535},
                    Case{"holding:0x64", Table::kHolding, 100},
                    Case{"holding:100.5", Table::kHolding, 100, 5},
                    Case{"input-register:100", Table::kInputRegister, 100},
                    Case{"input-register:0xFFFF.15", Table::kInputRegister, 65535, 15}));
INSTANTIATE_TEST_SUITE_P(
    References, Notation,
    testing::Values(Case{"00001", Table::kCoil, 0}, Case{"09999", Table::kCoil, 9998},
                    Case{"10001", Table::kInput, 0}, Case{"30101", Table::kInputRegister, 100},
                    Case{"40101", Table::kHolding, 100}, Case{"400001", Table::kHolding, 0},
                    Case{"465536", Table::kHolding, 65535}, Case{"000001", Table::kCoil, 0},
                    Case{"40101.3", Table::kHolding, 100, 3}));
INSTANTIATE_TEST_SUITE_P(Records, Notation,
                         testing::Values(Case{"file:4:1", Table::kFile, 40001},
                                         Case{"file:1:0", Table::kFile, 10000},
                                         Case{"file:65535:9999", Table::kFile, 655359999},
                                         Case{"file:0x10:0x20.15", Table::kFile, 160032, 15}));
INSTANTIATE_TEST_SUITE_P(Objects, Notation,
                         testing::Values(Case{"id:0", Table::kIdentity, 0},
                                         Case{"id:6", Table::kIdentity, 6 * 244},
                                         Case{"id:basic", Table::kIdentity, 127 * 244},
                                         Case{"id:0xFF", Table::kIdentity, 255 * 244}));
INSTANTIATE_TEST_SUITE_P(Queues, Notation,
                         testing::Values(Case{"fifo:1246", Table::kFifo, 1246 * 32},
                                         Case{"fifo:0x4DE:1", Table::kFifo, 1246 * 32 + 1},
                                         Case{"fifo:65535:31.15", Table::kFifo, 2097151, 15}));

struct Fault {
  std::string_view at;
  std::string_view suggestion;
};

class Refused : public testing::TestWithParam<Fault> {};

TEST_P(Refused, SaysWhatIsAllowedAndWhatWasMeant) {
  const auto parsed = parse_address(GetParam().at);
  ASSERT_FALSE(parsed.has_value());
  EXPECT_FALSE(parsed.error().what.empty());
  EXPECT_FALSE(parsed.error().allowed.empty());
  EXPECT_EQ(parsed.error().suggestion, GetParam().suggestion);
  if (!GetParam().suggestion.empty()) {
    EXPECT_TRUE(parse_address(parsed.error().suggestion).has_value());
  }
}

INSTANTIATE_TEST_SUITE_P(
    Faults, Refused,
    testing::Values(
        Fault{"holdin:100", "holding:100"}, Fault{"Holding:100", "holding:100"},
        Fault{"hr:5", "holding:5"}, Fault{"holding100", "holding:100"}, Fault{"coils:3", "coil:3"},
        Fault{"banana:3", ""}, Fault{"holding:65536", "holding:65535"},
        Fault{"holding:-1", "holding:0"}, Fault{"holding:", "holding:0"},
        Fault{"holding:1x", "holding:0"}, Fault{"holding:99999999999999", "holding:65535"},
        Fault{"holding:100.16", "holding:100.0"}, Fault{"holding:100.", "holding:100.0"},
        Fault{"coil:3.1", "coil:3"}, Fault{"40000", "40001"}, Fault{"20001", ""},
        Fault{"465537", ""}, Fault{"100", "holding:100"}, Fault{"4000001", ""}, Fault{"", ""},
        Fault{":", ""}, Fault{"00001.1", "coil:0"}, Fault{"46h", "holding:0x46"},
        Fault{"0x46", "holding:0x46"}, Fault{"holding:46h", "holding:0x46"},
        Fault{"4x0071", "40071"}, Fault{"3x12", "30012"}, Fault{"%MW70", "holding:70"},
        Fault{"%M3", "coil:3"}, Fault{"file:4", "file:4:0"}, Fault{"file:0:1", "file:1:0"},
        Fault{"file:65536:1", "file:1:0"}, Fault{"file:4:10000", "file:4:0"},
        Fault{"file:4:", "file:4:0"}, Fault{"file::1", "file:1:0"},
        Fault{"file:4:1.16", "file:4:1.0"}, Fault{"file:4:1:2", "file:4:0"},
        Fault{"fil:4:1", "file:4:1"}, Fault{"id:7", "id:0"}, Fault{"id:127", "id:0"},
        Fault{"id:256", "id:0"}, Fault{"id:", "id:0"}, Fault{"id:0.1", "id:0"},
        Fault{"fifo:65536", "fifo:0"}, Fault{"fifo:", "fifo:0"}, Fault{"fifo:1.3", "fifo:0"},
        Fault{"fifo:7:0", "fifo:7:1"}, Fault{"fifo:7:32", "fifo:7:1"},
        Fault{"fifo:7:1.16", "fifo:7:1.0"}, Fault{"fif:7:2", "fifo:7:2"}));

TEST(Refused, AHostileTextIsQuotedInPart) {
  const auto parsed = parse_address(std::string(100'000, 'h') + ":1");
  ASSERT_FALSE(parsed.has_value());
  EXPECT_LT(parsed.error().what.size(), 200u);
}

}  // namespace
}  // namespace fieldcast::modbus
