#include "tools/cli/inspect/learn/proposal.hpp"

#include <fmt/format.h>

#include <map>

#include "core/base/message_text.hpp"
#include "tools/cli/inspect/learn/operation_fields.hpp"
#include "tools/cli/inspect/learn/plain_frames.hpp"

namespace fieldcast::learn {
namespace {

using declared::FieldKind;

// Refusals and broken frames: requests or responses of another length than nearly all others.
std::size_t drop_outliers(Group& group, bool text) {
  const auto rule = find_length_rule(group.requests, group.responses, text,
                                     [](std::size_t, std::size_t) { return true; });
  if (!rule || rule->evidence.holds == rule->evidence.of) return 0;
  const auto lengths = find_length_fields(group.responses, text);
  if (!lengths.empty() && lengths.front().evidence.holds == group.responses.size()) return 0;
  Group kept;
  for (std::size_t i = 0; i < group.requests.size(); ++i) {
    if (rule->fits(group.requests[i], group.responses[i]))
      kept.add(group.requests[i], group.responses[i]);
  }
  std::swap(group, kept);
  return kept.requests.size() - group.requests.size();
}

class Learner {
 public:
  explicit Learner(const std::vector<Exchange>& exchanges)
      : plain_(plain_frames(exchanges)), found_(group_exchanges(plain_.exchanges)) {
    if (plain_.lead) note("responses begin with bytes FE, FF or 00, which the bridge skips");
    out_.escape = plain_.escape;
    if (exchanges.size() < 8) note("few different exchanges: read more items, of several devices");
    out_.text = found_.roles.text;
  }

  Proposal run() {
    limit_groups();
    std::size_t dropped = 0;
    for (Group& group : found_.groups) dropped += drop_outliers(group, out_.text);
    find_operations();
    refuse_equal_requests();
    set_addresses();
    if (dropped > 0)
      note(counted(dropped, "exchange has", "exchanges have") +
           " another length: refusals, or broken frames");
    const auto has_checksum = [](const LearnedOperation& operation) {
      return std::ranges::count(operation.response, FieldKind::kChecksum, &LearnedField::kind) > 0;
    };
    if (!found_.roles.response_check && std::ranges::none_of(out_.operations, has_checksum))
      note("responses have no checksum that the catalogue has");
    return std::move(out_);
  }

 private:
  void note(std::string text) { out_.notes.push_back(std::move(text)); }

  void limit_groups() {
    if (found_.groups.size() <= kMaxGroups) return;
    note(fmt::format("only the first {} of {} kinds of requests are shown", kMaxGroups,
                     found_.groups.size()));
    found_.groups.resize(kMaxGroups);
  }

  // The second time with the best length rule of the first.
  void find_operations() {
    Known known;
    for (const Group& group : found_.groups) {
      for (const LengthRule& each : find_length_fields(group.responses, out_.text))
        known.lengths.push_back(each);
    }
    for (int pass = 0; pass < 2; ++pass) {
      out_.operations.clear();
      unsigned values = 0;
      std::size_t most = 0;
      for (const Group& group : found_.groups) {
        LearnedOperation made = fields_of(group, found_.roles, known, values);
        made.name = fmt::format("operation {}", out_.operations.size() + 1);
        out_.operations.push_back(std::move(made));
      }
      for (const LearnedOperation& operation : out_.operations) {
        if (!operation.rule || operation.rule->at < 0 || operation.exchanges <= most) continue;
        most = operation.exchanges;
        known.rule = operation.rule;
      }
    }
  }

  // The bridge could not distinguish their responses. Unknown fields are sent as 0.
  void refuse_equal_requests() {
    std::map<std::string, std::string> known;
    for (LearnedOperation& operation : out_.operations) {
      if (!operation.refusal.empty() || operation.request.empty()) continue;
      std::string sent;
      for (const LearnedField& field : operation.request) {
        if (field.kind == FieldKind::kConstant)
          sent.append(field.constant.begin(), field.constant.end());
        else if (field.kind == FieldKind::kUnused)
          sent.append(field.width, '\0');
        else if (field.kind == FieldKind::kCommand)
          sent += static_cast<char>(*operation.command);
        else
          sent += fmt::format("<{} {}>", static_cast<int>(field.kind), field.width);
      }
      const auto [first, is_new] = known.try_emplace(sent, operation.name);
      if (!is_new)
        operation.refusal =
            fmt::format("its requests are those of {} as far as they are known", first->second);
    }
  }

  void set_addresses() {
    const LearnedField& address = found_.roles.address;
    if (address.width == 0)
      return note("no address found: one device, or its address never differs");
    for (const Group& group : found_.groups) {
      for (const ByteView request : group.requests) {
        const auto number = number_at(request, address.at, address.word);
        if (number) out_.lowest_address = std::min(out_.lowest_address, *number);
      }
    }
    out_.highest_address = std::min<std::uint64_t>(declared::largest(address.word), INT64_MAX);
    if (!address.note.empty()) note("address: " + address.note);
  }

  const PlainFrames plain_;
  Grouping found_;
  Proposal out_;
};

}  // namespace

Proposal learn(const std::vector<Exchange>& exchanges) {
  if (!exchanges.empty()) return Learner(exchanges).run();
  return {.notes = {"no frames with a direction: nothing to learn"}};
}

Evidence explained_by(const declared::Declaration& declaration,
                      const std::vector<Exchange>& exchanges) {
  Evidence explained;
  const auto check = [&](ByteView frame, declared::Sender sender) {
    if (frame.empty()) return;
    explained.add(std::ranges::all_of(declared::explain(declaration, frame, sender),
                                      &std::string::empty, &FrameField::fault));
  };
  for (const Exchange& exchange : exchanges) {
    check(exchange.request, declared::Sender::kBridge);
    check(exchange.response, declared::Sender::kDevice);
  }
  return explained;
}

}  // namespace fieldcast::learn
