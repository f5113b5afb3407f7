#include "tools/cli/inspect/learn/length_rule.hpp"

#include <algorithm>
#include <map>
#include <span>

namespace fieldcast::learn {
namespace {

using declared::Notation;

constexpr std::size_t kMaxPosition = 24;
constexpr std::size_t kMaxBase = 24;  // characters that a length field does not count, behind it
constexpr std::uint64_t kMaxItems = 4096;

// The widest first: a narrow number behind zeros has the same value.
std::vector<declared::Word> words(bool text) {
  if (!text) return {binary(2), binary(2, true), binary(1)};
  std::vector<declared::Word> all;
  for (const Notation notation : {Notation::kDecimal, Notation::kHex}) {
    for (std::size_t count = 6; count > 0; --count) all.push_back(digits(notation, count));
  }
  return all;
}

struct Size {
  unsigned times, shared;
};
// Packed bits last: a number of one more digit can fit them by chance.
constexpr Size kBinarySizes[] = {{2, 1}, {4, 1}, {8, 1}, {1, 1}, {1, 8}};
constexpr Size kTextSizes[] = {{4, 1}, {8, 1}, {2, 1}, {16, 1}, {5, 1}, {6, 1}, {1, 1}, {2, 8}};

// The characters of the items that the frame names; empty if it names none, or too many.
std::optional<std::pair<std::uint64_t, std::size_t>> items_in(const LengthRule& rule,
                                                              ByteView frame) {
  std::uint64_t items = 0;
  if (rule.at >= 0) {
    const auto number = number_at(frame, rule.at, rule.word);
    if (!number) return std::nullopt;
    items = *number;
    if (rule.is_last) {
      const auto last = number_at(frame, rule.at + rule.word.characters, rule.word);
      if (!last || *last < items) return std::nullopt;
      items = *last - items + 1;
    }
  }
  if (items > kMaxItems) return std::nullopt;
  return std::pair(items, (items + rule.shared - 1) / rule.shared * rule.times);
}

}  // namespace

bool LengthRule::fits(ByteView with_number, ByteView frame) const {
  const auto items = items_in(*this, with_number);
  return items && items->second + base == frame.size();
}

void LengthRule::measure(const Frames& with_number, const Frames& frames) {
  struct Base {
    std::size_t frames = 0;
    std::uint64_t lowest = UINT64_MAX, highest = 0;
  };
  std::map<std::size_t, Base> bases;
  evidence = {0, frames.size()};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto items = items_in(*this, with_number[i]);
    if (!items || items->second > frames[i].size()) continue;
    const std::size_t others = frames[i].size() - items->second;
    Base& each = bases[others];
    each.lowest = std::min(each.lowest, items->first);
    each.highest = std::max(each.highest, items->first);
    if (++each.frames > evidence.holds) evidence.holds = each.frames, base = others;
  }
  if (evidence.holds > 0) lowest = bases[base].lowest, highest = bases[base].highest;
}

std::optional<LengthRule> find_length_rule(const Frames& requests, const Frames& responses,
                                           bool text, const MayUse& may_use,
                                           const LengthRule* like) {
  LengthRule best;
  best.measure(requests, responses);
  const auto is_like = [&](const LengthRule& rule) {
    return like != nullptr && rule.at == like->at && rule.word == like->word &&
           rule.is_last == like->is_last;
  };
  const auto consider = [&](LengthRule rule) {
    rule.measure(requests, responses);
    const bool preferred = best.at >= 0 && is_like(rule) && !is_like(best);
    if (rule.evidence.holds > best.evidence.holds ||
        (preferred && rule.evidence.holds == best.evidence.holds))
      best = rule;
  };
  const std::size_t end = std::min(shortest(requests), kMaxPosition);
  for (const auto& [times, shared] : text ? std::span<const Size>(kTextSizes) : kBinarySizes) {
    for (const declared::Word& word : words(text)) {
      for (std::size_t at = 0; at + word.characters <= end; ++at) {
        if (!may_use(at, word.characters)) continue;
        const auto begin = static_cast<std::ptrdiff_t>(at);
        consider({.at = begin, .word = word, .times = times, .shared = shared});
        if (at + 2u * word.characters <= end && may_use(at + word.characters, word.characters))
          consider({.at = begin, .word = word, .is_last = true, .times = times, .shared = shared});
      }
    }
  }
  return best.evidence.holds_mostly() ? std::optional(best) : std::nullopt;
}

std::vector<LengthRule> find_length_fields(const Frames& frames, bool text) {
  std::vector<LengthRule> found;
  if (shortest(frames) == longest(frames)) return found;
  for (std::size_t at = 0; at < kMaxPosition; ++at) {
    LengthRule best;
    for (const declared::Word& word : words(text)) {
      // A pair of hexadecimal digits is one byte.
      for (const unsigned unit : {1u, 2u}) {
        if (unit == 2 && word.notation != Notation::kHex) continue;
        LengthRule rule{.at = static_cast<std::ptrdiff_t>(at), .word = word, .times = unit};
        rule.measure(frames, frames);
        if (rule.base >= at && rule.base <= at + kMaxBase && rule.lowest != rule.highest &&
            rule.evidence.holds_mostly() && rule.evidence.holds > best.evidence.holds)
          best = rule;
      }
    }
    if (best.at < 0) continue;
    found.push_back(best);
    at += best.word.characters - 1u;
  }
  return found;
}

}  // namespace fieldcast::learn
