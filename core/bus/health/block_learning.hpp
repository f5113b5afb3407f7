// Learns from refusals the longest block that one area of a device accepts, and gaps that no block
// may bridge. The scheduler halves a refused block until each bad address is isolated. If smaller
// blocks read every point instead, there are two cases. If they left out no item, the device
// refused the length of the block. Otherwise the device refuses one of the gaps. Pure value, owned
// by ReadPath, on the bus's thread.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/time.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

class BlockLearning {
 public:
  static constexpr std::size_t kMostOpen = 16;
  static constexpr std::size_t kMostGaps = 64;
  static constexpr Duration kRemember = std::chrono::hours{1};

  // `wanted`: points read by the refused block.
  void refused(const Range& block, std::vector<Range> wanted);
  // Closes the searches that contain this point: a single refused point explains them.
  void bad(const Range& point);
  // Returns true if the longest block changed.
  bool read(const Range& block, Instant now);
  bool expire(Instant now);
  // The device may have been replaced. Returns true if the longest block was known.
  bool forget();

  [[nodiscard]] std::uint32_t largest_read() const { return largest_; }
  // Longest accepted block in items, once a longer one was refused; 0 if unknown.
  [[nodiscard]] std::uint32_t longest() const { return longest_; }
  [[nodiscard]] const std::vector<Range>& gaps() const { return gaps_; }

 private:
  struct Search {
    Range block;
    std::vector<Range> wanted;
    std::vector<bool> seen;  // items of the block that were read
  };
  [[nodiscard]] bool conclude(const Search& search, Instant now);
  void note_gap(const Range& gap);

  std::vector<Search> open_;
  std::vector<Range> gaps_;
  std::uint32_t largest_ = 0, longest_ = 0;
  Instant learned_ = kLongAgo;
};

}  // namespace fieldcast
