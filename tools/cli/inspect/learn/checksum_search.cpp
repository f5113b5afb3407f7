#include "tools/cli/inspect/learn/checksum_search.hpp"

#include <algorithm>

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
  Search(const Frames& sample, bool text) : sample_(sample), text_(text) {}

  std::optional<FoundChecksum> run() {
    const std::size_t end = constant_end(sample_, kMaxTrailer);
    for (const Algorithm& algorithm : algorithms()) {
      for (const Notation notation : notations(algorithm)) {
        for (const bool little : {false, true}) {
          if (little && (algorithm.bytes == 1 || notation == Notation::kDecimal)) continue;
          FoundChecksum found{std::string(algorithm.name), algorithm.check, {}};
          found.word = {notation, characters(notation, algorithm.bytes), little};
          // The last character of a checksum is rarely constant.
          for (std::size_t back = 0; back <= std::min<std::size_t>(end, 1); ++back) {
            found.trailer = end - back;
            try_gaps(found);
          }
        }
      }
    }
    if (!best_ || best_->values * bits_of(best_->word) < kNeededBits) return std::nullopt;
    return best_;
  }

 private:
  [[nodiscard]] std::vector<Notation> notations(const Algorithm& algorithm) const {
    if (!text_) return {Notation::kBinary};
    if (algorithm.bytes == 1 && algorithm.check.kind != CheckKind::kCrc)
      return {Notation::kHex, Notation::kDecimal, Notation::kBinary};
    return {Notation::kHex, Notation::kBinary};
  }
  static std::uint8_t characters(Notation notation, unsigned bytes) {
    if (notation == Notation::kDecimal) return 3;
    return static_cast<std::uint8_t>(notation == Notation::kHex ? 2 * bytes : bytes);
  }
  static unsigned bits_of(const declared::Word& word) {
    if (word.notation == Notation::kDecimal) return 8;
    return word.characters * (word.notation == Notation::kHex ? 4u : 8u);
  }

  void try_gaps(FoundChecksum found) {
    const auto at = -static_cast<std::ptrdiff_t>(found.trailer + found.word.characters);
    if (bits_of(found.word) > 8 && found.check.kind == CheckKind::kSum) {
      const auto top = found.word.little_endian ? at + found.word.characters - 1 : at;
      if (values_at(sample_, top).size() < 2) return;  // a narrow sum behind a constant
    }
    for (found.gap = 0; found.gap <= kMaxGap; ++found.gap) {
      if (found.gap > 0 && !constant_at(sample_, at - static_cast<std::ptrdiff_t>(found.gap)))
        break;
      for (const bool over_bytes : {false, true}) {
        if (over_bytes && found.word.notation != Notation::kHex) continue;
        found.check.over_bytes = over_bytes;
        for (found.from = 0; found.from <= kMaxFrom; ++found.from) try_one(found);
      }
    }
  }

  void try_one(FoundChecksum& found) {
    found.evidence = {0, sample_.size()};
    const std::size_t allowed = sample_.size() / 10;
    std::set<std::uint64_t> values;
    for (std::size_t i = 0; i < sample_.size(); ++i) {
      if (i - found.evidence.holds > allowed || work_ > kMaxWork) return;
      work_ += sample_[i].size() / (found.check.kind == CheckKind::kCrc ? 1 : 8) + 1;
      if (!found.fits(sample_[i])) continue;
      ++found.evidence.holds;
      const auto at = -static_cast<std::ptrdiff_t>(found.trailer + found.word.characters);
      values.insert(number_at(sample_[i], at, found.word).value_or(0));
    }
    found.values = values.size();
    if (!found.evidence.holds_mostly()) return;
    const auto rank = [](const FoundChecksum& each) {
      return std::pair(each.evidence.holds, each.values);
    };
    if (!best_ || rank(found) > rank(*best_)) best_ = found;
  }

  const Frames& sample_;
  const bool text_;
  std::size_t work_ = 0;
  std::optional<FoundChecksum> best_;
};

}  // namespace

bool FoundChecksum::fits(ByteView frame) const {
  if (frame.size() < from + 1 + end_size()) return false;
  const std::size_t at = frame.size() - trailer - word.characters;
  const auto number = declared::read_word(frame.subspan(at, word.characters), word);
  if (!number) return false;
  const ByteView covered = frame.subspan(from, at - gap - from);
  const bool decimal = word.notation == Notation::kDecimal;
  const unsigned bits = decimal ? 8 : word.characters * (word.notation == Notation::kHex ? 4u : 8u);
  if (!check.over_bytes) return declared::check_of(check, bits, covered) == *number;
  const auto bytes = read_hex_bytes(covered);
  return bytes && declared::check_of(check, bits, *bytes) == *number;
}

std::optional<FoundChecksum> find_same_checksum(const Frames& frames, const FoundChecksum& other) {
  const Frames sample = sample_of(frames);
  for (std::size_t i = 0; i <= kMaxFrom + 1; ++i) {
    FoundChecksum found = other;
    if (i > 0) found.from = i - 1;
    found.evidence = {0, sample.size()};
    std::set<std::uint64_t> values;
    for (const ByteView frame : sample) {
      if (!found.fits(frame)) continue;
      ++found.evidence.holds;
      const auto at = -static_cast<std::ptrdiff_t>(found.trailer + found.word.characters);
      values.insert(number_at(frame, at, found.word).value_or(0));
    }
    found.values = values.size();
    if (found.evidence.holds_mostly() && (i == 0 || found.values > 1)) return found;
  }
  return std::nullopt;
}

std::optional<FoundChecksum> find_checksum(const Frames& frames, bool text) {
  const Frames sample = sample_of(frames);
  return sample.size() < 2 ? std::nullopt : Search(sample, text).run();
}

}  // namespace fieldcast::learn
