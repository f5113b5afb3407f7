// One conversation in a declared protocol: one request, one answer or refusal.
#pragma once

#include <memory>

#include "core/protocol/declared/frame.hpp"

namespace fieldcast::declared {

class DeclaredExchange final : public Exchange {
 public:
  // `wanted` is cut out of what the answer brings: of items as they come, of a record by its
  // places. A write brings nothing.
  DeclaredExchange(std::shared_ptr<const Declaration> declaration, const Operation& operation,
                   FrameContext context, Range wanted);

  [[nodiscard]] Step start(Bytes& out) override;
  [[nodiscard]] Step on_bytes(ByteView all, Bytes& out) override;
  [[nodiscard]] Step on_silence(Bytes& out) override;
  [[nodiscard]] const Reply& reply() const override { return reply_; }

 private:
  const std::shared_ptr<const Declaration> declaration_;
  const Operation& operation_;
  const FrameContext context_;
  const Range wanted_;
  const std::size_t most_;  // characters that are looked at; more is a babbling line
  Reply reply_;
  Cause silence_ = Cause::kNoAnswer;
  // What silence makes of the bytes: an answer behind what looked like another frame.
  std::optional<Step> fallback_;
};

}  // namespace fieldcast::declared
