// SampleBlock and CatalogueBlock: conversion from core types, and back row by row. Data from DDS is
// not trusted: columns of different lengths and unknown kinds or qualities are rejected. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/dds/topics/topics.hpp"
#include "core/base/time.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/sample.hpp"
#include "idl/topics.h"

namespace fieldcast {

// ---- samples

// The last value of a channel in the form of the topics.
struct LastValue {
  idl::ValueKind kind = idl::ValueKind::VALUE_BOOLEAN;
  idl::Quality quality = idl::Quality::NOT_YET_READ;
  std::uint16_t device_code = 0;
  std::uint64_t bits = 0;        // of the value; not used for a text
  std::int64_t acquired_at = 0;  // UTC nanoseconds
  std::uint64_t sequence = 0;    // 0: never sampled
  std::string text;
};
// As to_idl(): a text that does not fit becomes an empty one of quality BAD_RANGE.
void to_last_value(const Sample& sample, const UtcMapping& mapping, LastValue& out);
// Only the value; changes the quality if a text does not fit.
void to_last_value(const Value& value, LastValue& out);
// Value of a row from its columns. Empty for an unknown kind or text.
using BlockTexts = std::remove_cvref_t<decltype(std::declval<idl::SampleBlock&>().texts())>;
[[nodiscard]] std::optional<Value> value_of(std::uint8_t kind, std::uint64_t bits,
                                            const BlockTexts& texts);

// Adds rows to a block until it is full.
class BlockFiller {
 public:
  static constexpr std::size_t kMaxRows = 1024;  // IDL sequence<.., 1024>

  // Clears the block, which must outlive the filler. `most_bytes` bounds its size on the wire.
  BlockFiller(idl::SampleBlock& block, std::size_t most_bytes);
  // Returns false, without the row, if it does not fit. An empty block has space for one row.
  [[nodiscard]] bool add(ChannelIndex channel, const LastValue& value);
  // Shortens columns that have the same value in every row. No rows may be added afterwards.
  void finish();

 private:
  idl::SampleBlock* block_;
  std::size_t most_bytes_;
  std::size_t bytes_;
  bool any_device_code_ = false, one_instant_ = true;
};

// Returns true if the lengths of the columns match.
[[nodiscard]] bool is_whole(const idl::SampleBlock& block);
// Fills all but the names. False for an unknown kind or quality. REQUIRES: is_whole(), row in
// range.
[[nodiscard]] bool read_row(const idl::SampleBlock& block, std::size_t row, StationSample& out);

// ---- catalogue

// Makes the entry of a block from the entry of the keyed topic.
void to_idl(const idl::Channel& channel, idl::CatalogueEntry& out);
// Returns true if its entries are within the catalogue that it names.
[[nodiscard]] bool is_whole(const idl::CatalogueBlock& block);
[[nodiscard]] StationChannel from_idl(const idl::CatalogueBlock& block,
                                      const idl::CatalogueEntry& entry);

}  // namespace fieldcast
