// Fuzzes `fieldcast inspect --learn`: frames of any content become a text without control
// characters.
//
// Input: for each frame a byte with its direction (highest bit) and its length, then its bytes.
#include <algorithm>
#include <cstdlib>

#include "tests/fuzz/fuzz.hpp"
#include "tools/cli/inspect/learn/proposal.hpp"

namespace fieldcast {
namespace {

void run_frames(ByteView data) {
  learn::ExchangePairing pairing;
  for (std::size_t at = 0; at < data.size();) {
    const bool sent = data[at] >> 7 != 0;
    const std::size_t size = std::min<std::size_t>(data[at] & 0x7Fu, data.size() - at - 1);
    pairing.take(sent ? Direction::kSent : Direction::kReceived, data.subspan(at + 1, size));
    at += 1 + size;
  }
  const auto exchanges = pairing.finish();
  const learn::Proposal proposal = learn::learn(exchanges);
  if (proposal.operations.size() > learn::kMaxGroups) std::abort();
  std::string text = learn::declaration_text(proposal);
  for (const auto& operation : proposal.operations) {
    for (const auto* fields : {&operation.request, &operation.response}) {
      for (const auto& field : *fields) {
        if (field.evidence.holds > field.evidence.of) std::abort();
        text += learn::content_of(field, proposal.text) + field.note;
      }
    }
  }
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 && c != '\n') std::abort();
  }
}

}  // namespace
}  // namespace fieldcast

FIELDCAST_FUZZ_TARGET(fieldcast::run_frames)
