// Reads the packets of a pcapng file in either byte order. Skips unknown blocks and options, as the
// format requires. Owns at most one block (kMaxBlock). Packets before a fault stay valid.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "core/capture/capture_record.hpp"

namespace fieldcast::pcapng {

struct Interface {
  std::uint16_t linktype = 0;
  std::string name;
  std::uint64_t units_per_second = 1'000'000;  // of its times
  std::int64_t offset_seconds = 0;
};

struct ReadPacket {
  Interface interface;
  UtcTime at;
  std::optional<Direction> direction;
  std::string comment;  // several comments are joined by line ends
  Bytes data;
  bool cut = false;  // the capture contains only its beginning
};

enum class Fault : std::uint8_t {
  kNoCapture,  // not a pcapng file
  kOldFormat,  // a pcap file, the older format
  kBroken,     // a block with inconsistent lengths
  kTooLong,    // a block beyond kMaxBlock
  kCut,        // the file ends within a block
};
[[nodiscard]] std::string_view to_text(Fault fault);

class Reader {
 public:
  static constexpr std::size_t kMaxInterfaces = 1024;

  // Returns the number of bytes read into `to`; less than `size` only at the end.
  using Source = std::function<std::size_t(std::uint8_t* to, std::size_t size)>;
  explicit Reader(Source source) : source_(std::move(source)) {}

  // The next packet; empty at the end of the file. There are no more packets after a fault.
  [[nodiscard]] tl::expected<std::optional<ReadPacket>, Fault> next();
  // Lost packets according to the file; known at its end.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  [[nodiscard]] std::uint64_t offset() const { return offset_; }

 private:
  struct Block {
    std::uint32_t type = 0;
    ByteView body;  // refers to block_
  };
  [[nodiscard]] tl::expected<std::optional<Block>, Fault> read_block();
  [[nodiscard]] tl::expected<void, Fault> read_section();
  [[nodiscard]] std::optional<Fault> add_interface(ByteView body);
  [[nodiscard]] tl::expected<ReadPacket, Fault> enhanced(ByteView body) const;
  [[nodiscard]] tl::expected<ReadPacket, Fault> simple(ByteView body) const;
  void add_statistics(ByteView body);
  template <typename Take>
  void options(ByteView body, const Take& take) const;
  [[nodiscard]] std::uint32_t u32(ByteView bytes, std::size_t at) const;
  [[nodiscard]] std::uint16_t u16(ByteView bytes, std::size_t at) const;

  Source source_;
  std::vector<Interface> interfaces_;
  Bytes block_;
  std::uint64_t offset_ = 0, next_offset_ = 0;
  std::uint64_t dropped_ = 0;
  bool big_endian_ = false;
  bool begun_ = false;
};

}  // namespace fieldcast::pcapng
