// HistoryRequest and HistoryBlock: conversion to and from plain values. Data from DDS is not
// trusted: everything out of its range is rejected. Pure.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <utility>

#include "bridge/dds/topics/conversion_enums.hpp"
#include "bridge/dds/topics/history_values.hpp"
#include "idl/topics.h"

namespace fieldcast {

void to_idl(const HistoryRequest& request, idl::HistoryRequest& out);
// Fails with the reason, for the requester.
[[nodiscard]] tl::expected<HistoryRequest, std::string> from_idl(const idl::HistoryRequest& in);

// Splits a response into blocks of about `most_bytes` and passes each to `write`, which may change
// `block`, the memory of all of them.
void to_blocks(const HistoryRequest& request, const HistoryResponse& response,
               std::size_t most_bytes, idl::HistoryBlock& block,
               const std::function<void(idl::HistoryBlock& block)>& write);

// Collects the blocks of one response. One owner.
class HistoryParts {
 public:
  explicit HistoryParts(const HistoryRequest& request)
      : channels_(request.channels.size()), rows_(request.rows) {}

  // kOther: the block is of no use here, because a part was lost or it breaks the rules.
  enum class Added : std::uint8_t { kMore, kWhole, kOther };
  // REQUIRES: the block has the request's requester and request_id.
  [[nodiscard]] Added add(const idl::HistoryBlock& block);
  // The response, once add() has returned kWhole.
  [[nodiscard]] HistoryResponse take() { return std::move(response_); }

 private:
  const std::size_t channels_, rows_;
  std::uint32_t next_ = 0;  // part
  HistoryResponse response_;
};

}  // namespace fieldcast
