#include "tools/cli/inspect/learn/operation_fields.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/cli/inspect/learn/frame_fields.hpp"

namespace fieldcast::learn {
namespace {

using declared::FieldKind;
using declared::Notation;

constexpr std::size_t kNeededPacked = 16;  // different bytes
constexpr std::uint64_t kMaxItem = 0xFE00'0000;
constexpr std::uint64_t kMaxAreaItems = 1 << 24;  // of an area
const char* const kUnknown = "differs, unknown";

const LearnedField* find(const std::vector<LearnedField>& fields, FieldKind kind) {
  const auto found = std::ranges::find(fields, kind, &LearnedField::kind);
  return found == fields.end() ? nullptr : &*found;
}

class OperationBuilder {
 public:
  OperationBuilder(const Group& group, const Roles& roles, const Known& known, unsigned& values)
      : group_(group),
        roles_(roles),
        known_(known),
        text_(roles.text),
        values_(values),
        request_(group.requests, roles.request_check, text_),
        response_(group.responses, roles.response_check, text_) {
    out_.exchanges = group.requests.size();
  }

  LearnedOperation run() {
    if (!group_.requests.front().empty()) build_request();
    if (out_.refusal.empty()) build_response();
    set_area();
    for (auto* fields : {&out_.request, &out_.response}) {
      if (fields->size() > declared::kMaxFields) refuse("more fields than a frame can have");
    }
    if (out_.request.empty() && find(out_.response, FieldKind::kValue) == nullptr)
      refuse("no value differs");
    return std::move(out_);
  }

 private:
  void refuse(std::string reason) {
    if (out_.refusal.empty()) out_.refusal = std::move(reason);
  }
  [[nodiscard]] Evidence all() const { return {out_.exchanges, out_.exchanges}; }

  void build_request() {
    add_role(request_, roles_.address);
    const auto command = number_at(group_.requests.front(), roles_.command.at, roles_.command.word);
    if (command && add_role(request_, roles_.command, roles_.command_plus)) out_.command = command;
    add_role(request_, roles_.sequence);
    find_lengths();
    add_request_lengths();
    add_count();
    if (shortest(group_.requests) != longest(group_.requests))
      return refuse("requests have different lengths: a write, or several operations");
    add_first();
    request_.fill(FieldKind::kUnused, kUnknown);
    out_.request = request_.finish(values_);
  }

  // `plus`: of the response.
  bool add_role(FrameFields& fields, LearnedField field, std::int64_t plus = 0) const {
    field.evidence = field.echo ? echo_of({&group_, 1}, field.at, *field.echo, plus) : all();
    if (&fields == &response_) field.at += *field.echo, field.plus = plus;
    return fields.add(field);
  }

  void find_lengths() {
    lengths_ = find_length_fields(group_.responses, text_);
    for (const LengthRule& each : known_.lengths) {
      if (!lengths_.empty() || !fits_all(each, group_.responses)) continue;
      lengths_.push_back(each);
      lengths_.back().evidence = all();
    }
    // Responses of one length: a byte that is the number of bytes up to the end.
    const std::size_t end_size = response_.end_size();
    if (text_ || !response_.check() || shortest(group_.responses) != longest(group_.responses))
      return;
    for (std::ptrdiff_t at = 0; lengths_.empty() && at + 1 < std::min(response_.limit(), kMaxHead);
         ++at) {
      LengthRule guess{.at = at, .word = binary(1), .times = 1};
      guess.base = static_cast<std::size_t>(at) + 1 + end_size;
      guess.evidence = all();
      guess.note = "always the same: a guess";
      if (fits_all(guess, group_.responses)) lengths_.push_back(guess);
    }
  }
  static bool fits_all(const LengthRule& length, const Frames& frames) {
    return std::ranges::all_of(frames, [&](ByteView frame) { return length.fits(frame, frame); });
  }

  // A request of constant length counts in the same way as the responses.
  void add_request_lengths() {
    for (LengthRule own : lengths_) {
      own.at -= roles_.shift;
      own.base +=
          request_.end_size() - response_.end_size() - static_cast<std::size_t>(roles_.shift);
      if (own.at < 0 || !fits_all(own, group_.requests)) continue;
      own.evidence = all();
      add_length(request_, own);
    }
  }

  static void add_length(FrameFields& fields, const LengthRule& length) {
    LearnedField made{.kind = FieldKind::kLength, .at = length.at, .word = length.word};
    made.width = length.word.characters;
    made.evidence = length.evidence;
    made.note = length.note;
    made.pairs = length.times == 2;
    if (made.word.notation != Notation::kBinary && !made.pairs)
      made.options = ", counts: characters";
    // Characters behind the field that it does not count, and characters of the end that it does.
    const auto skipped = static_cast<std::ptrdiff_t>(length.base) - made.end() -
                         static_cast<std::ptrdiff_t>(fields.end_size());
    if (skipped < 0) made.plus = -skipped / static_cast<std::ptrdiff_t>(length.times);
    made.from = made.end() + std::max<std::ptrdiff_t>(0, skipped);
    fields.add(made);
  }

  void add_count() {
    const auto free = [&](std::size_t at, std::size_t width) {
      return request_.is_free(static_cast<std::ptrdiff_t>(at), width);
    };
    rule_ = find_length_rule(group_.requests, group_.responses, text_, free,
                             known_.rule ? &*known_.rule : nullptr);
    out_.rule = rule_;
    if (!rule_ || rule_->at < 0) return;
    LearnedField made{.kind = rule_->is_last ? FieldKind::kFirst : FieldKind::kCount,
                      .at = rule_->at,
                      .width = rule_->word.characters,
                      .word = rule_->word};
    made.evidence = rule_->evidence;
    if (!rule_->is_last && made.word.notation == Notation::kDecimal && made.width > 1 &&
        rule_->highest < 10)
      made.note = "never above 9: perhaps hexadecimal";
    if (!rule_->is_last) widen(made);
    request_.add(made);
    if (!rule_->is_last) return;
    made.kind = FieldKind::kLast;
    made.at = made.end();
    request_.add(made);
  }

  // Zeros before a number belong to it.
  void widen(LearnedField& number) const {
    const auto is_zero = [&](std::ptrdiff_t at) {
      return request_.is_free(at, 1) && constant_at(group_.requests, at) == (text_ ? '0' : 0);
    };
    if (text_) {
      while (number.width < 8 && is_zero(number.at - 1)) --number.at, ++number.width;
      number.word.characters = static_cast<std::uint8_t>(number.width);
      return;
    }
    const bool before = is_zero(number.at - 1);
    if (number.width != 1 || (!before && !is_zero(number.end()))) return;
    if (before) --number.at;
    number.width = 2, number.word = binary(2);
    number.note =
        fmt::format("the zero {} it may be a field of its own", before ? "before" : "behind");
  }

  // The first run of other columns that differ.
  void add_first() {
    if (rule_ && rule_->is_last) return;
    const auto free = [&](std::ptrdiff_t column) { return request_.is_free(column, 1); };
    const auto differs = [&](std::ptrdiff_t column) {
      return free(column) && !constant_at(group_.requests, column);
    };
    LearnedField made{.kind = FieldKind::kFirst};
    std::ptrdiff_t& at = made.at;
    while (at < request_.limit() && !differs(at)) ++at;
    if (at == request_.limit()) return;
    std::ptrdiff_t last = at + 1;
    while (differs(last)) ++last;
    const auto repeated = [&](std::ptrdiff_t column) {
      return echo_of({&group_, 1}, column, roles_.shift).holds_mostly();
    };
    std::ptrdiff_t run = at;
    while (run < last && repeated(run)) ++run;
    if (run == last) made.echo = roles_.shift;
    const auto is_echo = [&](std::ptrdiff_t column) {
      return made.echo && free(column) && repeated(column);
    };
    const auto is_digit = [&](std::ptrdiff_t column) {
      return text_ && free(column) && are_digits(group_.requests, column, column + 1, 10);
    };
    // Without a command, digits before it may be a part of the command.
    const auto begins = [&](std::ptrdiff_t column) {
      return is_digit(column) &&
             (roles_.command.width != 0 || constant_at(group_.requests, column) == '0');
    };
    while (is_echo(at - 1) || begins(at - 1)) --at;
    while (is_echo(last) || is_digit(last)) ++last;
    made.width = static_cast<std::size_t>(std::min<std::ptrdiff_t>(last - at, 8));
    made.word = word_at(group_.requests, at, made.width, text_);
    if (!text_) choose_order(made);
    made.evidence = all();
    if (!made.echo && made.note.empty()) made.note = "no response repeats it: a guess";
    request_.add(made);
  }

  void choose_order(LearnedField& made) const {
    if (made.width == 1) widen(made);
    made.word.little_endian =
        made.width > 1 && values_at(group_.requests, made.at).size() >
                              values_at(group_.requests, made.end() - 1).size();
    if (made.word.little_endian) made.note = "byte order by the byte that differs most: a guess";
  }

  // The items that the request can name. Beyond the first 65536 the area begins near them.
  void set_area() {
    const LearnedField* first = find(out_.request, FieldKind::kFirst);
    if (first == nullptr) return;
    const declared::ByteTransform transform{first->add, 0};
    std::uint64_t lowest = UINT64_MAX, highest = 0;
    for (const ByteView request : group_.requests) {
      const auto number = number_at(transform.meant(request), first->at, first->word);
      if (number) lowest = std::min(lowest, *number), highest = std::max(highest, *number);
    }
    if (highest > kMaxItem) refuse("the numbers of items are too large");
    out_.origin = highest > UINT16_MAX ? lowest & ~std::uint64_t{0xFFFF} : 0;
    const std::uint64_t items =
        out_.origin == 0 ? 65536 : std::min(highest - out_.origin + 65536, kMaxAreaItems);
    out_.items = std::min(items - 1, declared::largest(first->word) - out_.origin) + 1;
    for (auto* fields : {&out_.request, &out_.response}) {
      for (LearnedField& each : *fields) {
        const bool item = each.kind == FieldKind::kFirst || each.kind == FieldKind::kLast;
        if (item && out_.origin != 0) each.options = ", plus: origin";
      }
    }
  }

  void build_response() {
    const LearnedField* first = find(out_.request, FieldKind::kFirst);
    const bool counted = rule_ && rule_->at >= 0;
    if (counted)
      response_.set_limit(static_cast<std::ptrdiff_t>(rule_->base) -
                          static_cast<std::ptrdiff_t>(response_.end_size()));
    if (response_.limit() < 0) return refuse("the responses are shorter than their end");
    add_echo(&roles_.address);
    if (out_.command) add_echo(&roles_.command, roles_.command_plus);
    add_echo(&roles_.sequence);
    add_echo(first);
    for (const LengthRule& each : lengths_) add_length(response_, each);
    if (counted && first == nullptr)
      return refuse("all requests begin at the same item: read other items too");
    if (first != nullptr)
      counted ? add_counted_items() : add_items();
    else
      text_ ? add_text_values() : add_values();
    if (out_.refusal.empty()) out_.response = response_.finish(values_);
    // The item has the same transform as the items.
    for (auto* fields : {&out_.request, &out_.response}) {
      for (LearnedField& each : *fields) {
        if (each.kind == FieldKind::kFirst && each.echo) each.add = add_;
      }
    }
  }

  void add_echo(const LearnedField* field, std::int64_t plus = 0) {
    if (field != nullptr && field->echo) add_role(response_, *field, plus);
  }

  void add_counted_items() {
    out_.lowest_count = rule_->lowest;
    out_.highest_count = rule_->highest;
    LearnedField items{.kind = FieldKind::kItems, .evidence = rule_->evidence};
    set_items(items, rule_->times, rule_->shared);
  }

  // Everything behind the known fields.
  void add_items() {
    if (shortest(group_.responses) != longest(group_.responses))
      return refuse("responses have different lengths, and no field of the request decides them");
    const std::ptrdiff_t head = std::min(response_.used(), response_.limit());
    const auto size = static_cast<std::size_t>(response_.limit() - head);
    const std::size_t byte = text_ ? 2 : 1;
    if (size == 0) return refuse("the responses have no items: a write");
    if (size % byte != 0) return refuse("the items of the responses are not pairs of digits");
    const auto values = values_in(group_.responses, head, response_.limit());
    const auto adds = packed_adds(values);
    LearnedField items{.kind = FieldKind::kItems, .evidence = all()};
    items.note = "always of one length: items and their number are a guess";
    const bool packed = !text_ && adds.size() == 1 && values.size() >= kNeededPacked;
    if (packed) items.note = "only decimal digits; the byte order is a guess";
    const bool one = size == byte || size == 2 * byte || size == 4 * byte || size == 8 * byte;
    out_.lowest_count = out_.highest_count = one ? 1 : size / byte;
    if (packed) items.add = add_ = *adds.begin();
    response_.set_limit(head);
    set_items(items, static_cast<unsigned>(one ? size : byte), 1,
              packed ? Notation::kBcd : Notation::kBinary);
  }

  void set_items(LearnedField& items, unsigned times, unsigned shared,
                 Notation notation = Notation::kBinary) {
    out_.item_bits = shared > 1 || (text_ && times % 2 != 0) ? 1 : times * (text_ ? 4 : 8);
    items.word = {notation, static_cast<std::uint8_t>(times)};
    if (text_ && (times == 5 || times == 6)) {
      items.word.notation = Notation::kDecimal;
      out_.item_bits = 16;
    } else if (text_) {
      items.word.notation = Notation::kHex;
      items.options = times == 1 ? ", as: hex, digits: 1, on: 1, off: 0" : ", as: hex";
    }
    if (out_.item_bits == 0 || out_.item_bits > 64) refuse("items of this width");
    items.at = response_.limit();
    response_.fill(FieldKind::kUnused, kUnknown);
    response_.append(items);
  }

  void add_text_values() {
    const auto used = static_cast<std::size_t>(response_.used());
    const auto values = text_values(group_.responses, used, response_.end_size());
    if (values.empty() && shortest(group_.responses) != longest(group_.responses))
      return refuse("the responses have no common form");
    if (!values.empty()) response_.set_limit(static_cast<std::ptrdiff_t>(used));
    if (!values.empty() && values.back().variable && !response_.ends_with_constant())
      return refuse("nothing shows where the responses end");
    response_.fill(FieldKind::kValue, "");
    for (const LearnedField& each : values) response_.append(each);
  }

  void add_values() {
    const std::size_t longest_one = longest(group_.responses);
    if (shortest(group_.responses) == longest_one) return response_.fill(FieldKind::kValue, "");
    if (lengths_.empty())
      return refuse("responses have different lengths, and no field decides them");
    std::ptrdiff_t at = response_.used();
    while (at < response_.limit() && constant_at(group_.responses, at)) ++at;
    response_.set_limit(at);
    response_.fill(FieldKind::kUnused, kUnknown);
    LearnedField text{.kind = FieldKind::kValue, .at = at, .evidence = all(), .variable = true};
    text.options = fmt::format(", text: {}, variable: true",
                               longest_one - response_.end_size() - static_cast<std::size_t>(at));
    text.note = "of different lengths: divide it into values, or into records with a key";
    response_.append(text);
  }

  const Group& group_;
  const Roles& roles_;
  const Known& known_;
  const bool text_;
  unsigned& values_;
  LearnedOperation out_;
  FrameFields request_, response_;
  std::vector<LengthRule> lengths_;  // of responses
  std::optional<LengthRule> rule_;
  std::uint8_t add_ = 0;  // to each byte of items
};

}  // namespace

LearnedOperation fields_of(const Group& group, const Roles& roles, const Known& known,
                           unsigned& values) {
  return OperationBuilder(group, roles, known, values).run();
}

}  // namespace fieldcast::learn
