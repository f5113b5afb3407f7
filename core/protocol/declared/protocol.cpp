#include <algorithm>

#include "core/protocol/declared/declaration.hpp"
#include "core/protocol/declared/exchange.hpp"
#include "core/protocol/declared/scaled.hpp"
#include "core/protocol/option_reader.hpp"

namespace fieldcast::declared {
namespace {

bool has(const Frame& frame, FieldKind kind) {
  return std::ranges::any_of(frame.fields, [&](const Field& field) { return field.kind == kind; });
}

}  // namespace

std::size_t response_size(const Operation& operation, unsigned item_bits, std::uint32_t count) {
  std::size_t size = size_of(operation.response, item_bits, count);
  for (const Frame& other : operation.others)
    size = std::max(size, size_of(other, item_bits, count));
  return size;
}

std::uint32_t Operation::response_baud(std::optional<std::uint64_t> code) const {
  if (!has(request, FieldKind::kRate)) return 0;
  for (const Operation& round : before) {
    for (const Field& field : round.response.fields) {
      const auto baud = field.rates.find(code.value_or(field.number));
      if (baud != field.rates.end()) return baud->second;
    }
  }
  return 0;
}

bool Declaration::changes_rate() const {
  return std::ranges::any_of(operations,
                             [](const Operation& each) { return each.response_baud() != 0; });
}

bool in_each_form(const Operation& operation, FieldKind kind) {
  return has(operation.response, kind) &&
         std::ranges::all_of(operation.others,
                             [&](const Frame& other) { return has(other, kind); });
}

namespace {

// The least specific response counts.
ResponseIdentity identity_of(const Declaration& declaration) {
  const auto all = [&](FieldKind kind) {
    return std::ranges::all_of(declaration.operations,
                               [&](const Operation& each) {
                                 return each.no_response > Duration::zero() ||
                                        in_each_form(each, kind);
                               }) &&
           std::ranges::all_of(declaration.refusals,
                               [&](const Frame& refusal) { return has(refusal, kind); });
  };
  if (all(FieldKind::kSequence)) return ResponseIdentity::kSequence;
  return all(FieldKind::kAddress) ? ResponseIdentity::kAddress : ResponseIdentity::kNone;
}

class DeclaredProtocol final : public Protocol {
 public:
  DeclaredProtocol(std::shared_ptr<const Declaration> declaration, std::uint64_t address,
                   const LineFormat& line, const Traits& traits)
      : declaration_(std::move(declaration)), address_(address), line_(line), traits_(traits) {
    for (const auto& [code, text] : declaration_->codes) codes_.push_back({code, text});
    traits_.codes = codes_;
    for (const DeclaredArea& each : declaration_->areas) {
      Area area{.name = each.name,
                .item_bits = each.item_bits,
                .items = each.items,
                .max_read = 0,
                .max_write = 0,
                .window = each.record};
      for (const Operation& operation : declaration_->operations) {
        if (&declaration_->areas[operation.area] != &each) continue;
        if (operation.unsolicited > Duration::zero()) {
          area.unsolicited = operation.unsolicited;
          continue;
        }
        area.no_response = std::max(area.no_response, operation.no_response);
        if (operation.write)
          area.writable = true, area.max_write = std::max(area.max_write, operation.max_count);
        else
          area.max_read = std::max<std::uint16_t>(
              area.max_read,
              each.record ? static_cast<std::uint16_t>(each.items) : operation.max_count);
      }
      area.bit_write = area.writable && each.item_bits == 1;
      areas_.push_back(area);
    }
    for (const Operation& operation : declaration_->operations) {
      const unsigned bits = declaration_->areas[operation.area].item_bits;
      const bool record = declaration_->areas[operation.area].record;
      const auto fixed = [&](const Frame& frame) {
        return static_cast<std::uint32_t>(size_of(frame, bits, 0));
      };
      std::uint32_t sent = fixed(operation.request);
      auto received = static_cast<std::uint32_t>(response_size(operation, bits, 0));
      for (const Operation& round : operation.before) {
        sent += fixed(round.request);
        received += fixed(round.response);
      }
      prepared_.push_back({sent, received, items_field(operation.request),
                           items_field(operation.response), bits, record, operation.echoes(),
                           operation.response_baud()});
    }
  }

  const Traits& traits() const override { return traits_; }
  std::span<const Area> areas() const override { return areas_; }
  tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at) const override {
    return parse_with_suggestion(
        at, [&](std::string_view text) { return declared::parse_address(*declaration_, text); });
  }

  std::optional<ExchangeSize> size(const Request& request) const override {
    const auto at = operation_for(request);
    if (!at) return std::nullopt;
    const Prepared& sizes = prepared_[*at];
    const std::uint32_t count = range_of(request).count;
    const auto items = [&](std::size_t field, const Frame& frame) {
      return field == frame.fields.size() ? 0u
                                          : static_cast<std::uint32_t>(items_size(
                                                frame.fields[field], sizes.item_bits, count));
    };
    const Operation& operation = declaration_->operations[*at];
    ExchangeSize size{
        .request_characters = sizes.request + items(sizes.request_items, operation.request),
        .response_characters = sizes.response + items(sizes.response_items, operation.response),
        .rounds = 1 + static_cast<std::uint32_t>(operation.before.size()),
        .pauses = operation.no_response};
    if (sizes.response_baud == 0) return size;
    LineFormat line = line_;
    line.baud = sizes.response_baud;
    const auto last = static_cast<std::uint32_t>(response_size(operation, sizes.item_bits, count));
    size.response_characters -= last;
    size.response_at_other_rate = line.characters(last);
    return size;
  }

  std::unique_ptr<Exchange> begin(Request request, ExchangeContext exchange) const override {
    const auto at = operation_for(request);
    if (!at) std::abort();  // see REQUIRES of begin()
    const Operation& operation = declaration_->operations[*at];
    const Range& range = range_of(request);
    FrameContext context{.address = address_,
                         .command = operation.command,
                         .first = range.first,
                         .count = range.count,
                         .sequence = exchange.sequence,
                         .item_bits = prepared_[*at].item_bits};
    if (auto* write = std::get_if<WriteRequest>(&request))
      context.written = true, context.items = std::move(write->items);
    return std::make_unique<DeclaredExchange>(declaration_, operation, std::move(context), range,
                                              exchange.session);
  }

  // Responses differ by their command, or by a length that a check or a length field protects.
  bool mistakable(const Request& earlier, ExchangeContext earlier_context, const Request& later,
                  ExchangeContext later_context) const override {
    if (!Protocol::mistakable(earlier, earlier_context, later, later_context)) return false;
    const auto first = operation_for(earlier), second = operation_for(later);
    if (!first || !second) return true;
    const Operation &a = declaration_->operations[*first], &b = declaration_->operations[*second];
    if (a.no_response > Duration::zero() || b.no_response > Duration::zero()) return false;
    if (in_each_form(a, FieldKind::kCommand) && in_each_form(b, FieldKind::kCommand) &&
        a.command != b.command)
      return false;
    const bool bound = in_each_form(a, FieldKind::kChecksum) || in_each_form(a, FieldKind::kLength);
    if (*first != *second || !bound) return true;
    const auto x = size(earlier), y = size(later);
    return !x || !y ||
           (x->response_characters == y->response_characters &&
            x->response_at_other_rate == y->response_at_other_rate);
  }

  UnsolicitedFrame find_unsolicited(ByteView bytes, bool boundary) const override {
    return declared::find_unsolicited(*declaration_, address_, bytes, boundary);
  }

 private:
  struct Prepared {
    std::uint32_t request = 0, response = 0;            // characters without items
    std::size_t request_items = 0, response_items = 0;  // index of the items field, or the end
    unsigned item_bits = 16;
    bool record = false;
    bool echoes = false;
    std::uint32_t response_baud = 0;
  };

  static std::size_t items_field(const Frame& frame) {
    const auto at = std::ranges::find(frame.fields, FieldKind::kItems, &Field::kind);
    return static_cast<std::size_t>(at - frame.fields.begin());
  }
  // REQUIRES: operation_for() has found one.
  static const Range& range_of(const Request& request) {
    if (const auto* read = std::get_if<ReadRequest>(&request)) return read->ranges.front();
    return std::get<WriteRequest>(request).range;
  }

  std::optional<std::size_t> operation_for(const Request& request) const {
    const auto* read = std::get_if<ReadRequest>(&request);
    const auto* write = std::get_if<WriteRequest>(&request);
    if (read != nullptr ? read->ranges.size() != 1 : write == nullptr) return std::nullopt;
    const Range& range = range_of(request);
    if (range.area >= areas_.size() || range.count == 0) return std::nullopt;
    const Area& area = areas_[range.area];
    if (range.first >= area.items || range.count > area.items - range.first) return std::nullopt;
    if (write != nullptr && write->items.size() != image_bytes(area.item_bits, range.count))
      return std::nullopt;
    if (write != nullptr && write->bit && area.item_bits != 1) return std::nullopt;
    if (declaration_->areas[range.area].trigger && (write == nullptr || write->items[0] == 0))
      return std::nullopt;
    std::optional<std::size_t> echoing;  // used if there is no better operation
    for (std::size_t i = 0; i < prepared_.size(); ++i) {
      const Operation& operation = declaration_->operations[i];
      if (operation.area != range.area || operation.write != (write != nullptr)) continue;
      if (operation.unsolicited > Duration::zero()) continue;
      if (prepared_[i].record && write != nullptr) {
        if (operation.first != range.first || operation.max_count != range.count ||
            !values_fit(operation, *write))
          continue;
      } else if (!prepared_[i].record &&
                 (range.count < operation.min_count || range.count > operation.max_count ||
                  (write != nullptr && !items_fit(prepared_[i], operation, *write)))) {
        continue;
      }
      if (write == nullptr || !write->distinct_response || !prepared_[i].echoes) return i;
      if (!echoing) echoing = i;
    }
    return echoing;
  }

  // As values_fit(): returns false if an item has more digits than its field.
  static bool items_fit(const Prepared& prepared, const Operation& operation,
                        const WriteRequest& write) {
    const auto& fields = operation.request.fields;
    if (prepared.request_items == fields.size() || prepared.item_bits == 1) return true;
    const Word& word = fields[prepared.request_items].word;
    if (word.notation != Notation::kBcd && word.notation != Notation::kDecimal) return true;
    const std::size_t width = image_bytes(prepared.item_bits, 1);
    for (std::size_t at = 0; at < write.items.size(); at += width) {
      std::uint64_t item = 0;
      for (std::size_t i = at; i < at + width; ++i) item = item << 8 | write.items[i];
      const bool negative = word.sign_bits != 0 && (item >> (word.sign_bits - 1) & 1u) != 0;
      if (negative) item = (0 - item) & (UINT64_MAX >> (64 - word.sign_bits));
      if (item > largest(word)) return false;
    }
    return true;
  }

  // Returns false if a field cannot hold its number, so that no truncated value is sent.
  static bool values_fit(const Operation& operation, const WriteRequest& write) {
    if (std::ranges::any_of(operation.request.fields, &Field::scaled) &&
        !scaled_numbers(operation.request, write.items, operation.first))
      return false;
    for (const Field& field : operation.request.fields) {
      if (field.kind != FieldKind::kValue || field.text_size != 0 || field.scaled()) continue;
      const unsigned width = 16u * items_of(field);
      const auto value = value_in(write.items, field.place - operation.first, items_of(field));
      const std::uint64_t above = (value >> 1) >> (field.bits - 1);
      const std::uint64_t ones =
          width == field.bits ? 0 : (UINT64_MAX >> (64 - (width - field.bits)));
      const bool negative = field.is_signed && (value >> (field.bits - 1) & 1u) != 0;
      if (field.bits < width && above != (negative ? ones : 0)) return false;
      const std::uint64_t number = value & (UINT64_MAX >> (64 - field.bits));
      const bool digits =
          field.word.notation == Notation::kBcd || field.word.notation == Notation::kDecimal;
      if (digits && (negative ? (0 - number) & (UINT64_MAX >> (64 - field.bits)) : number) >
                        largest(field.word))
        return false;
    }
    return true;
  }

  const std::shared_ptr<const Declaration> declaration_;
  const std::uint64_t address_;
  const LineFormat line_;
  std::vector<DeviceCode> codes_;  // their texts belong to the declaration
  Traits traits_;
  std::vector<Area> areas_;
  std::vector<Prepared> prepared_;  // parallel to declaration_->operations
};

}  // namespace

namespace {

void set_address(Frame& frame, const std::string& text) {
  for (Field& field : frame.fields) {
    if (field.kind != FieldKind::kAddress) continue;
    field.text = text;
    field.text_size = 0;
    field.variable = false;
  }
}

// The declaration for one device whose address is text.
std::shared_ptr<const Declaration> addressed(const Declaration& declaration,
                                             const std::string& text) {
  auto own = std::make_shared<Declaration>(declaration);
  const auto set = [&](Operation& operation) {
    set_address(operation.request, text);
    set_address(operation.response, text);
    for (Frame& other : operation.others) set_address(other, text);
  };
  for (Operation& operation : own->operations) {
    set(operation);
    std::ranges::for_each(operation.before, set);
  }
  std::ranges::for_each(own->login, set);
  for (Frame& refusal : own->refusals) set_address(refusal, text);
  return own;
}

}  // namespace

tl::expected<std::unique_ptr<Protocol>, OptionFault> make(
    std::shared_ptr<const Declaration> declaration, const DeviceLink& link) {
  const auto address = device_address(*declaration, link);
  if (!address) return tl::unexpected(address.error());
  if (!address->text.empty()) declaration = addressed(*declaration, address->text);
  const Traits traits{
      .name = declaration->name,
      .summary = declaration->summary,
      .lowest_address = declaration->lowest_address,
      .highest_address =
          static_cast<std::uint16_t>(std::min<std::uint64_t>(declaration->highest_address, 65535)),
      .identity = identity_of(*declaration),
      .echo_is_ambiguous = std::ranges::any_of(declaration->operations, &Operation::echoes)};
  const OptionReader reader({.address = traits.lowest_address, .options = link.options}, traits,
                            {});
  if (reader.fault()) return tl::unexpected(*reader.fault());
  return std::make_unique<DeclaredProtocol>(std::move(declaration), address->number, link.line,
                                            traits);
}

}  // namespace fieldcast::declared
