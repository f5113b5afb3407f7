#include "tools/cli/inspect/learn/length_rule.hpp"

#include <algorithm>
#include <map>

namespace fieldcast::learn {
namespace {

using declared::Notation;

constexpr std::size_t kMaxPosition = 24;
constexpr std::size_t kMaxWithout = 24;

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
constexpr Size kBinarySizes[] = {{2, 1}, {4, 1}, {8, 1}, {1, 1}, {1, 8}};
constexpr Size kTextSizes[] = {{4, 1}, {8, 1}, {2, 1}, {16, 1}, {5, 1}, {6, 1}, {1, 1}, {2, 8}};

std::size_t size_of(const LengthRule& rule, std::uint64_t items) {
  return static_cast<std::size_t>((items + rule.shared - 1) / rule.shared * rule.times);
}

// The most frequent base, with its evidence.
void set_base(LengthRule& rule, const Frames& requests, const Frames& responses) {
  std::map<std::size_t, std::size_t> counts;
  rule.evidence = {0, requests.size()};
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const auto items = rule.items_in(requests[i]);
    if (!items || *items > 4096) continue;
    const std::size_t size = size_of(rule, *items), length = responses[i].size();
    if (size > length) continue;
    if (const std::size_t count = ++counts[length - size]; count > rule.evidence.holds)
      rule.evidence.holds = count, rule.base = length - size;
  }
}

}  // namespace

std::optional<std::uint64_t> LengthRule::items_in(ByteView request) const {
  if (at < 0) return 0;
  const auto number = number_at(request, at, word);
  if (!is_last || !number) return number;
  const auto end = number_at(request, at + word.characters, word);
  if (!end || *end < *number) return std::nullopt;
  return *end - *number + 1;
}

bool LengthRule::fits(ByteView request, ByteView response) const {
  const auto items = items_in(request);
  return items && *items <= 4096 && size_of(*this, *items) + base == response.size();
}

std::optional<LengthRule> find_length_rule(const Frames& requests, const Frames& responses,
                                           bool text, const MayUse& may_use,
                                           const LengthRule* like) {
  LengthRule best;
  set_base(best, requests, responses);
  const std::size_t end = std::min(shortest(requests), kMaxPosition);
  const auto consider = [&](LengthRule rule) {
    set_base(rule, requests, responses);
    const bool preferred = like != nullptr && best.at >= 0 && rule.at == like->at &&
                           rule.word == like->word && rule.is_last == like->is_last &&
                           (best.at != like->at || best.word != like->word);
    if (rule.evidence.holds > best.evidence.holds ||
        (preferred && rule.evidence.holds == best.evidence.holds))
      best = rule;
  };
  // Packed bits last: a number of one more digit can fit them by chance.
  for (const Size& size :
       text ? std::span<const Size>(kTextSizes) : std::span<const Size>(kBinarySizes)) {
    for (const declared::Word& word : words(text)) {
      for (std::size_t at = 0; at + word.characters <= end; ++at) {
        if (!may_use(at, word.characters)) continue;
        const bool pair =
            at + 2u * word.characters <= end && may_use(at + word.characters, word.characters);
        LengthRule rule{static_cast<std::ptrdiff_t>(at), word, false, size.times, size.shared};
        consider(rule);
        rule.is_last = true;
        if (pair) consider(rule);
      }
    }
  }
  if (!best.evidence.holds_mostly()) return std::nullopt;
  std::set<std::uint64_t> values;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    if (best.fits(requests[i], responses[i])) values.insert(*best.items_in(requests[i]));
  }
  best.lowest = *values.begin();
  best.highest = *values.rbegin();
  return best;
}

bool LengthField::fits(ByteView frame) const {
  const auto number = number_at(frame, at, word);
  return number && *number <= frame.size() && *number * unit + without == frame.size();
}

std::vector<LengthField> find_length_fields(const Frames& frames, bool text) {
  std::vector<LengthField> found;
  if (shortest(frames) == longest(frames)) return found;
  for (std::size_t at = 0; at < kMaxPosition; ++at) {
    LengthField best;
    for (const declared::Word& word : words(text)) {
      for (const unsigned unit : {1u, 2u}) {
        if (unit == 2 && word.notation != Notation::kHex) continue;
        std::map<std::size_t, std::pair<std::size_t, std::set<std::uint64_t>>> counts;
        LengthField field{static_cast<std::ptrdiff_t>(at), word, unit};
        for (const ByteView frame : frames) {
          const auto number = number_at(frame, field.at, word);
          if (frame.size() <= at + word.characters) continue;
          ++field.evidence.of;
          if (!number || *number * unit > frame.size()) continue;
          auto& [count, values] = counts[frame.size() - *number * unit];
          ++count;
          values.insert(*number);
        }
        for (const auto& [without, seen] : counts) {
          const bool good = without >= at && without <= at + kMaxWithout && seen.second.size() > 1;
          if (good && seen.first > field.evidence.holds)
            field.evidence.holds = seen.first, field.without = without;
        }
        if (field.evidence.of * 2 >= frames.size() && field.evidence.holds_mostly() &&
            field.evidence.holds > best.evidence.holds)
          best = field;
      }
    }
    if (best.evidence.holds == 0) continue;
    found.push_back(best);
    at += best.word.characters - 1u;
  }
  return found;
}

}  // namespace fieldcast::learn
