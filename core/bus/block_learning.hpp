// What refusals teach about one area of a device: the longest block it accepts, and gaps that no
// block may bridge.
//
// The scheduler halves a refused block until bad addresses stand alone. When instead every point of
// it is read by smaller blocks, either they left no item out, and its length was what the device
// refused; or what they left out is a gap that it refuses. Pure value, owned by the ReadPath, on
// the bus's thread. Nothing can fail; its tables are bounded.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/time.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

class BlockLearning {
 public:
  // Refusals under search; beyond it the oldest is given up.
  static constexpr std::size_t kMostOpen = 16;
  // Beyond it the oldest gap is forgotten.
  static constexpr std::size_t kMostGaps = 64;
  // Then a longer block may be tried again.
  static constexpr Duration kRemember = std::chrono::hours{1};

  // A block that reads the `wanted` points was refused.
  void refused(const Range& block, std::vector<Range> wanted);
  // The point was refused alone: it explains the refusals that held it.
  void bad(const Range& point);
  // A block was read. True when the longest block is another from now on.
  bool read(const Range& block, Instant now);
  // True when the longest block was forgotten.
  bool expire(Instant now);
  // Another device may be there now. True when the longest block was known.
  bool forget();

  [[nodiscard]] std::uint32_t largest_read() const { return largest_; }  // items
  // Items of the longest block that is accepted, once a longer one was refused; 0: not known.
  [[nodiscard]] std::uint32_t longest() const { return longest_; }
  [[nodiscard]] const std::vector<Range>& gaps() const { return gaps_; }

 private:
  struct Search {
    Range block;
    std::vector<Range> wanted;  // still to be read
    std::vector<bool> seen;     // items of the block that were read
  };
  [[nodiscard]] bool conclude(const Search& search, Instant now);
  void note_gap(const Range& gap);

  std::vector<Search> open_;
  std::vector<Range> gaps_;
  std::uint32_t largest_ = 0, longest_ = 0;
  Instant learned_ = kLongAgo;
};

}  // namespace fieldcast
