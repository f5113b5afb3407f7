#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/protocol/declared/frame.hpp"

namespace fieldcast::declared {

class DeclaredExchange final : public Exchange {
 public:
  // `wanted`: part of the response that reply() returns; for a record, selected by its places.
  // `session`: see ExchangeContext.
  DeclaredExchange(std::shared_ptr<const Declaration> declaration, const Operation& operation,
                   FrameContext context, Range wanted, Bytes* session);

  [[nodiscard]] Step start(Bytes& out) override;
  [[nodiscard]] Step on_bytes(ByteView all, Bytes& out) override;
  [[nodiscard]] Step on_silence(Bytes& out) override;
  [[nodiscard]] const Reply& reply() const override { return reply_; }

 private:
  [[nodiscard]] Step send_round(Bytes& out);
  [[nodiscard]] Step on_round(ByteView all, Bytes& out);
  [[nodiscard]] Step fail(Step step);
  [[nodiscard]] std::vector<Range> absent_places(const Frame& form,
                                                 const std::vector<Range>& not_in_block) const;
  [[nodiscard]] bool is_logged_in() const;
  void set_logged_in(bool logged_in);

  const std::shared_ptr<const Declaration> declaration_;
  const Operation& operation_;
  FrameContext context_;
  const Range wanted_;
  Bytes* const session_;
  std::string session_key_;
  std::vector<const Operation*> rounds_;  // before the request
  std::size_t round_ = 0;                 // rounds_.size(): the request
  std::size_t logins_ = 0;                // the first rounds_
  // Limit of searched characters; more means that the line never becomes silent.
  const std::size_t most_;
  Reply reply_;
  Cause silence_ = Cause::kNoResponse;
  // Result after silence: a response behind what looked like another frame.
  std::optional<Step> fallback_;
};

}  // namespace fieldcast::declared
