// State of one bus at a station, from its blocks: catalogue, last values, missing blocks. A
// restarted bus has a greater epoch, and its table is rebuilt. A channel is reported once both its
// catalogue entry and a value are known. Pure; one owner.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bridge/dds/topics/block.hpp"
#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

class BusTable {
 public:
  // Null handlers are not called.
  struct Handlers {
    std::function<void(const StationChannel&)> channel;  // new or changed
    std::function<void(const StationSample&)> sample;    // newer than the last one
    std::function<void(const StationSample& last)> gone;
  };

  void on_catalogue(const idl::CatalogueBlock& block, const Handlers& handlers);
  // A catalogue block of this epoch was disposed or has no writer any more.
  void on_catalogue_gone(std::uint64_t epoch, std::uint32_t first, const Handlers& handlers);
  void on_samples(const idl::SampleBlock& block, const Handlers& handlers);

  // True if blocks are missing, or the last values have not arrived yet: a snapshot is needed.
  [[nodiscard]] bool wants_snapshot() const { return hole_ || !snapshot_; }
  // True if samples arrive with lower numbers than earlier ones: a new master has not received
  // those of the former. A snapshot request makes it continue above them.
  [[nodiscard]] bool is_behind() const { return behind_ > 0; }
  [[nodiscard]] bool is_known() const { return epoch_ != 0; }
  [[nodiscard]] std::uint64_t missing() const { return missing_; }  // blocks, of all epochs

  // Reports the known state to new handlers.
  void replay(const Handlers& handlers) const;

 private:
  struct Row {
    std::unique_ptr<StationChannel> entry;  // null: not known yet
    StationSample sample;                   // sequence 0: none yet; without names before its entry
    std::uint8_t below = 0;                 // samples with lower sequence numbers, up to kBehind
  };
  // One such sample may be a late one of a master that was replaced.
  static constexpr std::uint8_t kBehind = 2;
  // Returns false for an earlier epoch.
  bool enter(std::uint64_t epoch, const Handlers& handlers);
  [[nodiscard]] bool has_catalogue() const;
  void count(std::uint64_t number);
  Row* row(std::uint32_t channel);  // null: beyond the limit
  void came_below(Row& row);
  void caught_up(Row& row);
  void forget(Row& row, const Handlers& handlers);

  std::uint64_t epoch_ = 0;
  std::vector<Row> rows_;  // by number in the catalogue; at most kMaxChannels
  std::uint64_t last_number_ = 0;
  bool hole_ = false, snapshot_ = false;
  std::uint64_t missing_ = 0;
  std::size_t behind_ = 0;  // rows with kBehind such samples
};

// Assembles plans from their parts, in any order and of different plans. Pure; one owner.
class PlanParts {
 public:
  // Returns the whole plan if this part completes it.
  [[nodiscard]] std::optional<StationReadPlan> on_part(const idl::ReadPlan& part);
  void forget(const std::string& bus) { buses_.erase(bus); }

 private:
  struct Plan {
    std::uint64_t number = 0;
    // until the plan is complete; at most kMaxPlanBlocks
    std::map<std::uint32_t, idl::ReadPlan> parts;
  };
  std::map<std::string, Plan> buses_;  // as many as the reader has instances
};

}  // namespace fieldcast
