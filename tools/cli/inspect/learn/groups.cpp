#include "tools/cli/inspect/learn/groups.hpp"

#include <algorithm>
#include <map>

#include "core/codec/digits.hpp"
#include "tools/cli/inspect/learn/length_rule.hpp"
#include "tools/cli/inspect/learn/proposal.hpp"

namespace fieldcast::learn {
namespace {

constexpr std::ptrdiff_t kMaxShift = 12;
constexpr std::ptrdiff_t kMaxCommandAt = 20;
constexpr std::size_t kMaxCommands = 16;
constexpr std::size_t kMaxTried = 128;  // exchanges of a group when a division is tried

Frames requests_of(const std::vector<Group>& groups) {
  Frames all;
  for (const Group& group : groups)
    all.insert(all.end(), group.requests.begin(), group.requests.end());
  return all;
}
Frames responses_of(const std::vector<Group>& groups) {
  Frames all;
  for (const Group& group : groups)
    all.insert(all.end(), group.responses.begin(), group.responses.end());
  return all;
}

template <typename Key>
std::vector<Group> divided(const Group& whole, const Key& key) {
  std::map<decltype(key(ByteView{})), std::size_t> index;
  std::vector<Group> groups;
  for (std::size_t i = 0; i < whole.requests.size(); ++i) {
    const auto [at, is_new] = index.try_emplace(key(whole.requests[i]), groups.size());
    if (is_new) groups.emplace_back();
    groups[at->second].requests.push_back(whole.requests[i]);
    groups[at->second].responses.push_back(whole.responses[i]);
  }
  return groups;
}

// Letters and marks of a text are its command; digits are its numbers.
std::string skeleton(ByteView request, std::size_t end_size) {
  std::string text(request.begin(), request.end());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (hex_digit(request[i]) >= 0 || i + end_size >= text.size()) text[i] = '0';
  }
  return text;
}

// A letter that differs is a command, if no digit occurs in its column.
std::optional<std::ptrdiff_t> letter_column(const Group& group, std::size_t end_size) {
  for (std::size_t i = 0; i + end_size < shortest(group.requests); ++i) {
    const auto values = values_at(group.requests, static_cast<std::ptrdiff_t>(i));
    if (values.size() > 1 && values.size() <= 6 && group.requests.size() >= 4 &&
        std::ranges::none_of(values, is_decimal_digit))
      return static_cast<std::ptrdiff_t>(i);
  }
  return std::nullopt;
}

// Description length: a group whose responses follow a rule costs little.
std::size_t cost_of(const std::vector<Group>& groups, bool text) {
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

std::vector<Group> divided_by(const std::vector<Group>& groups, std::ptrdiff_t column,
                              std::ptrdiff_t width = 1) {
  std::vector<Group> all;
  for (const Group& group : groups) {
    const auto key = [&](ByteView request) {
      Bytes bytes;
      for (std::ptrdiff_t i = column; i < column + width; ++i)
        bytes.push_back(byte_at(request, i).value_or(0));
      return bytes;
    };
    for (Group& part : divided(group, key)) all.push_back(std::move(part));
  }
  return all;
}

struct Echoed {
  std::ptrdiff_t column = 0;
  Evidence evidence;
};

// Repeated columns that differ within a group.
std::vector<Echoed> echoes_of(const std::vector<Group>& groups, std::ptrdiff_t shift,
                              std::size_t needed) {
  std::vector<Echoed> found;
  for (std::ptrdiff_t column = std::max<std::ptrdiff_t>(0, -shift); column < kMaxHead; ++column) {
    Echoed echoed{column, {}};
    bool differs = false;
    for (const Group& group : groups) {
      const Evidence one = echo_of(group, column, shift);
      echoed.evidence.holds += one.holds;
      echoed.evidence.of += one.of;
      differs = differs || (one.holds_mostly() && values_at(group.requests, column).size() > 1);
    }
    if (differs && echoed.evidence.of * 4 >= needed && echoed.evidence.holds_mostly())
      found.push_back(echoed);
  }
  return found;
}

std::size_t different(const Frames& frames, std::ptrdiff_t at, std::ptrdiff_t end) {
  std::set<Bytes> values;
  for (const ByteView frame : frames) {
    Bytes value;
    for (std::ptrdiff_t i = at; i < end; ++i) value.push_back(byte_at(frame, i).value_or(0));
    values.insert(value);
  }
  return values.size();
}

// Nearly every request has the number of the one before, plus one.
bool is_counter(const Frames& requests, std::ptrdiff_t at) {
  Evidence steps;
  for (std::size_t i = 1; i < requests.size(); ++i) {
    const auto before = byte_at(requests[i - 1], at), now = byte_at(requests[i], at);
    if (!before || !now) continue;
    ++steps.of;
    if (static_cast<std::uint8_t>(*before + 1) == *now) ++steps.holds;
  }
  return steps.of >= 6 && steps.holds * 10 >= steps.of * 8;
}

class Finder {
 public:
  explicit Finder(const std::vector<Exchange>& exchanges) {
    Group whole;
    for (const Exchange& each : exchanges) {
      whole.requests.emplace_back(each.request);
      whole.responses.emplace_back(each.response);
    }
    in_order_ = whole.requests;
    out_.groups = {std::move(whole)};
  }

  Grouping run() {
    Roles& roles = out_.roles;
    const Frames requests = requests_of(out_.groups), responses = responses_of(out_.groups);
    roles.text = is_text(requests) && is_text(responses);
    roles.request_check = find_checksum(requests, roles.text);
    roles.response_check = find_checksum(responses, roles.text);
    if (!roles.request_check && roles.response_check)
      roles.request_check = find_same_checksum(requests, *roles.response_check);
    if (!roles.response_check && roles.request_check)
      roles.response_check = find_same_checksum(responses, *roles.request_check);
    end_size_ = roles.request_check ? roles.request_check->end_size() : 0;
    roles.text ? divide_text() : divide_binary();
    find_echoes();
    find_sequence();
    find_address();
    find_command();
    return std::move(out_);
  }

 private:
  void divide_text() {
    out_.groups = divided(out_.groups.front(),
                          [&](ByteView request) { return skeleton(request, end_size_); });
    for (std::size_t i = 0; i < out_.groups.size() && out_.groups.size() < kMaxGroups; ++i) {
      while (const auto column = letter_column(out_.groups[i], end_size_)) {
        auto parts = divided_by({out_.groups[i]}, *column);
        out_.groups[i] = std::move(parts.front());
        out_.groups.insert(out_.groups.end(), parts.begin() + 1, parts.end());
      }
    }
    divide_by_digits();
  }

  // Two digits that the responses repeat, if the responses then follow a rule.
  void divide_by_digits() {
    std::size_t best = cost_of(out_.groups, true);
    const auto whole = out_.groups;
    const auto is_digit = [&](std::ptrdiff_t column) {
      return std::ranges::all_of(whole, [&](const Group& group) {
        return is_digit_column(group.requests, column) && echo_of(group, column, 0).holds_mostly();
      });
    };
    for (std::ptrdiff_t column = 1; column < kMaxCommandAt && whole.size() < kMaxGroups; ++column) {
      if (!is_digit(column) || !is_digit(column + 1)) continue;
      const auto values = different(in_order_, column, column + 2);
      if (values < 2 || values > kMaxCommands) continue;
      auto parts = divided_by(whole, column, 2);
      const std::size_t cost = cost_of(parts, true);
      if (cost < best) best = cost, out_.groups = std::move(parts);
    }
  }

  void divide_binary() {
    std::size_t best = cost_of(out_.groups, false);
    const auto whole = out_.groups;
    for (std::ptrdiff_t column = 0; column < kMaxCommandAt; ++column) {
      const auto values = values_at(whole.front().requests, column);
      if (values.size() < 2 || values.size() > kMaxCommands) continue;
      auto parts = divided_by(whole, column);
      const std::size_t cost = cost_of(parts, false);
      if (cost >= best) continue;
      best = cost;
      out_.groups = std::move(parts);
      out_.roles.command = {column, 1};
    }
  }

  void find_echoes() {
    for (std::ptrdiff_t i = 0; i <= 2 * kMaxShift; ++i) {
      const std::ptrdiff_t shift = i % 2 == 0 ? i / 2 : -(i + 1) / 2;
      auto found = echoes_of(out_.groups, shift, in_order_.size());
      if (found.size() > echoes_.size()) echoes_ = std::move(found), out_.roles.shift = shift;
    }
  }

  void find_sequence() {
    for (const Echoed& each : echoes_) {
      if (!is_counter(in_order_, each.column)) continue;
      Columns& sequence = out_.roles.sequence;
      sequence = {each.column, 1, true, each.evidence, ""};
      if (is_echoed(each.column - 1) || constant_at(in_order_, each.column - 1) == 0)
        --sequence.at, sequence.width = 2;
      std::erase_if(echoes_, [&](const Echoed& other) { return sequence.holds(other.column); });
      return;
    }
  }

  [[nodiscard]] bool is_echoed(std::ptrdiff_t column) const {
    return std::ranges::find(echoes_, column, &Echoed::column) != echoes_.end();
  }

  void find_address() {
    Roles& roles = out_.roles;
    const auto free = [&](std::ptrdiff_t column) { return !roles.command.holds(column); };
    const auto first =
        std::ranges::find_if(echoes_, [&](const Echoed& each) { return free(each.column); });
    if (first == echoes_.end()) return guess_address();
    std::ptrdiff_t at = first->column, end = at + 1;
    const Frames all = requests_of(out_.groups);
    // The next column belongs to it, unless it makes more combinations than there are devices.
    while (is_echoed(end) && free(end) &&
           (roles.text ? is_digit_column(all, end)
                       : different(all, at, end + 1) == different(all, end, end + 1) ||
                             different(all, at, end + 1) == different(all, at, end)))
      ++end;
    while (roles.text && at > 0 && constant_at(all, at - 1) == '0') --at;
    roles.address = {at, static_cast<std::size_t>(end - at), true, first->evidence, ""};
    if (roles.text || roles.command.width != 0 || !is_echoed(end) ||
        values_at(all, end).size() > kMaxCommands)
      return;
    // Two repeated numbers, which no frame distinguishes: by custom the address is the first.
    roles.command = {end, 1, true, {}, "address and command may be exchanged"};
    out_.groups = divided_by(out_.groups, end);
  }

  static bool is_digit_column(const Frames& frames, std::ptrdiff_t column) {
    return std::ranges::all_of(values_at(frames, column),
                               [](std::uint8_t c) { return hex_digit(c) >= 0; });
  }

  // No repeated column differs: one device, or responses without address.
  void guess_address() {
    static constexpr std::uint8_t kStarts[] = {0x02, 0x10, 0x16, 0x3A, 0x55, 0x5A, 0x68,
                                               0x7E, 0xA5, 0xAA, 0xEB, 0xFE, 0xFF};
    Roles& roles = out_.roles;
    const Frames all = requests_of(out_.groups);
    if (roles.text) return guess_text_address(all);
    for (std::ptrdiff_t column = 0; column < 3; ++column) {
      Evidence echo;
      for (const Group& group : out_.groups) {
        const Evidence one = echo_of(group, column, 0);
        echo.holds += one.holds, echo.of += one.of;
      }
      const auto value = constant_at(all, column);
      if (roles.command.holds(column) || !value || !echo.holds_mostly()) continue;
      if (std::ranges::find(kStarts, *value) != std::end(kStarts)) continue;
      roles.address = {column, 1, true, echo, "only one device in the capture: a guess"};
      return;
    }
  }

  // Digits that differ at the same place of all requests, which no response repeats.
  void guess_text_address(const Frames& all) {
    std::ptrdiff_t at = 0, end = 0;
    for (const Group& group : out_.groups) {
      std::ptrdiff_t first = -1, last = -1;
      const auto most = static_cast<std::ptrdiff_t>(shortest(group.requests) -
                                                    std::min(end_size_, shortest(group.requests)));
      for (std::ptrdiff_t i = 0; i < most; ++i) {
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
    if (at > 0 && is_decimal_digit(byte_at(all.front(), at - 1).value_or(0)) && end - at == 1) --at;
    if (end - at > 3 || !is_digit_column(all, at)) return;
    out_.roles.address = {at,
                          static_cast<std::size_t>(end - at),
                          false,
                          {all.size(), all.size()},
                          "no response repeats it: a guess"};
  }

  void find_command() {
    Roles& roles = out_.roles;
    if (roles.text) return find_text_command();
    if (roles.command.width == 0 && roles.address.width != 0) guess_command();
    if (roles.command.width == 0) return;
    // The response repeats it, or a constant is added.
    for (const std::int64_t plus : {0, 0x80, 0x40, 0x20}) {
      Evidence echo;
      for (const Group& group : out_.groups) {
        const Evidence one = echo_of(group, roles.command.at, roles.shift, plus);
        echo.holds += one.holds, echo.of += one.of;
      }
      if (!echo.holds_mostly() || roles.command.at + roles.shift < 0) continue;
      roles.command.echoed = true;
      roles.command.evidence = echo;
      roles.command_plus = plus;
      return;
    }
  }

  // A constant behind the address, which the response has with its highest bit or unchanged.
  void guess_command() {
    Roles& roles = out_.roles;
    const auto end = roles.address.at + static_cast<std::ptrdiff_t>(roles.address.width);
    for (const std::int64_t plus : {0x80, 0}) {
      for (std::ptrdiff_t column = end; column < end + 3; ++column) {
        const auto value = constant_at(requests_of(out_.groups), column);
        if (!value || *value == 0 ||
            !echo_of(out_.groups.front(), column, roles.shift, plus).holds_mostly())
          continue;
        roles.command = {column, 1, true, {}, "always the same: a guess"};
        return;
      }
    }
  }

  // Two digits behind the address that differ between groups.
  void find_text_command() {
    Roles& roles = out_.roles;
    if (roles.address.width == 0) return;
    const auto end = roles.address.at + static_cast<std::ptrdiff_t>(roles.address.width);
    Evidence echo;
    for (const Group& group : out_.groups) {
      for (const std::ptrdiff_t column : {end, end + 1}) {
        if (!constant_at(group.requests, column) || !is_digit_column(group.requests, column))
          return;
        const Evidence one = echo_of(group, column, roles.shift);
        echo.holds += one.holds, echo.of += one.of;
      }
    }
    if (!echo.holds_mostly() || different(in_order_, end, end + 2) < 2) return;
    roles.command = {end, 2, true, {echo.holds / 2, echo.of / 2}, ""};
  }

  Grouping out_;
  Frames in_order_;
  std::size_t end_size_ = 0;
  std::vector<Echoed> echoes_;
};

}  // namespace

Evidence echo_of(const Group& group, std::ptrdiff_t column, std::ptrdiff_t shift,
                 std::int64_t plus) {
  Evidence echo;
  for (std::size_t i = 0; i < group.requests.size() && column + shift >= 0; ++i) {
    const auto sent = byte_at(group.requests[i], column);
    const auto received = byte_at(group.responses[i], column + shift);
    if (!sent || !received) continue;
    ++echo.of;
    if (static_cast<std::uint8_t>(*sent + plus) == *received) ++echo.holds;
  }
  return echo;
}

Grouping group_exchanges(const std::vector<Exchange>& exchanges) { return Finder(exchanges).run(); }

}  // namespace fieldcast::learn
