#include "tools/cli/inspect/learn/proposal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "tools/cli/inspect/learn/operation_fields.hpp"

namespace fieldcast::learn {
namespace {

using declared::FieldKind;

bool lengths_fit(const Frames& frames, bool text) {
  const auto all = find_length_fields(frames, text);
  return !all.empty() && all.front().evidence.holds == frames.size();
}

// Refusals and broken frames: requests or responses of another length than nearly all others.
std::size_t drop_outliers(Group& group, bool text) {
  const auto rule = find_length_rule(group.requests, group.responses, text,
                                     [](std::size_t, std::size_t) { return true; });
  if (!rule || rule->evidence.holds == rule->evidence.of || lengths_fit(group.responses, text))
    return 0;
  Group kept;
  for (std::size_t i = 0; i < group.requests.size(); ++i) {
    if (!rule->fits(group.requests[i], group.responses[i])) continue;
    kept.requests.push_back(group.requests[i]);
    kept.responses.push_back(group.responses[i]);
  }
  std::swap(group, kept);
  return kept.requests.size() - group.requests.size();
}

std::vector<LengthField> lengths_of(const std::vector<Group>& groups, bool text) {
  std::vector<LengthField> all;
  for (const Group& group : groups) {
    for (const LengthField& each : find_length_fields(group.responses, text)) all.push_back(each);
  }
  return all;
}

// A long address has packed decimal digits, if it never has other digits.
void set_addresses(Proposal& proposal, const Group& all, const Columns& columns) {
  if (columns.width == 0) {
    proposal.notes.push_back("no address found: one device, or its address never differs");
    return;
  }
  bool decimal = columns.width > 2;
  for (std::size_t i = 0; i < columns.width; ++i) {
    for (const auto c : values_at(all.requests, columns.at + static_cast<std::ptrdiff_t>(i)))
      decimal = decimal && c >> 4 <= 9 && (c & 0xFu) <= 9;
  }
  const bool hexadecimal =
      std::ranges::any_of(proposal.operations, [](const LearnedOperation& operation) {
        return std::ranges::any_of(operation.request, [](const LearnedField& field) {
          return field.kind == FieldKind::kAddress &&
                 field.word.notation == declared::Notation::kHex;
        });
      });
  proposal.lowest_address = UINT16_MAX;
  for (LearnedOperation& operation : proposal.operations) {
    for (auto* frame : {&operation.request, &operation.response}) {
      for (LearnedField& field : *frame) {
        if (field.kind != FieldKind::kAddress) continue;
        if (hexadecimal) field.word.notation = declared::Notation::kHex;
        if (field.word.notation == declared::Notation::kDecimal && field.note.empty())
          field.note = "no digit above 9: perhaps hexadecimal";
        if (decimal && !proposal.text) {
          field.word.notation = declared::Notation::kBcd;
          field.note = "only decimal digits occur; the byte order is a guess";
        }
        for (const ByteView request : all.requests) {
          const auto number = number_at(request, columns.at, field.word);
          if (number) proposal.lowest_address = std::min(proposal.lowest_address, *number);
        }
        proposal.highest_address =
            std::min<std::uint64_t>(declared::largest(field.word), INT64_MAX);
      }
    }
  }
  proposal.lowest_address = std::min<std::uint64_t>(proposal.lowest_address, 1);
  if (!columns.note.empty()) proposal.notes.push_back("address: " + columns.note);
}

void name_operations(std::vector<LearnedOperation>& operations) {
  std::size_t number = 0;
  for (LearnedOperation& operation : operations)
    operation.name = fmt::format("operation {}", ++number);
}

// A record needs a value, and its values have names of their own.
void check_values(std::vector<LearnedOperation>& operations) {
  std::size_t number = 0;
  for (LearnedOperation& operation : operations) {
    for (LearnedField& field : operation.response) {
      if (field.kind != FieldKind::kValue) continue;
      const std::string old = std::exchange(field.name, fmt::format("value-{}", ++number));
      for (LearnedField& other : operation.response) {
        if (other.of_first == old) other.of_first = field.name;
        if (other.of_last == old) other.of_last = field.name;
      }
    }
    if (operation.request.size() > declared::kMaxFields ||
        operation.response.size() > declared::kMaxFields)
      operation.refusal = "more than 64 fields";
  }
}

}  // namespace

Proposal learn(const std::vector<Exchange>& exchanges) {
  Proposal proposal;
  if (exchanges.empty()) {
    proposal.notes.push_back("no frames with a direction: nothing to learn");
    return proposal;
  }
  if (exchanges.size() < 8)
    proposal.notes.push_back("few different exchanges: read more items, of several devices");
  Grouping found = group_exchanges(exchanges);
  proposal.text = found.roles.text;
  if (found.groups.size() > kMaxGroups) {
    proposal.notes.push_back(fmt::format("only the first {} of {} kinds of requests are shown",
                                         kMaxGroups, found.groups.size()));
    found.groups.resize(kMaxGroups);
  }
  std::size_t dropped = 0;
  Group all;
  for (Group& group : found.groups) {
    dropped += drop_outliers(group, proposal.text);
    all.requests.insert(all.requests.end(), group.requests.begin(), group.requests.end());
  }
  Known known{lengths_of(found.groups, proposal.text), {}};
  // The second time with the best rule of the first.
  for (int pass = 0; pass < 2; ++pass) {
    proposal.operations.clear();
    for (const Group& group : found.groups)
      proposal.operations.push_back(fields_of(group, found.roles, known));
    std::size_t most = 0;
    for (const LearnedOperation& operation : proposal.operations) {
      if (!operation.rule || operation.rule->at < 0 || operation.exchanges <= most) continue;
      most = operation.exchanges;
      known.rule = operation.rule;
    }
  }
  set_addresses(proposal, all, found.roles.address);
  name_operations(proposal.operations);
  check_values(proposal.operations);
  if (dropped > 0)
    proposal.notes.push_back(
        fmt::format("{} exchanges have another length: refusals, or broken frames", dropped));
  if (!found.roles.response_check &&
      std::ranges::none_of(proposal.operations, [](const LearnedOperation& operation) {
        return std::ranges::find(operation.response, FieldKind::kChecksum, &LearnedField::kind) !=
               operation.response.end();
      }))
    proposal.notes.push_back("responses have no checksum that the catalogue has");
  return proposal;
}

Evidence explained_by(const declared::Declaration& declaration,
                      const std::vector<Exchange>& exchanges) {
  Evidence explained;
  for (const Exchange& exchange : exchanges) {
    for (const Bytes& frame : {exchange.request, exchange.response}) {
      if (frame.empty()) continue;
      const auto fields = declared::explain(declaration, frame);
      ++explained.of;
      if (!fields.empty() && std::ranges::all_of(fields, &std::string::empty, &FrameField::fault))
        ++explained.holds;
    }
  }
  return explained;
}

}  // namespace fieldcast::learn
