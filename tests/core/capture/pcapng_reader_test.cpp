#include "core/capture/pcapng_reader.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "core/capture/pcapng.hpp"

namespace fieldcast::pcapng {
namespace {

// Builds a file of either byte order, block by block.
class File {
 public:
  explicit File(bool big_endian = false) : big_(big_endian) {}

  void number(std::uint64_t value, unsigned bytes) {
    for (unsigned i = 0; i < bytes; ++i)
      body_.push_back(static_cast<std::uint8_t>(value >> 8 * (big_ ? bytes - 1 - i : i)));
  }
  void bytes(const Bytes& data) {
    body_.insert(body_.end(), data.begin(), data.end());
    while (body_.size() % 4 != 0) body_.push_back(0);
  }
  void option(unsigned code, const Bytes& value) {
    number(code, 2);
    number(value.size(), 2);
    bytes(value);
  }
  void number_option(unsigned code, std::uint64_t value, unsigned size) {
    number(code, 2);
    number(size, 2);
    number(value, size);
    while (body_.size() % 4 != 0) body_.push_back(0);
  }
  void block(std::uint32_t type) {
    const Bytes body = std::exchange(body_, {});
    number(type, 4);
    number(body.size() + 12, 4);
    body_.insert(body_.end(), body.begin(), body.end());
    number(body.size() + 12, 4);
    whole_.insert(whole_.end(), body_.begin(), body_.end());
    body_.clear();
  }
  void section() {
    number(kByteOrderMagic, 4);
    number(1, 2);
    number(0, 2);
    number(~std::uint64_t{0}, 8);
    block(kSectionHeader);
  }
  // `options`: appended by the caller before block().
  void interface_head(unsigned linktype) {
    number(linktype, 2);
    number(0, 2);
    number(0, 4);
  }
  void plain_interface() {
    interface_head(252);
    block(kInterfaceDescription);
  }
  void packet_head(std::uint32_t interface, std::uint64_t at, std::uint32_t kept,
                   std::uint32_t original) {
    number(interface, 4);
    number(at >> 32, 4);
    number(at & 0xFFFFFFFF, 4);
    number(kept, 4);
    number(original, 4);
  }
  void packet(std::uint64_t at) {
    packet_head(0, at, 1, 1);
    bytes({0xAB});
    block(kEnhancedPacket);
  }
  [[nodiscard]] const Bytes& whole() const { return whole_; }
  Bytes& edit() { return whole_; }
  [[nodiscard]] Reader reader() const {
    return Reader([rest = ByteView(whole_)](std::uint8_t* to, std::size_t size) mutable {
      const std::size_t given = std::min(size, rest.size());
      std::memcpy(to, rest.data(), given);
      rest = rest.subspan(given);
      return given;
    });
  }
  // Time of the first packet, in nanoseconds since 1970.
  [[nodiscard]] std::int64_t first_time() const { return (*reader().next())->at.nanoseconds; }
  // Fault after all packets.
  [[nodiscard]] std::optional<Fault> fault() const {
    Reader reader = this->reader();
    for (;;) {
      const auto read = reader.next();
      if (!read) return read.error();
      if (!*read) return std::nullopt;
    }
  }

 private:
  bool big_;
  Bytes body_, whole_;
};

class BothOrders : public testing::TestWithParam<bool> {
 protected:
  BothOrders() { file_.section(); }
  File file_{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(ByteOrder, BothOrders, testing::Bool());

TEST_P(BothOrders, EveryPartOfAPacketIsRead) {
  file_.interface_head(251);
  file_.option(kIfName, {'b', 'u', 's'});
  file_.option(99, {1, 2, 3, 4, 5});  // unknown
  file_.number_option(kIfTsoffset, 1000, 8);
  file_.option(kEndOfOptions, {});
  file_.option(kIfName, {'n', 'o'});  // after the end
  file_.block(kInterfaceDescription);
  file_.packet_head(0, 5'000'001, 5, 9);
  file_.bytes({1, 2, 3, 4, 5});
  file_.option(kComment, {'a'});
  file_.number_option(kPacketFlags, 0xFFFFFFF0 | kOutbound, 4);
  file_.option(kComment, {'b', 'c'});
  file_.block(kEnhancedPacket);
  Reader reader = file_.reader();
  const auto read = reader.next();
  ASSERT_TRUE(read && *read);
  EXPECT_EQ((*read)->interface.linktype, 251);
  EXPECT_EQ((*read)->interface.name, "bus");
  EXPECT_EQ((*read)->interface.offset_seconds, 1000);
  EXPECT_EQ((*read)->at.nanoseconds, 1'005'000'001'000);
  EXPECT_EQ((*read)->data, (Bytes{1, 2, 3, 4, 5}));
  EXPECT_TRUE((*read)->cut);
  EXPECT_EQ((*read)->direction, Direction::kSent);
  EXPECT_EQ((*read)->comment, "a\nbc");
}

TEST_P(BothOrders, ASimplePacketIsOfTheFirstInterfaceAndHasNoTime) {
  file_.plain_interface();
  file_.interface_head(1);
  file_.block(kInterfaceDescription);
  file_.number(3, 4);
  file_.bytes({7, 8, 9});
  file_.block(kSimplePacket);
  file_.number(9, 4);  // of nine bytes, four were kept
  file_.bytes({1, 2, 3, 4});
  file_.block(kSimplePacket);
  Reader reader = file_.reader();
  const auto whole = reader.next();
  ASSERT_TRUE(whole && *whole);
  EXPECT_EQ((*whole)->interface.linktype, 252);
  EXPECT_EQ((*whole)->data, (Bytes{7, 8, 9}));
  EXPECT_FALSE((*whole)->cut);
  EXPECT_EQ((*whole)->at.nanoseconds, 0);
  EXPECT_FALSE((*whole)->direction);
  const auto cut = reader.next();
  ASSERT_TRUE(cut && *cut);
  EXPECT_EQ((*cut)->data, (Bytes{1, 2, 3, 4}));
  EXPECT_TRUE((*cut)->cut);
}

TEST_P(BothOrders, LostPacketsOfAllStatisticsAreAdded) {
  file_.plain_interface();
  for (const std::uint64_t dropped : {std::uint64_t{0x1'0000'0002}, std::uint64_t{5}}) {
    file_.number(0, 4);
    file_.number(0, 8);
    file_.number_option(kIfReceived, 100, 8);
    file_.number_option(kIfDropped, dropped, 8);
    file_.block(kInterfaceStatistics);
  }
  file_.number(0, 8);  // too short: ignored
  file_.block(kInterfaceStatistics);
  Reader reader = file_.reader();
  ASSERT_TRUE(reader.next());
  EXPECT_EQ(reader.dropped(), 0x1'0000'0007u);
}

TEST_P(BothOrders, ASecondSectionHasItsOwnInterfaces) {
  file_.plain_interface();
  file_.packet(1);
  file_.section();
  file_.packet(2);
  EXPECT_EQ(file_.fault(), Fault::kBroken);
}

// One interface with an option, and one packet at `units`.
File file_at(std::uint64_t units, unsigned code, std::uint64_t value, unsigned size) {
  File file;
  file.section();
  file.interface_head(252);
  file.number_option(code, value, size);
  file.block(kInterfaceDescription);
  file.packet(units);
  return file;
}

TEST(PcapngReader, TheResolutionIsAPowerOfTenOrOfTwo) {
  const auto at = [](std::uint64_t units, std::uint8_t resolution) {
    return file_at(units, kIfTsresol, resolution, 1).first_time();
  };
  EXPECT_EQ(at(3, 0), 3'000'000'000);
  EXPECT_EQ(at(3'500, 3), 3'500'000'000);
  EXPECT_EQ(at(1'500'000'000, 9), 1'500'000'000);
  EXPECT_EQ(at(3'000'000'000'000'000'000, 18), 3'000'000'000);
  EXPECT_EQ(at(1'500'000'000, 19), 1'500'000'000) << "beyond 64 bits: nanoseconds";
  EXPECT_EQ(at(3, 0x80), 3'000'000'000);
  EXPECT_EQ(at(1536, 0x8A), 1'500'000'000) << "2^-10";
  EXPECT_EQ(at(std::uint64_t{3} << 61, 0xBE), 1'500'000'000) << "2^-62";
  EXPECT_EQ(at(1'500'000'000, 0xBF), 1'500'000'000) << "2^-63: nanoseconds";
  EXPECT_EQ(file_at(2'000'000, kIfTsresol, 0, 2).first_time(), 2'000'000'000)
      << "an option of a wrong length: microseconds";
}

TEST(PcapngReader, TheOffsetOfTimesHasLimits) {
  const auto at = [](std::int64_t offset) {
    return file_at(5'000'000, kIfTsoffset, static_cast<std::uint64_t>(offset), 8).first_time();
  };
  EXPECT_EQ(at(7), 12'000'000'000);
  EXPECT_EQ(at(-2), 3'000'000'000);
  EXPECT_EQ(at(-5), 0);
  EXPECT_EQ(at(-6), 0) << "not before 1970";
  EXPECT_EQ(at(200'000'000), 200'000'005'000'000'000);
  EXPECT_EQ(at(200'000'001), 200'000'005'000'000'000);
  EXPECT_EQ(at(std::numeric_limits<std::int64_t>::min()), 0);
  EXPECT_EQ(file_at(5'000'000, kIfTsoffset, 7, 4).first_time(), 5'000'000'000);
  EXPECT_EQ(file_at(~std::uint64_t{0}, kIfTsresol, 0, 1).first_time(), 9'000'000'000'000'000'000);
}

TEST(PcapngReader, TheDirectionIsInTheLowestBits) {
  const auto direction = [](std::uint32_t flags, unsigned size = 4) {
    File file;
    file.section();
    file.plain_interface();
    file.packet_head(0, 0, 0, 0);
    file.number_option(kPacketFlags, flags, size);
    file.block(kEnhancedPacket);
    Reader reader = file.reader();
    return (*reader.next())->direction;
  };
  EXPECT_EQ(direction(kInbound), Direction::kReceived);
  EXPECT_EQ(direction(kOutbound), Direction::kSent);
  EXPECT_EQ(direction(4 | kInbound), Direction::kReceived);
  EXPECT_FALSE(direction(0));
  EXPECT_FALSE(direction(3));
  EXPECT_FALSE(direction(kInbound, 2));
}

TEST(PcapngReader, BlocksWithoutSpaceForTheirFieldsAreBroken) {
  const auto fault = [](const auto& add) {
    File file;
    file.section();
    add(file);
    return file.fault();
  };
  EXPECT_EQ(fault([](File& file) {
              file.number(252, 4);  // without the length limit
              file.block(kInterfaceDescription);
            }),
            Fault::kBroken);
  EXPECT_EQ(fault([](File& file) {
              file.plain_interface();
              file.number(0, 8), file.number(0, 8);
              file.block(kEnhancedPacket);
            }),
            Fault::kBroken);
  EXPECT_EQ(fault([](File& file) {
              file.plain_interface();
              file.packet_head(0, 0, 5, 5);
              file.bytes({1, 2, 3, 4});
              file.block(kEnhancedPacket);
            }),
            Fault::kBroken);
  EXPECT_EQ(fault([](File& file) {
              file.plain_interface();
              file.packet_head(0, 0, 4, 4);
              file.bytes({1, 2, 3, 4});
              file.block(kEnhancedPacket);
            }),
            std::nullopt);
  EXPECT_EQ(fault([](File& file) {
              file.plain_interface();
              file.packet_head(1, 0, 0, 0);
              file.block(kEnhancedPacket);
            }),
            Fault::kBroken);
  EXPECT_EQ(fault([](File& file) { file.block(kSimplePacket); }), Fault::kBroken);
  EXPECT_EQ(fault([](File& file) {
              file.number(0, 4);
              file.block(kSimplePacket);
            }),
            Fault::kBroken)
      << "no interface";
}

TEST(PcapngReader, InterfacesAndBlocksHaveLimits) {
  File file;
  file.section();
  for (std::size_t i = 0; i < Reader::kMaxInterfaces; ++i) file.plain_interface();
  EXPECT_EQ(file.fault(), std::nullopt);
  file.plain_interface();
  EXPECT_EQ(file.fault(), Fault::kBroken);
  File large;
  large.section();
  large.bytes(Bytes(kMaxBlock - 12));
  large.block(0xBEEF);
  EXPECT_EQ(large.fault(), std::nullopt);
  File larger;
  larger.section();
  larger.bytes(Bytes(kMaxBlock - 8));
  larger.block(0xBEEF);
  EXPECT_EQ(larger.fault(), Fault::kTooLong);
}

TEST(PcapngReader, LengthsMustFitTogether) {
  File file;
  file.section();
  file.plain_interface();
  const std::size_t section = 28;
  const auto with = [&](std::size_t at, std::uint8_t value) {
    File other = file;
    other.edit()[at] = value;
    return other.fault();
  };
  EXPECT_EQ(with(section - 4, 32), Fault::kBroken) << "the second length differs";
  EXPECT_EQ(with(4, 24), Fault::kBroken) << "shorter than a section header";
  EXPECT_EQ(with(section + 4, 8), Fault::kBroken) << "shorter than any block";
  EXPECT_EQ(with(section + 4, 22), Fault::kBroken) << "not a multiple of four";
  EXPECT_EQ(with(section + 4, 24), Fault::kCut);
  EXPECT_EQ(with(8, 0), Fault::kNoCapture) << "no byte order";
}

TEST(PcapngReader, TheOffsetIsThatOfTheBlockWithTheFault) {
  File file;
  file.section();
  file.plain_interface();
  file.packet(0);
  const std::size_t end = file.whole().size();
  file.packet_head(7, 0, 0, 0);
  file.block(kEnhancedPacket);
  Reader reader = file.reader();
  ASSERT_TRUE(reader.next());
  EXPECT_EQ(reader.offset(), end - 36);
  EXPECT_FALSE(reader.next());
  EXPECT_EQ(reader.offset(), end);
}

TEST(PcapngReader, EveryFaultHasItsText) {
  EXPECT_EQ(to_text(Fault::kNoCapture), "is no pcapng file");
  EXPECT_EQ(to_text(Fault::kOldFormat), "is a pcap file; save it as pcapng in Wireshark");
  EXPECT_EQ(to_text(Fault::kBroken), "has a block whose lengths do not fit together");
  EXPECT_EQ(to_text(Fault::kTooLong), "has a block of more than 1 MiB");
  EXPECT_EQ(to_text(Fault::kCut), "is cut in the middle of a block");
}

TEST(PcapngReader, OldFilesOfEveryKindAreNamed) {
  for (const char* magic : {"A1B2C3D4", "D4C3B2A1", "A1B23C4D", "4D3CB2A1"}) {
    File file;
    file.edit() = *from_hex(std::string(magic) + "00000000");
    EXPECT_EQ(file.fault(), Fault::kOldFormat) << magic;
  }
}

// The whole file, field by field (draft-ietf-opsawg-pcapng).
TEST(PcapngWriter, WritesEveryField) {
  Bytes out;
  append_section(out, "app", "note");
  append_interface(out, "bus", "");
  append_packet(out, {{1'000'002'000}, Direction::kReceived, Bytes{1}, "c"});
  append_statistics(out, {{3'000}, {0x1'0000'0000'000}, 2, 7, ""});
  File file;
  file.number(kByteOrderMagic, 4);
  file.number(1, 2);
  file.number(0, 2);
  file.number(~std::uint64_t{0}, 8);
  file.option(kComment, {'n', 'o', 't', 'e'});
  file.option(kSectionApplication, {'a', 'p', 'p'});
  file.option(kEndOfOptions, {});
  file.block(kSectionHeader);
  file.interface_head(252);
  file.option(kIfName, {'b', 'u', 's'});
  file.option(kIfTsresol, {6});
  file.option(kEndOfOptions, {});
  file.block(kInterfaceDescription);
  file.packet_head(0, 1'000'002, 1, 1);
  file.bytes({1});
  file.option(kComment, {'c'});
  file.number_option(kPacketFlags, kInbound, 4);
  file.option(kEndOfOptions, {});
  file.block(kEnhancedPacket);
  const std::uint64_t ended = 0x1'0000'0000'000 / 1000;
  file.number(0, 4);
  file.number(ended >> 32, 4);
  file.number(ended & 0xFFFFFFFF, 4);
  for (const auto& [code, at] : {std::pair{kIfStart, std::uint64_t{3}}, std::pair{kIfEnd, ended}}) {
    file.number(code, 2);
    file.number(8, 2);
    file.number(at >> 32, 4);
    file.number(at & 0xFFFFFFFF, 4);
  }
  file.number_option(kIfReceived, 2, 8);
  file.number_option(kIfDropped, 7, 8);
  file.option(kEndOfOptions, {});
  file.block(kInterfaceStatistics);
  EXPECT_EQ(to_hex(out), to_hex(file.whole()));
}

TEST(PcapngWriter, LongTextsAreCut) {
  Bytes out;
  append_section(out, "", std::string(60'001, 'x'));
  // Header 8, fixed part 16, option 4 + 60 000, end of options 4, length 4.
  EXPECT_EQ(out.size(), 8u + 16 + 4 + 60'000 + 4 + 4);
}

TEST(PcapngReader, ALaterSectionThatIsInvalidIsAFaultOfTheFile) {
  File file;
  file.section();
  const std::size_t first = file.whole().size();
  file.section();
  File cut = file, magic = file;
  cut.edit().resize(first + 10);
  EXPECT_EQ(cut.fault(), Fault::kCut);
  magic.edit()[first + 8] = 0;
  EXPECT_EQ(magic.fault(), Fault::kBroken) << "no byte order";
}

TEST(PcapngReader, EachFaultHasItsText) {
  EXPECT_EQ(to_text(Fault::kNoCapture), "is no pcapng file");
  EXPECT_EQ(to_text(Fault::kCut), "is cut in the middle of a block");
  EXPECT_EQ(to_text(static_cast<Fault>(99)), "?");
}

}  // namespace
}  // namespace fieldcast::pcapng
