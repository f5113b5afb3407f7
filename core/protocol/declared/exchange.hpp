#pragma once

#include <memory>

#include "core/protocol/declared/frame.hpp"

namespace fieldcast::declared {

class DeclaredExchange final : public Exchange {
 public:
  // `wanted`: part of the response that reply() returns; for a record, selected by its places.
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
  // Limit of searched characters; more means that the line never becomes silent.
  const std::size_t most_;
  Reply reply_;
  Cause silence_ = Cause::kNoResponse;
  // Result after silence: a response behind what looked like another frame.
  std::optional<Step> fallback_;
};

}  // namespace fieldcast::declared
