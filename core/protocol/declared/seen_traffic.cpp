#include <algorithm>

#include "core/protocol/declared/declaration.hpp"
#include "core/protocol/declared/frame.hpp"
#include "core/protocol/field_writer.hpp"
#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::declared {

namespace {

struct Reading {
  std::vector<FrameField> fields;
  std::size_t faults = 0;
};

class Reader {
 public:
  Reader(const Declaration& declaration, const Frame& frame, ByteView bytes, std::uint64_t command,
         unsigned item_bits)
      : declaration_(declaration), frame_(frame), bytes_(bytes), item_bits_(item_bits) {
    context_.command = command;
  }

  Reading run(const std::string& title, bool refusal) {
    writer_.remark(title);
    const std::size_t offset = size_of(frame_, 0, frame_.escaped.from, item_bits_, 0);
    if (frame_.escape != Escape::kNone && offset <= bytes_.size() &&
        unescape_from(frame_, offset, bytes_, plain_))
      bytes_ = plain_;
    context_.refusal = refusal;
    const std::size_t fixed = size_of(frame_, item_bits_, 0) - variable();
    elastic_ = bytes_.size() > fixed ? bytes_.size() - fixed : 0;
    place();
    for (std::size_t i = 0; i < frame_.fields.size(); ++i) show(frame_.fields[i], i);
    if (offset_ < bytes_.size())
      add(offset_, bytes_.size() - offset_, "rest", "", "bytes behind the end of the frame");
    return {writer_.take(), faults_};
  }

 private:
  std::size_t variable() const {
    std::size_t size = 0;
    for (const Field& field : frame_.fields) {
      if (field.variable) size += field.text.empty() ? field.text_size : field.text.size();
    }
    return size;
  }
  // A block extends to the constant behind it, or has a length before it.
  std::size_t block_size(std::size_t index, std::size_t at) const {
    const std::size_t end = block_end(frame_, index);
    std::size_t behind = 0;
    for (std::size_t i = end; i < frame_.fields.size(); ++i) behind += width(i, bytes_.size());
    if (at >= bytes_.size()) return 0;
    if (end < frame_.fields.size() && frame_.fields[end].kind == FieldKind::kConstant) {
      const Bytes mark = constant_characters(frame_.fields[end]);
      const auto rest = bytes_.subspan(at);
      const auto found = std::search(rest.begin(), rest.end(), mark.begin(), mark.end());
      if (found != rest.end()) return static_cast<std::size_t>(found - rest.begin());
    }
    return bytes_.size() - at > behind ? bytes_.size() - at - behind : 0;
  }
  // A variable text extends to the constant behind it; without one, its frame has no other.
  std::size_t width(std::size_t index, std::size_t at) const {
    const Field& field = frame_.fields[index];
    if (!field.key.empty()) return opens_block(frame_, index) ? block_size(index, at) : 0;
    if (field.variable && !field.text.empty()) {  // an optional constant
      const ByteView rest = bytes_.subspan(std::min(at, bytes_.size()));
      const bool there =
          rest.size() >= field.text.size() &&
          std::equal(field.text.begin(), field.text.end(), rest.begin(),
                     [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
      return there ? field.text.size() : 0;
    }
    if (field.variable && index + 1 < frame_.fields.size() && at < bytes_.size()) {
      const Field& next = frame_.fields[index + 1];
      Bytes mark = next.kind == FieldKind::kConstant ? constant_characters(next) : Bytes{};
      for (std::uint8_t& each : mark) each = next.transform.sent(each);
      const auto rest = bytes_.subspan(at);
      const auto end = mark.empty()
                           ? rest.end()
                           : std::search(rest.begin(), rest.end(), mark.begin(), mark.end());
      if (end != rest.end()) return static_cast<std::size_t>(end - rest.begin());
    }
    if (field.kind == FieldKind::kItems || field.variable) return elastic_;
    if (!field.text.empty()) return field.text.size();
    if (field.text_size != 0) return field.text_size;
    return field.opens ? field.word.characters : 0;
  }
  void place() {
    std::size_t at = 0;
    for (std::size_t i = 0; i < frame_.fields.size(); ++i) {
      starts_.push_back(at);
      widths_.push_back(width(i, at));
      at += widths_.back();
    }
    starts_.push_back(offset_ = at);
  }
  void add(std::size_t at, std::size_t length, const std::string& name, const std::string& value,
           const std::string& fault = {}) {
    faults_ += fault.empty() ? 0 : 1;
    writer_.add(at, length, name, value, fault);
  }

  void show(const Field& field, std::size_t index) {
    if (!field.key.empty()) return block_value(field, index);
    std::size_t opener = index;
    while (opener > 0 && !frame_.fields[opener].opens) --opener;
    const std::size_t at = starts_[opener], size = widths_[opener];
    if (at + size > bytes_.size()) {
      const std::size_t have = std::min(at, bytes_.size());
      return add(have, bytes_.size() - have, field.name, "", "the frame ends before it is whole");
    }
    const Bytes part = frame_.fields[opener].transform.meant(bytes_.subspan(at, size));
    if (field.kind == FieldKind::kItems) return add(at, size, field.name, items(field, part));
    if (!field.text.empty()) {
      if (field.variable && size == 0) return add(at, 0, field.name, "not in this frame");
      const bool right = std::ranges::equal(part, field.text, {}, {},
                                            [](char c) { return static_cast<std::uint8_t>(c); });
      return add(at, size, field.name, to_hex(part), right ? "" : "should be " + spelt(field.text));
    }
    if (field.text_size != 0) {
      const std::string text(part.begin(), part.end());
      return add(at, size, field.name, field.kind == FieldKind::kUnused ? spelt(text) : text);
    }
    const auto word = read_word(part, field.word);
    if (!word) return add(at, size, field.name, to_hex(part), "a character that is no digit");
    number(field, at, size, *word >> field.shift & (UINT64_MAX >> (64 - field.bits)));
  }

  void block_value(const Field& field, std::size_t index) {
    std::size_t opener = index;
    while (!opens_block(frame_, opener)) --opener;
    const std::size_t at = std::min(starts_[opener], bytes_.size());
    const auto block = bytes_.subspan(at, std::min(widths_[opener], bytes_.size() - at));
    const auto found = value_in_block(block, field);
    if (!found) return add(at, 0, field.name, "not in this frame");
    const auto where = static_cast<std::size_t>(found->data() - bytes_.data());
    if (field.text_size != 0)
      return add(where, found->size(), field.name, std::string(found->begin(), found->end()));
    const auto number = read_word(*found, field.word);
    add(where, found->size(), field.name,
        number ? signed_text(*number, field.is_signed ? field.bits : 0) : to_hex(*found),
        number ? "" : "a character that is no digit");
  }

  // Decimal digits are shown as numbers, other items as on the wire.
  std::string items(const Field& field, const Bytes& part) const {
    if (field.word.notation != Notation::kBcd || item_bits_ == 1) return to_hex(part);
    std::string text;
    for (std::size_t at = 0; at + field.word.characters <= part.size();
         at += field.word.characters) {
      const auto number = read_word(ByteView(part).subspan(at, field.word.characters), field.word);
      if (!number) return to_hex(part);
      text += (text.empty() ? "" : " ") + signed_text(*number, field.word.sign_bits);
    }
    return text;
  }
  static std::string signed_text(std::uint64_t number, unsigned bits) {
    const bool negative = bits != 0 && (number >> (bits - 1) & 1u) != 0;
    return negative ? "-" + std::to_string((0 - number) & (UINT64_MAX >> (64 - bits)))
                    : std::to_string(number);
  }

  // Characters, or hexadecimal bytes if one of them cannot be printed.
  static std::string spelt(const std::string& text) {
    const bool prints = std::ranges::all_of(text, [](char c) { return c >= ' ' && c <= '~'; });
    return prints ? text : to_hex(Bytes(text.begin(), text.end()));
  }

  // A value without a numeric meaning is shown as on the wire.
  static std::string spelt(const Field& field, std::uint64_t number) {
    const bool mark = field.kind == FieldKind::kConstant || field.kind == FieldKind::kCommand ||
                      field.kind == FieldKind::kChecksum;
    if (!mark || field.word.notation != Notation::kBinary ||
        field.bits != 8u * field.word.characters)
      return signed_text(number, field.is_signed ? field.bits : 0);
    Bytes bytes;
    append_word(bytes, field.word, number);
    return to_hex(bytes);
  }

  void number(const Field& field, std::size_t at, std::size_t size, std::uint64_t number) {
    std::string value = spelt(field, number), fault;
    const auto must = [&](std::uint64_t right) {
      if (number != right) fault = "should be " + spelt(field, right);
    };
    switch (field.kind) {
      case FieldKind::kConstant:
      case FieldKind::kCommand: must(*number_of(field, context_)); break;
      case FieldKind::kAddress: {
        const std::uint64_t address =
            (number - static_cast<std::uint64_t>(field.plus)) & (UINT64_MAX >> (64 - field.bits));
        value = std::to_string(address);
        if (address < declaration_.lowest_address || address > declaration_.highest_address)
          fault = "no address of this protocol";
        break;
      }
      case FieldKind::kChecksum:
        if (starts_[field.of.to + 1u] > bytes_.size()) {
          fault = "its fields are not whole";
        } else {
          must(check_of(field.check, field.bits, covered(frame_, field, bytes_, starts_)));
        }
        break;
      case FieldKind::kLength: must(counted(field)); break;
      case FieldKind::kError: {
        const auto known = declaration_.codes.find(static_cast<std::uint16_t>(number));
        if (known != declaration_.codes.end()) value += " " + known->second;
        if (context_.refusal == (number == field.number))
          fault = context_.refusal ? "no error" : "an error in a response";
        break;
      }
      default: break;
    }
    add(at, size, field.name, value, fault);
  }

  std::uint64_t counted(const Field& length) const {
    std::uint64_t total = static_cast<std::uint64_t>(length.plus);
    for (std::size_t i = length.of.from; i <= length.of.to; ++i) {
      const Field& field = frame_.fields[i];
      total += fieldcast::declared::counted(field, length, widths_[i], item_bits_);
    }
    return total;
  }

  const Declaration& declaration_;
  const Frame& frame_;
  ByteView bytes_;  // with escaped fields: plain_
  Bytes plain_;
  const unsigned item_bits_;
  FrameContext context_;
  std::size_t elastic_ = 0;  // characters of the field of variable length
  std::size_t offset_ = 0;   // after the last field
  std::vector<std::size_t> starts_, widths_;
  FieldWriter writer_;
  std::size_t faults_ = 0;
};

}  // namespace

std::vector<FrameField> explain(const Declaration& declaration, ByteView frame) {
  FieldWriter none;
  if (frame.size() > kMaxFrame) {
    none.remark("", "longer than any frame of a declared protocol");
    return none.take();
  }
  std::optional<Reading> best;
  const auto offer = [&](Reading reading) {
    if (!best || reading.faults < best->faults) best = std::move(reading);
  };
  const auto offer_round = [&](const Operation& round) {
    offer(Reader(declaration, round.request, frame, round.command, 16)
              .run("request: " + round.name, false));
    offer(Reader(declaration, round.response, frame, round.command, 16)
              .run("response: " + round.name, false));
  };
  for (const Operation& round : declaration.login) offer_round(round);
  for (const Operation& operation : declaration.operations) {
    const unsigned bits = declaration.areas[operation.area].item_bits;
    const bool unsolicited = operation.unsolicited > Duration::zero();
    if (!unsolicited)
      offer(Reader(declaration, operation.request, frame, operation.command, bits)
                .run("request: " + operation.name, false));
    offer(Reader(declaration, operation.response, frame, operation.command, bits)
              .run((unsolicited ? "unsolicited: " : "response: ") + operation.name, false));
    for (const Frame& other : operation.others)
      offer(Reader(declaration, other, frame, operation.command, bits)
                .run("response: " + operation.name, false));
    for (const Operation& round : operation.before) offer_round(round);
    for (const Frame& refusal : declaration.refusals)
      offer(Reader(declaration, refusal, frame, operation.command, bits)
                .run("refusal: " + operation.name, true));
  }
  if (best) return std::move(best->fields);
  none.remark("", "the declaration has no operations");
  return none.take();
}

namespace {

constexpr std::uint32_t kMostItemsTried = 64;  // of a write without a length field
// Fields with one possible value, in a frame without a check.
constexpr std::size_t kEnoughKnown = 2;

struct Seen {
  std::size_t size = 0;
  bool checked = false;
};

Seen match(const Declaration& declaration, const Operation& operation, const Frame& frame,
           ByteView bytes, bool refusal) {
  const DeclaredArea& area = declaration.areas[operation.area];
  FrameContext context;
  context.command = operation.command;
  context.item_bits = area.item_bits;
  context.refusal = refusal;
  // Without items the frame is the same for every count.
  const bool counts = std::ranges::any_of(
      frame.fields, [](const Field& field) { return field.kind == FieldKind::kItems; });
  const std::uint32_t most =
      counts ? std::min<std::uint32_t>(operation.max_count, kMostItemsTried) : operation.min_count;
  for (std::uint32_t count = operation.min_count; count <= most; ++count) {
    context.count = count;
    const MatchResult found = match_frame(frame, bytes, context, area.record ? area.items : 0);
    const bool plausible = found.checked ? !found.bad_check : found.known >= kEnoughKnown;
    if (found.fit == MatchResult::Fit::kWhole && plausible) return {found.size, found.checked};
  }
  return {};
}

}  // namespace

SeenRequest seen_request(const Declaration& declaration, ByteView bytes) {
  SeenRequest seen;
  for (const Operation& operation : declaration.operations) {
    const Seen request = match(declaration, operation, operation.request, bytes, false);
    if (request.size == 0) continue;
    seen = {request.size, request.checked};
    break;
  }
  if (!seen) return seen;
  const ByteView frame = bytes.first(seen.size);
  for (const Operation& operation : declaration.operations) {
    const auto alike_frame = [&](const Frame& other, bool refusal) {
      return match(declaration, operation, other, frame, refusal).size == seen.size;
    };
    const bool alike =
        alike_frame(operation.response, false) ||
        std::ranges::any_of(operation.others,
                            [&](const Frame& other) { return alike_frame(other, false); }) ||
        std::ranges::any_of(declaration.refusals,
                            [&](const Frame& refusal) { return alike_frame(refusal, true); });
    if (alike) seen.certain = false;
  }
  return seen;
}

}  // namespace fieldcast::declared
