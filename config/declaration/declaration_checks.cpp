// Checks a declaration for contradictions. Each rule adds its fault where the text must change.
#include <fmt/format.h>

#include <algorithm>

#include "config/declaration/declared_frame.hpp"
#include "core/protocol/declared/frame.hpp"

namespace fieldcast::config {
namespace {

using declared::Declaration;
using declared::DeclaredArea;
using declared::Field;
using declared::FieldKind;

class OperationCheck {
 public:
  OperationCheck(const Declaration& declaration, const DraftOperation& draft, FaultList& faults)
      : declaration_(declaration),
        draft_(draft),
        operation_(draft.operation),
        area_(declaration.areas[draft.operation.area]),
        faults_(faults) {}

  void run() {
    check_frame(draft_.request);
    check_frame(draft_.response);
    check_payload();
    check_addressing();
    check_variable(draft_.response);
    check_blocks();
    check_unsolicited();
    check_no_response();
    check_rate();
    for (const auto& draft : draft_.request.fields) {
      if (draft.field.variable && draft.field.kind != FieldKind::kAddress)
        faults_.add(draft.position,
                    draft.field.text.empty() ? "a variable text in a request"
                                             : "an optional constant in a request",
                    "a fixed one: requests have one length");
    }
  }

 private:
  void needs(bool there, const Position& position, const std::string& what,
             const std::string& allowed) {
    if (!there) faults_.add(position, what, allowed);
  }

  void check_frame(const DraftFrame& frame) {
    for (const DraftField& draft : frame.fields) {
      // Otherwise a fault was already added, and the width of a shared word may be unknown.
      if (draft.fits && (frame.good || !draft.shares)) check_field(frame, draft);
    }
    if (!frame.good) return;
    const auto whole = declared::size_of(frame.frame(), area_.item_bits, operation_.max_count);
    if (whole > declared::kMaxFrame)
      faults_.add(draft_.count_position, fmt::format("a frame of {} characters is too long", whole),
                  fmt::format("at most {}", declared::kMaxFrame));
  }

  void check_field(const DraftFrame& frame, const DraftField& draft) {
    const Field& field = draft.field;
    const std::uint64_t last = area_.items == 0 ? 0 : area_.items - 1, count = operation_.max_count;
    switch (field.kind) {
      case FieldKind::kAddress: check_address(draft); break;
      case FieldKind::kCommand:
        needs(draft_.has_command, draft.position,
              fmt::format("the operation '{}' has no command", operation_.name),
              "command: a number, in the operation");
        check_numbers(draft, operation_.command, operation_.command, "the command");
        break;
      case FieldKind::kFirst:
      case FieldKind::kLast: check_numbers(draft, 0, last * field.times, "the last item"); break;
      case FieldKind::kCount:
        check_numbers(draft, operation_.min_count * std::uint64_t{field.times}, count * field.times,
                      "the count");
        break;
      case FieldKind::kLength: check_length(frame, draft); break;
      case FieldKind::kItems: check_items(draft); break;
      case FieldKind::kValue:
        needs(area_.record, draft.position,
              fmt::format("'{}' is no record and has no values", area_.name),
              "is: items, or record: true in the area");
        break;
      case FieldKind::kRate:
        needs(&frame == &draft_.request, draft.position, "a response names its own baud rate",
              "in the response of a round before the request, and in the request");
        break;
      default: break;
    }
  }

  void check_address(const DraftField& draft) {
    const std::uint16_t characters = declaration_.address_characters;
    if (characters == 0 && draft.field.text_size == 0)
      return check_numbers(draft, declaration_.lowest_address, declaration_.highest_address,
                           "the address");
    if (draft.field.text_size != characters)
      faults_.add(draft.position,
                  fmt::format("'{}' is {}, the addresses of devices are {}", draft.field.name,
                              characters == 0 ? "a text" : "another width",
                              characters == 0 ? "numbers" : "texts"),
                  characters == 0 ? "no 'text' here, or addresses: { text: 16 }"
                                  : fmt::format("text: {}", characters));
  }

  void check_numbers(const DraftField& draft, std::uint64_t lowest, std::uint64_t highest,
                     const std::string& what) {
    const Field& field = draft.field;
    const auto largest = std::min(declared::largest(field.word), UINT64_MAX >> (64 - field.bits));
    const bool below = field.plus < 0 && lowest < static_cast<std::uint64_t>(-field.plus);
    const std::uint64_t reached = highest + static_cast<std::uint64_t>(field.plus);
    if (!below && reached <= largest) return;
    faults_.add(draft.position,
                fmt::format("'{}' is too narrow: {} {}", field.name, what,
                            below ? "falls below 0" : fmt::format("reaches {}", reached)),
                fmt::format("0 to {}, or a wider field", largest));
  }

  void check_items(const DraftField& draft) {
    const Field& field = draft.field;
    needs(!area_.record, draft.position,
          fmt::format("'{}' is a record and has no items", area_.name),
          "is: value, for each of its values");
    if (area_.item_bits > 1 && field.word.notation == declared::Notation::kDecimal &&
        declared::largest(field.word) < UINT64_MAX >> (64 - area_.item_bits))
      faults_.add(
          draft.position,
          fmt::format("'{}' is too narrow for items of {} bits", field.name, area_.item_bits),
          "more digits");
  }

  void check_length(const DraftFrame& frame, const DraftField& draft) {
    if (!frame.good) return;
    std::uint64_t longest = 0;
    const auto fields = frame.frame();
    for (std::size_t i = draft.field.of.from; i <= draft.field.of.to; ++i) {
      const Field& counted = fields.fields[i];
      const auto size = declared::size_of(fields, i, i + 1, area_.item_bits, operation_.max_count);
      if (counted.word.variable || !counted.separator.empty())
        faults_.add(draft.of_position,
                    fmt::format("a length counts '{}', which has separators or a variable width",
                                counted.name),
                    "fields of fixed width");
      if (draft.field.counts == declared::Counts::kItems && counted.kind != FieldKind::kItems)
        faults_.add(draft.of_position, "a length in items counts a field without items",
                    "of: the field that is: items");
      longest += draft.field.counts == declared::Counts::kItems
                     ? operation_.max_count
                     : declared::counted(counted, draft.field, size, area_.item_bits);
    }
    check_numbers(draft, longest, longest, "the length");
  }

  static std::size_t number_of(const DraftFrame& frame, FieldKind kind) {
    return static_cast<std::size_t>(std::ranges::count_if(
        frame.fields, [&](const DraftField& draft) { return draft.field.kind == kind; }));
  }

  // The response must contain the read items, the request the written ones.
  void check_payload() {
    if (area_.trigger) return check_trigger();
    const auto kind = area_.record ? FieldKind::kValue : FieldKind::kItems;
    const std::string wanted = area_.record ? "is: value" : "is: items";
    const DraftFrame& carrier = operation_.write ? draft_.request : draft_.response;
    if (!carrier.good) return;
    const std::string where = operation_.write ? "the request of a write carries no "
                                               : "the response of a read carries no ";
    needs(number_of(carrier, kind) > 0, carrier.position,
          where + (area_.record ? "values" : "items"), "a field that " + wanted);
    for (const auto* frame : {&draft_.request, &draft_.response}) {
      if (number_of(*frame, FieldKind::kItems) > 1)
        faults_.add(frame->position, "items stand twice in one frame", "one field that is: items");
    }
    if (!operation_.write && draft_.request.find(FieldKind::kItems) != nullptr)
      faults_.add(draft_.request.find(FieldKind::kItems)->position,
                  "the request of a read carries items", "is: count, is: first");
    if (!operation_.write && draft_.request.find(FieldKind::kValue) != nullptr)
      faults_.add(draft_.request.find(FieldKind::kValue)->position,
                  "the request of a read carries a value", "a constant, or is: unused");
  }

  void check_trigger() {
    if (!operation_.write)
      faults_.add(draft_.position, fmt::format("the trigger '{}' is read", area_.name),
                  "write: " + area_.name);
    for (const auto* frame : {&draft_.request, &draft_.response}) {
      if (const DraftField* items = frame->find(FieldKind::kItems))
        faults_.add(items->position, "a trigger has no items", "constant, address, command, ...");
    }
  }

  // The request must contain the items' address and, if it varies, their count.
  void check_addressing() {
    if (area_.record || !draft_.request.good || operation_.unsolicited > Duration::zero()) return;
    needs(area_.items == 1 || draft_.request.find(FieldKind::kFirst) != nullptr,
          draft_.request.position,
          fmt::format("the request does not say which of {} items it means", area_.items),
          "a field that is: first");
    if (operation_.min_count == operation_.max_count) return;
    const bool counted = draft_.request.find(FieldKind::kCount) != nullptr ||
                         draft_.request.find(FieldKind::kLast) != nullptr ||
                         draft_.request.find(FieldKind::kLength) != nullptr;
    needs(counted, draft_.request.position, "the request does not say how many items it means",
          "a field that is: count or last, or no 'count' in the operation");
  }

  // A block needs an end, and is only read.
  void check_blocks() {
    for (const DraftField& draft : draft_.request.fields) {
      if (!draft.field.key.empty())
        faults_.add(draft.position, "a value with a key in a request", "a value without a key");
    }
    const declared::Frame frame = draft_.response.frame();
    for (std::size_t i = 0; i < frame.fields.size(); ++i) {
      if (!declared::opens_block(frame, i)) continue;
      const std::size_t end = declared::block_end(frame, i);
      if (frame.block != declared::Block::kRecords) check_tags(frame, i, end);
      const bool measured = std::any_of(
          frame.fields.begin(), frame.fields.begin() + static_cast<std::ptrdiff_t>(i),
          [&](const Field& each) { return each.kind == FieldKind::kLength && each.of.holds(i); });
      needs(measured ||
                (end < frame.fields.size() && frame.fields[end].kind == FieldKind::kConstant &&
                 !draft_.response.fields[end].shares),
            draft_.response.fields[i].position,
            fmt::format("no length or mark shows where the block from '{}' on ends",
                        frame.fields[i].name),
            "a constant behind it, or a length of it before it");
    }
  }

  // Each tag must show which field it is.
  void check_tags(const declared::Frame& frame, std::size_t from, std::size_t end) {
    const bool counted = frame.block == declared::Block::kTagLengthValue;
    for (std::size_t i = from + 1; i < end; ++i) {
      const Field& field = frame.fields[i];
      for (std::size_t earlier = from; earlier < i; ++earlier) {
        const Field& other = frame.fields[earlier];
        if (!field.key.starts_with(other.key) && !other.key.starts_with(field.key)) continue;
        faults_.add(draft_.response.fields[i].position,
                    fmt::format("the tag of '{}' cannot be distinguished from that of '{}'",
                                field.name, other.name),
                    "tags with different beginnings");
        return;
      }
      needs(!counted || field.key.size() == frame.fields[from].key.size(),
            draft_.response.fields[i].position,
            fmt::format("the tag of '{}' has another size than that of '{}'", field.name,
                        frame.fields[from].name),
            "tags of one size before a length");
    }
  }

  void check_unsolicited() {
    if (operation_.unsolicited == Duration::zero() || !draft_.response.good) return;
    needs(area_.record && !operation_.write, draft_.position,
          fmt::format("'{}' is sent without a request and does not read a record", operation_.name),
          "read: a record");
    if (const DraftField* sequence = draft_.response.find(FieldKind::kSequence))
      faults_.add(sequence->position, "a frame without a request repeats no sequence number",
                  "is: unused");
    const Field& last = draft_.response.fields.back().field;
    needs(draft_.response.find(FieldKind::kChecksum) != nullptr ||
              (last.kind == FieldKind::kConstant && !last.variable &&
               !draft_.response.fields.back().shares),
          draft_.response.position,
          fmt::format("nothing shows where the frame of '{}' begins", operation_.name),
          "a checksum, or a constant at its end, behind which the next frame begins");
  }

  // Only reading back shows whether such a write took effect.
  void check_no_response() {
    if (operation_.no_response == Duration::zero()) return;
    needs(operation_.write && !area_.trigger, draft_.position,
          fmt::format("'{}' has no response, and is no write whose effect can be read",
                      operation_.name),
          area_.trigger ? "no 'no-response', or a write to an area that is read"
                        : "write: an area that another operation reads");
  }

  // A round before the request names the rate, and the request repeats its code.
  void check_rate() {
    if (!draft_.request.good) return;
    std::size_t named = 0;
    for (const declared::Operation& round : operation_.before)
      named += static_cast<std::size_t>(
          std::ranges::count(round.response.fields, FieldKind::kRate, &Field::kind));
    const std::size_t repeated = number_of(draft_.request, FieldKind::kRate);
    const DraftField* rate = draft_.request.find(FieldKind::kRate);
    if (named > 1 || named != repeated)
      faults_.add(
          rate == nullptr ? draft_.request.position : rate->position,
          fmt::format("a baud rate is named {} times and repeated {} times", named, repeated),
          "one field that is: rate in the rounds before the request, and one in the request");
    else if (rate != nullptr && !rate->field.rates.empty())
      faults_.add(rate->position, "the request names baud rates",
                  "is: rate alone, which repeats the code");
  }

  // A text of variable length must end at a constant, or a length field must precede it.
  void check_variable(const DraftFrame& frame) {
    for (std::size_t i = 0; i < frame.fields.size(); ++i) {
      const Field& field = frame.fields[i].field;
      if (!field.variable || !field.text.empty() || !frame.fields[i].fits) continue;
      const bool measured =
          std::any_of(frame.fields.begin(), frame.fields.begin() + static_cast<std::ptrdiff_t>(i),
                      [&](const DraftField& other) {
                        return other.field.kind == FieldKind::kLength && other.field.of.holds(i);
                      });
      const bool ended = declared::mark_behind(frame.frame(), i).has_value();
      needs(measured || ended, frame.fields[i].position,
            fmt::format("no length or mark shows where '{}' ends", field.name),
            "a constant behind it, or a length of it before it");
      if (measured && std::ranges::count_if(frame.fields, [](const DraftField& each) {
                        return each.field.variable && each.field.text.empty();
                      }) > 1)
        faults_.add(frame.fields[i].position, "two variable texts in a frame with a length of one",
                    "a constant behind each, and no length");
    }
  }

  const Declaration& declaration_;
  const DraftOperation& draft_;
  const declared::Operation& operation_;
  const DeclaredArea& area_;
  FaultList& faults_;
};

}  // namespace

void check_operation(const Declaration& declaration, const DraftOperation& draft,
                     FaultList& faults) {
  if (!draft.good) return;
  OperationCheck(declaration, draft, faults).run();
  check_forms(draft, declaration.areas[draft.operation.area], faults);
  for (const DraftFrame& other : draft.others) {
    DraftOperation form = draft;
    form.response = other;
    OperationCheck(declaration, form, faults).run();
  }
}

namespace {

// What distinguishes the request on the wire. Empty if it depends on an item or a value.
std::vector<Field> fixed_request(const declared::Frame& request, std::uint64_t command) {
  std::vector<Field> fields = request.fields;
  for (Field& field : fields) {
    field.name.clear();
    switch (field.kind) {
      case FieldKind::kCommand:
        field.number = command + static_cast<std::uint64_t>(field.plus);
        field.plus = 0;
        field.kind = FieldKind::kConstant;
        break;
      case FieldKind::kFirst:
      case FieldKind::kCount:
      case FieldKind::kLast:
      case FieldKind::kItems:
      case FieldKind::kValue: return {};
      default: break;
    }
  }
  return fields;
}

}  // namespace

void check_requests(const std::vector<DraftOperation>& operations,
                    const std::vector<declared::Operation>& login, FaultList& faults) {
  std::vector<std::pair<std::string, std::vector<declared::Field>>> known;
  for (const declared::Operation& round : login)
    known.emplace_back("a round of the login", fixed_request(round.request, round.command));
  for (const DraftOperation& draft : operations) {
    if (!draft.good || !draft.request.good) continue;
    auto fields = fixed_request(draft.request.frame(), draft.operation.command);
    if (fields.empty()) continue;
    const auto same =
        std::ranges::find(known, fields, [](const auto& each) { return each.second; });
    if (same != known.end())
      faults.add(draft.request.position, "its bytes are those of " + same->first,
                 "a request of its own");
    known.emplace_back(fmt::format("operation '{}'", draft.operation.name), std::move(fields));
  }
}

}  // namespace fieldcast::config
