// Runs an exchange with known response bytes as the engine would: growing prefixes, then silence.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/protocol/protocol.hpp"

namespace fieldcast::test {

struct Outcome {
  Step::Kind kind = Step::Kind::kFailed;  // kDone or kFailed
  Cause cause = Cause::kNone;
  std::uint16_t code = 0;
  Reply reply;           // after kDone
  std::size_t used = 0;  // bytes received when it ended
  bool waited = false;   // ended by silence
  std::vector<Bytes> sent;
  Bytes confirmation;  // sent behind the response
  [[nodiscard]] bool done() const { return kind == Step::Kind::kDone; }
};

// Sends, then feeds the response in pieces that end at `cuts` (ascending offsets), then silence. In
// an exchange of several rounds, answers[round] follows its send. More than 64 rounds fail with
// kOverlong.
[[nodiscard]] Outcome drive(Exchange& exchange, std::span<const Bytes> answers,
                            std::span<const std::size_t> cuts = {});
[[nodiscard]] Outcome drive(Exchange& exchange, const Bytes& answer);

[[nodiscard]] Outcome drive_bytewise(Exchange& exchange, std::span<const Bytes> answers);

[[nodiscard]] std::string to_text(const Outcome& outcome);

}  // namespace fieldcast::test
