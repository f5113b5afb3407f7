// SampleBlock and CatalogueBlock: from core types, and back row by row. Pure functions; any thread.
//
// From DDS nothing is trusted: columns that do not fit together, unknown kinds and qualities are
// refused.
#pragma once

#include <cstdint>
#include <string>

#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/dds/topics/topics.hpp"
#include "bridge/dds/topics/utc_mapping.hpp"
#include "core/model/sample.hpp"
#include "core/model/spec.hpp"
#include "idl/topics.h"

namespace fieldcast {

// ---- samples

// The last value of a channel as the topics carry it.
struct LastValue {
  idl::ValueKind kind = idl::VALUE_BOOLEAN;
  idl::Quality quality = idl::NOT_YET_READ;
  std::uint16_t device_code = 0;
  std::uint64_t bits = 0;        // of the value; not of a text
  std::int64_t acquired_at = 0;  // UTC nanoseconds
  std::uint64_t sequence = 0;    // 0: never sampled
  std::string text;
};
// As to_idl(): a text that does not fit becomes an empty one of quality BAD_RANGE.
void to_last_value(const Sample& sample, const UtcMapping& mapping, LastValue& out);

// Adds rows to a block until it is full.
class BlockFiller {
 public:
  static constexpr std::size_t kMaxRows = 1024;  // IDL sequence<.., 1024>

  // Clears the block; `most_bytes` bounds its size on the wire. It outlives the filler.
  BlockFiller(idl::SampleBlock& block, std::size_t most_bytes);
  // False: no room, and nothing is added. An empty block always has room for one.
  [[nodiscard]] bool add(ChannelIndex channel, const LastValue& value);
  // Columns that are the same in every row shrink. No more rows afterwards.
  void finish();

 private:
  idl::SampleBlock* block_;
  std::size_t most_bytes_;
  std::size_t bytes_;
  bool any_device_code_ = false, one_instant_ = true;
};

// Whether the columns fit together.
[[nodiscard]] bool is_whole(const idl::SampleBlock& block);
// All but the names. False, and `out` is not to be used, for an unknown kind or quality.
// REQUIRES: is_whole(), row in range.
[[nodiscard]] bool read_row(const idl::SampleBlock& block, std::size_t row, StationSample& out);

// ---- catalogue

// The entry of a block from the entry of the keyed topic.
void to_idl(const idl::Channel& channel, idl::CatalogueEntry& out);
// Whether its entries lie within the catalogue that it names.
[[nodiscard]] bool is_whole(const idl::CatalogueBlock& block);
[[nodiscard]] StationChannel from_idl(const idl::CatalogueBlock& block,
                                      const idl::CatalogueEntry& entry);

}  // namespace fieldcast
