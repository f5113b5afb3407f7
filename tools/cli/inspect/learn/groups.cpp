#include "tools/cli/inspect/learn/groups.hpp"

#include <algorithm>
#include <map>

#include "core/codec/digits.hpp"
#include "tools/cli/inspect/learn/length_rule.hpp"

namespace fieldcast::learn {
namespace {

using declared::FieldKind;

constexpr std::ptrdiff_t kMaxShift = 12;
constexpr std::ptrdiff_t kMaxCommandAt = 20;
constexpr std::ptrdiff_t kMaxAddress = 8;
constexpr std::size_t kMaxCommands = 16;
constexpr std::size_t kMaxTried = 128;  // exchanges of a group when a division is tried

// Groups of equal keys, in the order of their first request.
template <typename Key>
Groups divided(const Groups& groups, const Key& key) {
  Groups all;
  for (const Group& group : groups) {
    std::map<Bytes, std::size_t> index;
    for (std::size_t i = 0; i < group.requests.size(); ++i) {
      const auto [at, is_new] = index.try_emplace(key(group.requests[i]), all.size());
      if (is_new) all.emplace_back();
      all[at->second].add(group.requests[i], group.responses[i]);
    }
  }
  return all;
}

Groups divided_by(const Groups& groups, std::ptrdiff_t column, std::ptrdiff_t width = 1) {
  return divided(groups, [&](ByteView request) {
    const ByteView key = columns_of(request, column, static_cast<std::size_t>(width));
    return Bytes(key.begin(), key.end());
  });
}

// A letter that differs is a command, if no digit occurs in its column.
std::optional<std::ptrdiff_t> letter_column(const Group& group, std::size_t end_size) {
  for (std::ptrdiff_t i = 0; i + end_size < shortest(group.requests); ++i) {
    const auto values = values_at(group.requests, i);
    if (values.size() > 1 && values.size() <= 6 && group.requests.size() >= 4 &&
        std::ranges::none_of(values, [](std::uint8_t c) { return c >= '0' && c <= '9'; }))
      return i;
  }
  return std::nullopt;
}

// Description length: a group whose responses follow a rule costs little.
std::size_t cost_of(const Groups& groups, bool text) {
  std::size_t cost = 0;
  for (const Group& group : groups) {
    const std::size_t size = group.requests.size(), tried = std::min(size, kMaxTried);
    const Frames requests(group.requests.begin(),
                          group.requests.begin() + static_cast<std::ptrdiff_t>(tried));
    const Frames responses(group.responses.begin(),
                           group.responses.begin() + static_cast<std::ptrdiff_t>(tried));
    const auto rule =
        find_length_rule(requests, responses, text, [](auto at, auto) { return at > 0; });
    const bool same_size = shortest(group.requests) == longest(group.requests);
    cost += rule && same_size ? 2 + size - size * rule->evidence.holds / tried : size;
  }
  return cost;
}

// Nearly every request has the number of the one before, plus one.
bool is_counter(const Frames& requests, std::ptrdiff_t at) {
  Evidence steps;
  for (std::size_t i = 1; i < requests.size(); ++i) {
    const auto before = byte_at(requests[i - 1], at), now = byte_at(requests[i], at);
    if (before && now) steps.add(static_cast<std::uint8_t>(*before + 1) == *now);
  }
  return steps.of >= 6 && steps.holds_mostly();
}

// Zeros that both have by chance are one value.
std::size_t echoed_values(const Group& group, std::ptrdiff_t column, std::ptrdiff_t shift) {
  std::set<std::uint8_t> values;
  for (std::size_t i = 0; i < group.requests.size(); ++i) {
    const auto sent = byte_at(group.requests[i], column);
    if (sent && byte_at(group.responses[i], column + shift) == sent) values.insert(*sent);
  }
  return values.size();
}

class Finder {
 public:
  explicit Finder(const std::vector<Exchange>& exchanges)
      : groups_(out_.groups), roles_(out_.roles) {
    groups_.emplace_back();
    for (const Exchange& each : exchanges) groups_.front().add(each.request, each.response);
    in_order_ = groups_.front().requests;
  }

  Grouping run() {
    const Frames responses = groups_.front().responses;
    roles_.text = is_text(in_order_) && is_text(responses);
    roles_.request_check = find_checksum(in_order_, roles_.text);
    roles_.response_check = find_checksum(responses, roles_.text);
    if (!roles_.request_check && roles_.response_check)
      roles_.request_check = find_same_checksum(in_order_, *roles_.response_check);
    if (!roles_.response_check && roles_.request_check)
      roles_.response_check = find_same_checksum(responses, *roles_.request_check);
    end_size_ = roles_.request_check ? roles_.request_check->end_size() : 0;
    if (roles_.text) {
      divide_text();
    } else if (const auto column = divide(1, [](std::ptrdiff_t) { return true; })) {
      roles_.command = {.kind = FieldKind::kCommand, .at = *column, .width = 1, .word = binary(1)};
    }
    find_echoes();
    find_sequence();
    find_address();
    find_command();
    return std::move(out_);
  }

 private:
  // Letters and marks of a text are its command; digits are its numbers.
  void divide_text() {
    groups_ = divided(groups_, [&](ByteView request) {
      Bytes skeleton(request.begin(), request.end());
      for (std::size_t i = 0; i < skeleton.size(); ++i) {
        if (hex_digit(request[i]) >= 0 || i + end_size_ >= skeleton.size()) skeleton[i] = '0';
      }
      return skeleton;
    });
    for (std::size_t i = 0; i < groups_.size() && groups_.size() < kMaxGroups; ++i) {
      while (const auto column = letter_column(groups_[i], end_size_)) {
        Groups parts = divided_by({groups_[i]}, *column);
        groups_[i] = std::move(parts.front());
        groups_.insert(groups_.end(), parts.begin() + 1, parts.end());
      }
    }
    // Two digits that the responses repeat, if the responses then follow a rule.
    const Groups whole = groups_;
    const auto is_digit = [&](std::ptrdiff_t column) {
      return std::ranges::all_of(whole, [&](const Group& group) {
        return are_digits(group.requests, column, column + 1, 16) &&
               echo_of({&group, 1}, column, 0).holds_mostly();
      });
    };
    if (whole.size() < kMaxGroups)
      divide(2, [&](std::ptrdiff_t at) { return at > 0 && is_digit(at) && is_digit(at + 1); });
  }

  // Divides by the columns that give the cheapest groups. No effect if the whole is as cheap.
  template <typename MayBe>
  std::optional<std::ptrdiff_t> divide(std::ptrdiff_t width, const MayBe& may_be) {
    std::optional<std::ptrdiff_t> found;
    std::size_t best = cost_of(groups_, roles_.text);
    const Groups whole = groups_;
    for (std::ptrdiff_t column = 0; column < kMaxCommandAt; ++column) {
      const auto values = different(in_order_, column, column + width);
      if (values < 2 || values > kMaxCommands || !may_be(column)) continue;
      Groups parts = divided_by(whole, column, width);
      const std::size_t cost = cost_of(parts, roles_.text);
      if (cost < best) best = cost, found = column, groups_ = std::move(parts);
    }
    return found;
  }

  // The distance at which most columns that differ within a group are repeated.
  void find_echoes() {
    for (std::ptrdiff_t i = 0; i <= 2 * kMaxShift; ++i) {
      const std::ptrdiff_t shift = i % 2 == 0 ? i / 2 : -(i + 1) / 2;
      std::set<std::ptrdiff_t> found;
      for (std::ptrdiff_t column = std::max<std::ptrdiff_t>(0, -shift); column < kMaxHead;
           ++column) {
        const Evidence all = echo_of(groups_, column, shift);
        const bool differs = std::ranges::any_of(groups_, [&](const Group& group) {
          return echo_of({&group, 1}, column, shift).holds_mostly() &&
                 echoed_values(group, column, shift) > 1;
        });
        if (differs && all.of * 4 >= in_order_.size() && all.holds_mostly()) found.insert(column);
      }
      if (found.size() > echoes_.size()) echoes_ = std::move(found), roles_.shift = shift;
    }
  }

  // `at`: if there are several, the first one.
  LearnedField echoed(FieldKind kind, std::ptrdiff_t at, std::ptrdiff_t end) const {
    const bool pairs = roles_.request_check && roles_.request_check->align(at, end);
    const auto width = static_cast<std::size_t>(end - at);
    LearnedField field{.kind = kind, .at = at, .width = width};
    field.word = word_at(in_order_, at, width, roles_.text);
    if (pairs) field.word.notation = declared::Notation::kHex;
    field.echo = roles_.shift;
    return field;
  }

  void find_sequence() {
    for (const std::ptrdiff_t column : echoes_) {
      if (!is_counter(in_order_, column)) continue;
      const bool wide =
          column > 0 && (echoes_.contains(column - 1) || constant_at(in_order_, column - 1) == 0);
      roles_.sequence = echoed(FieldKind::kSequence, column - (wide ? 1 : 0), column + 1);
      std::erase_if(echoes_, [&](auto other) { return roles_.sequence.holds(other); });
      return;
    }
  }

  void find_address() {
    const auto free = [&](std::ptrdiff_t column) { return !roles_.command.holds(column); };
    const auto first = std::ranges::find_if(echoes_, free);
    if (first == echoes_.end()) return roles_.text ? guess_text_address() : guess_address();
    std::ptrdiff_t at = *first, end = at + 1;
    const Frames& all = in_order_;
    // The next column belongs to it, unless it makes more combinations than there are devices.
    const auto belongs = [&](std::ptrdiff_t column) {
      if (roles_.text) return are_digits(all, column, column + 1, 16);
      const std::size_t both = different(all, at, column + 1);
      return both == different(all, column, column + 1) || both == different(all, at, column);
    };
    while (end - at < kMaxAddress && echoes_.contains(end) && free(end) && belongs(end)) ++end;
    while (roles_.text && at > 0 && constant_at(all, at - 1) == '0') --at;
    roles_.address = echoed(FieldKind::kAddress, at, end);
    if (!roles_.text && roles_.address.width > 2 &&
        packed_adds(values_in(all, at, end)).contains(0)) {
      roles_.address.word.notation = declared::Notation::kBcd;
      roles_.address.note = "only decimal digits occur; the byte order is a guess";
    } else if (roles_.address.word.notation == declared::Notation::kDecimal) {
      roles_.address.note = "no digit above 9: perhaps hexadecimal";
    }
    if (roles_.text || roles_.command.width != 0 || !echoes_.contains(end) ||
        values_at(all, end).size() > kMaxCommands)
      return;
    // Two repeated numbers, which no frame distinguishes: by custom the address is the first.
    roles_.command = echoed(FieldKind::kCommand, end, end + 1);
    roles_.command.note = "address and command may be exchanged";
    groups_ = divided_by(groups_, end);
  }

  // No repeated column differs: one device, or responses without address.
  void guess_address() {
    static constexpr std::uint8_t kStarts[] = {0x02, 0x10, 0x16, 0x3A, 0x55, 0x5A, 0x68,
                                               0x7E, 0xA5, 0xAA, 0xEB, 0xFE, 0xFF};
    for (std::ptrdiff_t column = 0; column < 3; ++column) {
      const auto value = constant_at(in_order_, column);
      if (roles_.command.holds(column) || !value || !echo_of(groups_, column, 0).holds_mostly() ||
          std::ranges::find(kStarts, *value) != std::end(kStarts))
        continue;
      roles_.address = echoed(FieldKind::kAddress, column, column + 1);
      roles_.address.note = "only one device in the capture: a guess";
      return;
    }
  }

  // Digits that differ at the same place of all requests, which no response repeats.
  void guess_text_address() {
    std::ptrdiff_t at = 0, end = 0;
    for (const Group& group : groups_) {
      std::ptrdiff_t first = -1, last = -1;
      for (std::ptrdiff_t i = 0; i + end_size_ < shortest(group.requests); ++i) {
        const bool differs = values_at(group.requests, i).size() > 1;
        if (differs && last >= 0 && i != last + 1) return;  // two numbers
        if (differs) last = i, first = first < 0 ? i : first;
      }
      if (first < 0) continue;
      if (end != 0 && first > end) return;
      at = end == 0 ? first : std::min(at, first);
      end = std::max(end, last + 1);
    }
    if (end == 0) return;
    if (at > 0 && end - at == 1 && are_digits({in_order_.front()}, at - 1, at, 10)) --at;
    if (end - at > 3 || !are_digits(in_order_, at, at + 1, 16)) return;
    roles_.address = echoed(FieldKind::kAddress, at, end);
    roles_.address.echo.reset();
    roles_.address.note = "no response repeats it: a guess";
  }

  void find_command() {
    LearnedField& command = roles_.command;
    if (command.width == 0 && roles_.address.width != 0) guess_command();
    if (command.width == 0) return;
    command.echo.reset();
    // The response repeats it, or a constant is added.
    for (const std::int64_t plus : {0, 0x80, 0x40, 0x20}) {
      if (!echo_of(groups_, command.at, roles_.shift, plus).holds_mostly()) continue;
      command.echo = roles_.shift;
      roles_.command_plus = plus;
      return;
    }
  }

  // A constant of each group behind the address, which the response has with its highest bit or
  // unchanged; in a text two digits that differ between groups.
  void guess_command() {
    const std::ptrdiff_t end = roles_.address.end(), width = roles_.text ? 2 : 1;
    const auto fits = [&](std::ptrdiff_t column, std::int64_t plus) {
      return echo_of(groups_, column, roles_.shift, plus).holds_mostly() &&
             std::ranges::all_of(groups_, [&](const Group& group) {
               return constant_at(group.requests, column).value_or(0) != 0;
             });
    };
    for (const std::int64_t plus : {0x80, 0}) {
      for (std::ptrdiff_t at = end; at < end + (roles_.text ? 1 : 3); ++at) {
        const bool differs = different(in_order_, at, at + width) > 1;
        if (!fits(at, plus)) continue;
        if (roles_.text &&
            (!differs || !fits(at + 1, plus) || !are_digits(in_order_, at, at + 2, 16)))
          continue;
        roles_.command = echoed(FieldKind::kCommand, at, at + width);
        if (roles_.text) roles_.command.word = digits(declared::Notation::kHex, 2);
        if (!differs) roles_.command.note = "always the same: a guess";
        return;
      }
    }
  }

  Grouping out_;
  Groups& groups_;
  Roles& roles_;
  Frames in_order_;  // requests
  std::size_t end_size_ = 0;
  std::set<std::ptrdiff_t> echoes_;  // columns
};

}  // namespace

Evidence echo_of(std::span<const Group> groups, std::ptrdiff_t column, std::ptrdiff_t shift,
                 std::int64_t plus) {
  Evidence echo;
  if (column + shift < 0) return echo;
  for (const Group& group : groups) {
    for (std::size_t i = 0; i < group.requests.size(); ++i) {
      const auto sent = byte_at(group.requests[i], column);
      const auto received = byte_at(group.responses[i], column + shift);
      if (sent && received) echo.add(static_cast<std::uint8_t>(*sent + plus) == *received);
    }
  }
  return echo;
}

Grouping group_exchanges(const std::vector<Exchange>& exchanges) { return Finder(exchanges).run(); }

}  // namespace fieldcast::learn
