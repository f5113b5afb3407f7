#include "tools/cli/inspect/learn/checksum_search.hpp"

#include <algorithm>
#include <span>

#include "core/codec/digits.hpp"

namespace fieldcast::learn {
namespace {

using declared::Check;
using declared::CheckKind;
using declared::Complement;
using declared::Notation;

constexpr std::size_t kMaxFrom = 16, kMaxGap = 2, kMaxTrailer = 4;
constexpr std::size_t kMaxSample = 48;        // frames
constexpr std::size_t kMaxCovered = 512;      // bytes of a frame of the sample
constexpr std::size_t kMaxWork = 40'000'000;  // covered bytes of all trials
constexpr unsigned kNeededBits = 24;          // of different checksums that fit

struct Algorithm {
  std::string_view name;
  Check check;
  unsigned bytes;
};

std::vector<Algorithm> algorithms() {
  std::vector<Algorithm> all;
  // A wide sum first: the lowest byte of it is a narrow one.
  for (const unsigned bytes : {2u, 1u}) {
    all.push_back({"sum", {.kind = CheckKind::kSum}, bytes});
    all.push_back({"lrc", {.kind = CheckKind::kSum, .complement = Complement::kTwos}, bytes});
    all.push_back({"sum", {.kind = CheckKind::kSum, .complement = Complement::kOnes}, bytes});
  }
  all.push_back({"xor", {.kind = CheckKind::kXor}, 1});
  all.push_back({"xor", {.kind = CheckKind::kXor, .complement = Complement::kOnes}, 1});
  all.push_back({"and", {.kind = CheckKind::kAnd}, 1});
  for (const auto& [name, crc] : declared::crc_catalogue())
    all.push_back({name, {.kind = CheckKind::kCrc, .crc = crc}, (crc.width + 7u) / 8});
  return all;
}

unsigned bits_of(const declared::Word& word) {
  if (word.notation == Notation::kDecimal) return 8;
  return word.characters * (word.notation == Notation::kHex ? 4u : 8u);
}

// Different frames, the shortest first, as they cost the least.
Frames sample_of(const Frames& frames) {
  Frames sample;
  std::set<Bytes> known;
  const std::size_t step = std::max<std::size_t>(1, frames.size() / (2 * kMaxSample));
  for (std::size_t i = 0; i < frames.size() && sample.size() < kMaxSample; i += step) {
    if (frames[i].size() <= kMaxCovered && known.emplace(frames[i].begin(), frames[i].end()).second)
      sample.push_back(frames[i]);
  }
  std::ranges::stable_sort(sample, {}, &ByteView::size);
  return sample;
}

class Search {
 public:
  Search(const Frames& frames, bool text) : sample_(sample_of(frames)), text_(text) {}

  std::optional<FoundChecksum> run() {
    if (sample_.size() < 2) return std::nullopt;
    for (const Algorithm& algorithm : algorithms()) {
      for (const Notation notation : {Notation::kHex, Notation::kDecimal, Notation::kBinary}) {
        const bool decimal = notation == Notation::kDecimal;
        if (notation != Notation::kBinary && !text_) continue;
        if (decimal && (algorithm.bytes > 1 || algorithm.check.kind == CheckKind::kCrc)) continue;
        const unsigned size = decimal ? 3 : algorithm.bytes * (notation == Notation::kHex ? 2 : 1);
        try_word(algorithm, digits(notation, size));
        if (algorithm.bytes > 1)
          try_word(algorithm, {notation, static_cast<std::uint8_t>(size), true});
      }
    }
    if (!best_ || best_->values * bits_of(best_->word) < kNeededBits) return std::nullopt;
    return best_;
  }

  std::optional<FoundChecksum> run_like(FoundChecksum found) {
    if (measure(found)) return found;
    for (found.from = 0; found.from <= kMaxFrom; ++found.from) {
      if (measure(found) && found.values > 1) return found;
    }
    return std::nullopt;
  }

 private:
  void try_word(const Algorithm& algorithm, const declared::Word& word) {
    FoundChecksum found{algorithm.name, algorithm.check, word};
    const std::size_t end = constant_end(sample_, kMaxTrailer);
    // The last character of a checksum is rarely constant.
    for (std::size_t back = 0; back <= std::min<std::size_t>(end, 1); ++back) {
      found.trailer = end - back;
      try_gaps(found);
    }
  }

  void try_gaps(FoundChecksum found) {
    if (bits_of(found.word) > 8 && found.check.kind == CheckKind::kSum) {
      const auto top = found.at() + (found.word.little_endian ? found.word.characters - 1 : 0);
      if (values_at(sample_, top).size() < 2) return;  // a narrow sum behind a constant
    }
    for (found.gap = 0; found.gap <= kMaxGap; ++found.gap) {
      if (found.gap > 0 &&
          !constant_at(sample_, found.at() - static_cast<std::ptrdiff_t>(found.gap)))
        break;
      for (const bool over_bytes : {false, true}) {
        if (over_bytes && found.word.notation != Notation::kHex) continue;
        found.check.over_bytes = over_bytes;
        for (found.from = 0; found.from <= kMaxFrom; ++found.from) {
          const auto rank = [](const FoundChecksum& each) {
            return std::pair(each.evidence.holds, each.values);
          };
          if (measure(found) && (!best_ || rank(found) > rank(*best_))) best_ = found;
        }
      }
    }
  }

  // False if it does not fit nearly all frames.
  bool measure(FoundChecksum& found) {
    found.evidence = {};
    std::set<std::uint64_t> values;
    for (const ByteView frame : sample_) {
      const std::size_t failed = found.evidence.of - found.evidence.holds;
      if (failed > sample_.size() / 10 || work_ > kMaxWork) return false;
      work_ += frame.size() / (found.check.kind == CheckKind::kCrc ? 1 : 8) + 1;
      found.evidence.add(found.fits(frame));
      if (found.evidence.of - found.evidence.holds == failed)
        values.insert(*number_at(frame, found.at(), found.word));
    }
    found.values = values.size();
    return found.evidence.holds_mostly();
  }

  const Frames sample_;
  const bool text_;
  std::size_t work_ = 0;
  std::optional<FoundChecksum> best_;
};

}  // namespace

bool FoundChecksum::fits(ByteView frame) const {
  if (frame.size() < from + 1 + end_size()) return false;
  const auto number = number_at(frame, at(), word);
  if (!number) return false;
  const ByteView covered = frame.subspan(from, frame.size() - end_size() - from);
  if (!check.over_bytes) return declared::check_of(check, bits_of(word), covered) == *number;
  const auto bytes = read_hex_bytes(covered);
  return bytes && declared::check_of(check, bits_of(word), *bytes) == *number;
}

bool FoundChecksum::align(std::ptrdiff_t& at, std::ptrdiff_t& end) const {
  const auto begin = static_cast<std::ptrdiff_t>(from);
  if (!check.over_bytes || at < begin) return false;
  at -= (at - begin) % 2;
  end += (end - begin) % 2;
  return true;
}

std::optional<FoundChecksum> find_same_checksum(const Frames& frames, const FoundChecksum& other) {
  return Search(frames, false).run_like(other);
}

std::optional<FoundChecksum> find_checksum(const Frames& frames, bool text) {
  return Search(frames, text).run();
}

}  // namespace fieldcast::learn
