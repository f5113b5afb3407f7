#include "tests/fuzz/any_protocol.hpp"

#include <array>
#include <cstdlib>

#include "tests/fuzz/fuzz.hpp"
#include "tests/support/drive.hpp"

namespace fieldcast::fuzz {
namespace {

constexpr std::size_t kChoices = 5;

Request request_of(const Protocol& protocol, ByteView choices) {
  const auto area = static_cast<AreaIndex>(choices[0] % protocol.areas().size());
  const Area& row = protocol.areas()[area];
  const Range range{area, std::uint32_t{choices[1]} / row.alignment * row.alignment,
                    1u + choices[2]};
  if (choices[3] % 4 == 0) {
    WriteRequest write{.range = range, .items = Bytes(image_bytes(row.item_bits, range.count), 1)};
    if (choices[3] % 8 == 0) write.bit = static_cast<std::uint8_t>(choices[4] % 16);
    return write;
  }
  ReadRequest read{{range}};
  if (choices[3] % 4 == 1 && protocol.traits().max_ranges > 1)
    read.ranges.push_back({area, 300u + choices[4], 1});
  return read;
}

void check_reply(const Protocol& protocol, const Request& request, const Reply& reply) {
  const auto* read = std::get_if<ReadRequest>(&request);
  if (read == nullptr) return;
  if (reply.size() != read->ranges.size()) std::abort();
  for (std::size_t i = 0; i < reply.size(); ++i) {
    const Range& range = read->ranges[i];
    const std::size_t size = image_bytes(protocol.areas()[range.area].item_bits, range.count);
    if (reply[i].cause == Cause::kNone && reply[i].items.size() != size) std::abort();
  }
}

// Each search uses bytes or ends.
void listen(const Protocol& protocol, Bytes kept) {
  bool boundary = true;
  for (;;) {
    const UnsolicitedFrame found = protocol.find_unsolicited(kept, boundary);
    if (found.used > kept.size()) std::abort();
    if (!found.range) return;
    if (found.used == 0) std::abort();
    const Area& area = protocol.areas()[found.range->area];
    if (area.unsolicited == Duration::zero() || found.range->end() > area.items) std::abort();
    if (found.items.size() != image_bytes(area.item_bits, found.range->count)) std::abort();
    kept.erase(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(found.used));
    boundary = found.boundary;
  }
}

}  // namespace

void run_protocol(const Protocol& protocol,
                  const std::function<std::vector<FrameField>(ByteView)>& explain, ByteView data) {
  if (data.size() < kChoices) return;
  const bool explained = is_explained(data);
  const Request request = request_of(protocol, data);
  const std::array<std::size_t, 2> cuts{data[4] & 15u, 16u + (data[4] >> 4)};
  std::vector<Bytes> answers;
  for (data = data.subspan(kChoices); !data.empty();) {
    const std::size_t size = std::min<std::size_t>(data[0], data.size() - 1);
    answers.emplace_back(data.begin() + 1, data.begin() + 1 + static_cast<std::ptrdiff_t>(size));
    data = data.subspan(1 + size);
  }
  if (explained) {
    for (const Bytes& answer : answers) check_explanation(explain(answer), answer.size());
  }
  for (const Bytes& answer : answers) listen(protocol, answer);
  const auto sizes = protocol.size(request);
  if (!sizes) return;
  const auto exchange = protocol.begin(request, {.sequence = 1});
  const test::Outcome outcome = test::drive(*exchange, answers, cuts);
  if (outcome.sent.empty() || outcome.sent[0].size() > sizes->request_characters) std::abort();
  if (explained) check_explanation(explain(outcome.sent[0]), outcome.sent[0].size());
  if (outcome.done()) check_reply(protocol, request, outcome.reply);
}

}  // namespace fieldcast::fuzz
