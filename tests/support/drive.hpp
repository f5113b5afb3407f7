// Runs an exchange against bytes that are already known, the way the engine would: growing
// prefixes, then silence.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/protocol/protocol.hpp"

namespace fieldcast::test {

// What became of an exchange.
struct Outcome {
  Step::Kind kind = Step::Kind::kFailed;  // kDone or kFailed
  Cause cause = Cause::kNone;
  std::uint16_t code = 0;
  Reply reply;              // after kDone
  std::size_t used = 0;     // bytes received when it ended
  bool waited = false;      // it took silence to end it
  std::vector<Bytes> sent;  // every request
  [[nodiscard]] bool done() const { return kind == Step::Kind::kDone; }
};

// Sends, then shows the answer in pieces that end at `cuts` (ascending offsets), then silence. An
// exchange of several rounds gets answers[round] after its round-th send. Rounds are limited to 64:
// an exchange that wants more fails the run with kOverlong.
[[nodiscard]] Outcome drive(Exchange& exchange, std::span<const Bytes> answers,
                            std::span<const std::size_t> cuts = {});
[[nodiscard]] Outcome drive(Exchange& exchange, const Bytes& answer);

// Byte by byte.
[[nodiscard]] Outcome drive_bytewise(Exchange& exchange, std::span<const Bytes> answers);

[[nodiscard]] std::string to_text(const Outcome& outcome);  // for failure messages

}  // namespace fieldcast::test
