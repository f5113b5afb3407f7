// What a station knows of one bus from its blocks: the catalogue, the last value of each channel,
// and whether blocks are missing. Pure: no DDS entity, no clock, no thread; one owner.
//
// A bus that starts anew has a greater epoch, and its table begins anew with the catalogue of that
// epoch. A channel is reported once its catalogue entry and a value are known, whichever comes
// first.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bridge/dds/topics/block.hpp"

namespace fieldcast {

class BusTable {
 public:
  // Those that are null are not called.
  struct Handlers {
    std::function<void(const StationChannel&)> channel;  // new, or changed
    std::function<void(const StationSample&)> sample;    // newer than what came before
    std::function<void(const StationSample& last)> gone;
  };

  void on_catalogue(const idl::CatalogueBlock& block, const Handlers& handlers);
  // A catalogue block of this epoch is gone: disposed, or nobody writes it any more.
  void on_catalogue_gone(std::uint64_t epoch, std::uint32_t first, const Handlers& handlers);
  void on_samples(const idl::SampleBlock& block, const Handlers& handlers);

  // Blocks are missing, or the last values have not come yet: a snapshot is wanted.
  [[nodiscard]] bool wants_snapshot() const { return hole_ || !snapshot_; }
  // Samples come that count below those that were taken before: of a master of a standby group that
  // has not heard of another one. It counts above them when it is asked for a snapshot.
  [[nodiscard]] bool is_behind() const { return behind_ > 0; }
  [[nodiscard]] bool is_known() const { return epoch_ != 0; }
  [[nodiscard]] std::uint64_t missing() const { return missing_; }  // blocks, of all epochs

  // Everything that is known, to handlers that are new.
  void replay(const Handlers& handlers) const;

 private:
  struct Row {
    std::unique_ptr<StationChannel> entry;  // null: not known yet
    StationSample sample;                   // sequence 0: none yet; without names before its entry
    std::uint8_t below = 0;                 // samples that counted below it, up to kBehind
  };
  // Of one the sender may be a master that was replaced, and whose sample was late.
  static constexpr std::uint8_t kBehind = 2;
  // False: of an epoch that is over.
  bool enter(std::uint64_t epoch, const Handlers& handlers);
  [[nodiscard]] bool has_catalogue() const;
  void count(std::uint64_t number);
  Row* row(std::uint32_t channel);  // null: beyond every bound
  void came_below(Row& row);
  void caught_up(Row& row);
  void forget(Row& row, const Handlers& handlers);

  std::uint64_t epoch_ = 0;
  std::vector<Row> rows_;  // by number in the catalogue; at most kMaxChannels
  std::uint64_t last_number_ = 0;
  bool hole_ = false, snapshot_ = false;
  std::uint64_t missing_ = 0;
  std::size_t behind_ = 0;  // rows with kBehind samples below
};

}  // namespace fieldcast
