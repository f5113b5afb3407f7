#include "core/codec/lzw.hpp"

#include <bit>

namespace fieldcast {
namespace {

constexpr unsigned kSingles = 16;

constexpr unsigned width_of(std::size_t k) {
  const std::size_t highest = 15 + k < kLzwEntries - 1 ? 15 + k : kLzwEntries - 1;
  return static_cast<unsigned>(std::bit_width(highest));
}

class BitWriter {
 public:
  explicit BitWriter(std::span<std::uint8_t> out)
      : at_(out.data()), begin_(out.data()), end_(out.data() + out.size()) {}

  // Returns false without space. At most 7 bits remain between two calls, so 32 are enough.
  bool put(unsigned code, unsigned width) {
    waiting_ = waiting_ << width | code;
    count_ += width;
    while (count_ >= 8) {
      if (at_ == end_) return false;
      count_ -= 8;
      *at_++ = static_cast<std::uint8_t>(waiting_ >> count_);
    }
    return true;
  }
  bool fill() { return count_ == 0 || put(0, 8 - count_); }
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(at_ - begin_); }

 private:
  std::uint8_t* at_;
  std::uint8_t* begin_;
  std::uint8_t* end_;
  std::uint32_t waiting_ = 0;
  unsigned count_ = 0;
};

class BitReader {
 public:
  explicit BitReader(ByteView bytes) : bytes_(bytes) {}

  // Empty if fewer bits are left.
  std::optional<unsigned> get(unsigned width) {
    while (count_ < width) {
      if (at_ == bytes_.size()) return std::nullopt;
      waiting_ = waiting_ << 8 | bytes_[at_++];
      count_ += 8;
    }
    count_ -= width;
    return waiting_ >> count_ & ((1u << width) - 1);
  }
  // All bytes are used, and the rest of the last is zero.
  [[nodiscard]] bool at_filled_end() const {
    return at_ == bytes_.size() && (waiting_ & ((1u << count_) - 1)) == 0;
  }

 private:
  ByteView bytes_;
  std::size_t at_ = 0;
  std::uint32_t waiting_ = 0;
  unsigned count_ = 0;  // below 8 between two calls
};

}  // namespace

std::optional<std::size_t> LzwEncoder::encode(ByteView original, std::span<std::uint8_t> out) {
  Trie& children = *children_;
  for (unsigned root = 0; root < kSingles; ++root) children[root].fill(0);
  BitWriter writer(out);
  if (original.empty()) return 0;

  unsigned next = kSingles;  // the next entry
  unsigned width = width_of(0);
  unsigned node = original[0] >> 4;
  // Returns false without space for the output.
  const auto take = [&](unsigned nibble) {
    std::uint16_t& child = children[node][nibble];
    if (child != 0) {
      node = child;
      return true;
    }
    const bool room = writer.put(node, width);
    node = nibble;
    if (next == kLzwEntries) return room;
    child = static_cast<std::uint16_t>(next);
    children[next].fill(0);
    // The next code may be this entry.
    width = static_cast<unsigned>(std::bit_width(next));
    ++next;
    return room;
  };
  take(original[0] & 0xFu);  // the first code alone fills no byte
  for (const std::uint8_t byte : original.subspan(1)) {
    if (!take(byte >> 4) || !take(byte & 0xFu)) return std::nullopt;
  }
  if (!writer.put(node, width) || !writer.fill()) return std::nullopt;
  return writer.size();
}

tl::expected<void, LzwFault> lzw_decode(ByteView codes, std::size_t length, Bytes& out) {
  if (length > kLzwMaxOriginal) return tl::unexpected(LzwFault::kTooLong);
  // Uninitialised: only written elements are read.
  std::array<std::uint8_t, 2 * kLzwMaxOriginal> nibbles;
  std::array<std::uint16_t, kLzwEntries> start, size;  // position of an entry's string in `nibbles`
  const std::size_t wanted = 2 * length;
  std::size_t filled = 0, last_start = 0, last_size = 0;
  BitReader reader(codes);
  for (std::size_t k = 0; filled < wanted; ++k) {
    const auto code = reader.get(width_of(k));
    if (!code) return tl::unexpected(LzwFault::kTruncated);
    const std::size_t defined = 15 + k;
    if (k > 0 && defined < kLzwEntries) {
      start[defined] = static_cast<std::uint16_t>(last_start);
      size[defined] = static_cast<std::uint16_t>(last_size + 1);
    }
    last_start = filled;
    if (*code < kSingles) {
      last_size = 1;
      nibbles[filled++] = static_cast<std::uint8_t>(*code);
      continue;
    }
    if (*code > defined) return tl::unexpected(LzwFault::kCode);
    last_size = size[*code];
    if (last_size > wanted - filled) return tl::unexpected(LzwFault::kOverrun);
    // Forwards, one by one: a new entry ends with its own first nibble, which is written here
    // first.
    for (std::size_t i = 0; i < last_size; ++i) nibbles[filled + i] = nibbles[start[*code] + i];
    filled += last_size;
  }
  if (!reader.at_filled_end()) return tl::unexpected(LzwFault::kTail);
  out.reserve(out.size() + length);
  for (std::size_t i = 0; i < wanted; i += 2)
    out.push_back(static_cast<std::uint8_t>(nibbles[i] << 4 | nibbles[i + 1]));
  return {};
}

std::string_view to_text(LzwFault fault) {
  switch (fault) {
    case LzwFault::kTooLong: return "the original is longer than 4096 bytes";
    case LzwFault::kTruncated: return "the codes end before the original does";
    case LzwFault::kCode: return "a code that is not yet defined";
    case LzwFault::kOverrun: return "a string goes beyond the end of the original";
    case LzwFault::kTail: return "bytes or bits behind the last code";
  }
  return "unknown";
}

}  // namespace fieldcast
