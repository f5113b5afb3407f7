#include "core/protocol/declared/exchange.hpp"

#include <algorithm>

#include "core/protocol/received.hpp"

namespace fieldcast::declared {
namespace {

// This wait need not cover the whole rest of a frame, as each received byte restarts it.
constexpr std::size_t kDoubtfulWait = 8;

bool has_block(const Operation& operation) {
  const auto has_key = [](const Frame& form) {
    return std::ranges::any_of(form.fields, [](const Field& field) { return !field.key.empty(); });
  };
  return has_key(operation.response) || std::ranges::any_of(operation.others, has_key);
}

// Limited because each received byte searches all bytes again.
std::size_t most_received(const Declaration& declaration) {
  std::size_t longest = 0;
  for (const Operation& operation : declaration.operations) {
    const unsigned item_bits = declaration.areas[operation.area].item_bits;
    longest = std::max(longest, response_size(operation, item_bits, operation.max_count));
    if (has_block(operation)) longest = std::max(longest, kMaxFrame);
    for (const Operation& round : operation.before)
      longest = std::max(longest, size_of(round.response, 16, 0));
  }
  for (const Operation& round : declaration.login)
    longest = std::max(longest, size_of(round.response, 16, 0));
  const bool escapes = declaration.operations.front().response.escape != Escape::kNone;
  return (escapes ? 4 : 2) * longest + 64;
}

bool strict(const MatchResult& result) { return !result.foreign && !result.mismatch; }

// Frame boundaries are only certain at the start and after a frame with a valid check; elsewhere
// the search advances byte by byte.
class Search {
 public:
  Search(ByteView all, const Declaration& declaration, const Operation& operation,
         const FrameContext& context)
      : all_(all),
        declaration_(declaration),
        operation_(operation),
        context_(context),
        refused_(context) {
    refused_.refusal = true;
    const DeclaredArea& area = declaration.areas[operation.area];
    record_items_ = area.record ? area.items : 0;
    expected_ = response_size(operation, context.item_bits, context.count);
  }

  // A round before the request has no refusal.
  void run(bool is_round) {
    while (at_ < all_.size() && !found) {
      if (!is_round)
        parse_here();
      else if (!try_frame(operation_.response, context_, 0, true))
        boundary_ = false, ++faults_.noise, ++at_;
    }
    if (found) return;
    if (faults_.noise >= expected_ || faults_.broken)
      // As many broken bytes as a response has: a valid one follows immediately, or not at all.
      begun = true;
  }

  std::optional<MatchResult> found;
  const Frame* form = nullptr;  // of `found`
  bool refusal = false;         // `found` is a refusal
  bool doubtful = false;        // `found` follows what looks like the beginning of another frame
  bool begun = false;
  std::size_t missing = 0;

  [[nodiscard]] Cause cause() const { return faults_.cause(); }

 private:
  void parse_here() {
    if (try_forms(operation_, context_, record_items_, true)) return;
    for (const Frame& refused : declaration_.refusals) {
      if (try_frame(refused, refused_, 0, true)) return;
    }
    if (boundary_ && try_others()) return;
    if (!is_turnaround(all_[at_])) boundary_ = false, ++faults_.noise;
    ++at_;
  }

  // Skips other responses as a whole; otherwise ours could be read from their middle.
  bool try_others() {
    for (const Operation& other : declaration_.operations) {
      const DeclaredArea& area = declaration_.areas[other.area];
      FrameContext context{.address = context_.address,
                           .command = other.command,
                           .sequence = context_.sequence,
                           .item_bits = area.item_bits};
      if (&other != &operation_ && try_forms(other, context, area.record ? area.items : 0, false))
        return true;
      context.refusal = true;
      for (const Frame& refused : declaration_.refusals) {
        if (try_frame(refused, context, 0, false)) return true;
      }
    }
    return false;
  }

  bool try_forms(const Operation& operation, const FrameContext& context, std::size_t record_items,
                 bool mine) {
    return try_frame(operation.response, context, record_items, mine) ||
           std::ranges::any_of(operation.others, [&](const Frame& other) {
             return try_frame(other, context, record_items, mine);
           });
  }

  // Returns true if a whole frame was found or skipped.
  bool try_frame(const Frame& frame, const FrameContext& context, std::size_t record_items,
                 bool mine) {
    MatchResult result = match_frame(frame, all_.subspan(at_), context, record_items);
    if (result.fit == MatchResult::Fit::kNone) return false;
    const bool ours = mine && strict(result);
    if (result.fit == MatchResult::Fit::kPart) {
      begin(result, ours);
      return false;
    }
    if (result.bad_check) {
      faults_.broken = faults_.broken || ours;
      return false;
    }
    if (ours) {
      found = std::move(result);
      form = &frame;
      refusal = context.refusal;
      doubtful = held_;
      return true;
    }
    if (!result.checked) {  // without a checksum it may not be a frame
      faults_.mismatch = faults_.mismatch || (boundary_ && !result.foreign);
      return false;
    }
    (result.foreign || !mine ? faults_.foreign : faults_.mismatch) = true;
    at_ += result.size;
    boundary_ = true;
    return true;
  }

  // At a boundary an incomplete frame owns the following bytes, until silence shows that it was
  // noise.
  void begin(const MatchResult& result, bool ours) {
    if (!ours && (!boundary_ || result.known == 0)) return;
    if (!begun)
      missing = ours && boundary_ ? result.missing : std::min(result.missing, kDoubtfulWait);
    begun = true;
    held_ = held_ || boundary_;
    if (!ours)
      faults_.foreign = true;
    else
      (boundary_ ? faults_.truncated : faults_.cut) = true;
  }

  const ByteView all_;
  const Declaration& declaration_;
  const Operation& operation_;
  const FrameContext& context_;
  FrameContext refused_;
  std::size_t record_items_ = 0;
  std::size_t expected_ = 0;
  std::size_t at_ = 0;
  SearchFaults faults_;
  bool boundary_ = true;
  bool held_ = false;
};

}  // namespace

DeclaredExchange::DeclaredExchange(std::shared_ptr<const Declaration> declaration,
                                   const Operation& operation, FrameContext context, Range wanted,
                                   Bytes* session)
    : declaration_(std::move(declaration)),
      operation_(operation),
      context_(std::move(context)),
      wanted_(wanted),
      session_(session),
      most_(most_received(*declaration_)) {
  if (!declaration_->login.empty()) {
    FrameContext login = context_;
    login.command = declaration_->login.front().command;
    Bytes request;
    append_frame(request, declaration_->login.front().request, login);
    session_key_ = "<" + declaration_->name + " " + to_hex(request) + ">";
    if (!is_logged_in())
      for (const Operation& round : declaration_->login) rounds_.push_back(&round);
    logins_ = rounds_.size();
  }
  for (const Operation& round : operation_.before) rounds_.push_back(&round);
}

// All devices of a bus share the session: it lists those that are logged in.
bool DeclaredExchange::is_logged_in() const {
  return session_ != nullptr &&
         std::search(session_->begin(), session_->end(), session_key_.begin(),
                     session_key_.end()) != session_->end();
}

void DeclaredExchange::set_logged_in(bool logged_in) {
  if (session_ == nullptr || session_key_.empty() || logged_in == is_logged_in()) return;
  if (logged_in) {
    session_->insert(session_->end(), session_key_.begin(), session_key_.end());
  } else {
    const auto found =
        std::search(session_->begin(), session_->end(), session_key_.begin(), session_key_.end());
    session_->erase(found, found + static_cast<std::ptrdiff_t>(session_key_.size()));
  }
}

// After a failure the next exchange logs in again.
Step DeclaredExchange::fail(Step step) {
  if (step.kind == Step::Kind::kFailed) set_logged_in(false);
  return step;
}

Step DeclaredExchange::send_round(Bytes& out) {
  silence_ = Cause::kNoResponse;
  FrameContext context = context_;
  context.command = rounds_[round_]->command;
  append_frame(out, rounds_[round_]->request, context);
  return Step::send(size_of(rounds_[round_]->response, 16, 0));
}

Step DeclaredExchange::on_round(ByteView all, Bytes& out) {
  FrameContext context = context_;
  context.command = rounds_[round_]->command;
  Search search(all, *declaration_, *rounds_[round_], context);
  search.run(true);
  silence_ = search.cause();
  if (!search.found) return search.begun ? Step::need_rest(search.missing) : Step::need_response();
  if (search.found->rate) context_.rate = search.found->rate;
  if (++round_ == logins_) set_logged_in(true);
  out.clear();
  return round_ < rounds_.size() ? send_round(out) : start(out);
}

Step DeclaredExchange::start(Bytes& out) {
  if (round_ < rounds_.size()) return send_round(out);
  append_frame(out, operation_.request, context_);
  silence_ = Cause::kNoResponse;
  fallback_.reset();
  if (operation_.no_response > Duration::zero())
    return Step::send_without_response(operation_.no_response);
  // A block may have more than its known values; the wait must last for all of it.
  Step step = Step::send(has_block(operation_)
                             ? kMaxFrame
                             : response_size(operation_, context_.item_bits, context_.count));
  step.response_baud = operation_.response_baud(context_.rate);
  return step;
}

// The wanted places that the response does not have, because it is another form of it, or its block
// is without them.
std::vector<Range> DeclaredExchange::absent_places(const Frame& form,
                                                   const std::vector<Range>& not_in_block) const {
  std::vector<Range> absent;
  if (operation_.others.empty() && not_in_block.empty()) return absent;
  for (const Place& place : declaration_->areas[operation_.area].places) {
    const Range items{operation_.area, place.first, place.items};
    if (items.first >= wanted_.end() || items.end() <= wanted_.first) continue;
    const bool in_form = std::ranges::any_of(form.fields, [&](const Field& field) {
      return field.kind == FieldKind::kValue && field.place == place.first;
    });
    const bool in_block =
        std::ranges::find(not_in_block, place.first, &Range::first) == not_in_block.end();
    if (!in_form || !in_block) absent.push_back(items);
  }
  return absent;
}

Step DeclaredExchange::on_bytes(ByteView all, Bytes& out) {
  if (all.size() > most_) return fail(Step::failed(Cause::kOverlong));
  if (round_ < rounds_.size()) return on_round(all, out);
  if (operation_.no_response > Duration::zero()) return Step::pause_for(operation_.no_response);
  Search search(all, *declaration_, operation_, context_);
  search.run(false);
  silence_ = search.cause();
  fallback_.reset();
  if (!search.found) return search.begun ? Step::need_rest(search.missing) : Step::need_response();
  Step step = Step::done();
  if (search.refusal) {
    const bool busy =
        std::ranges::find(declaration_->busy, search.found->error) != declaration_->busy.end();
    step = fail(Step::failed(busy ? Cause::kDeviceBusy : Cause::kDeviceError, search.found->error));
  } else {
    reply_.assign(1, {});
    if (!operation_.write) {
      reply_[0].absent = absent_places(*search.form, search.found->absent);
      std::uint32_t absent = 0;
      for (const Range& items : reply_[0].absent) absent += items.count;
      if (absent >= wanted_.count) step = Step::failed(Cause::kDeviceError);
      const Bytes& items = search.found->items;
      const bool record = declaration_->areas[operation_.area].record;
      const auto from = items.begin() + (record ? std::ptrdiff_t{2} * wanted_.first : 0);
      reply_[0].items.assign(from, record ? from + std::ptrdiff_t{2} * wanted_.count : items.end());
    }
  }
  if (!search.doubtful) return step;
  fallback_ = step;
  return Step::need_rest(search.missing);
}

Step DeclaredExchange::on_silence(Bytes&) {
  if (round_ == rounds_.size() && operation_.no_response > Duration::zero()) {
    reply_.assign(1, {});
    return Step::done();
  }
  return fail(fallback_ ? *fallback_ : Step::failed(silence_));
}

}  // namespace fieldcast::declared
