// Merges the records of each device, so that a long queue is sent in few messages. Pure; one owner.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "tools/forward/batch/record.hpp"
#include "tools/forward/batch/sample_batch.hpp"

namespace fieldcast::forward {

class Merging {
 public:
  Merging(std::size_t most_bytes, std::size_t most_samples)
      : most_bytes_(most_bytes), most_samples_(most_samples) {}

  // REQUIRES: ids ascend. A record that cannot be merged stays as it is, and no later record of its
  // device is merged with an earlier one.
  void add(Record record, bool can_merge);

  struct Result {
    std::vector<Record> records;         // by id; merged ones have the id of their first record
    std::set<std::uint64_t> merged;      // ids of records whose content has changed
    std::vector<std::uint64_t> removed;  // ids of records that are part of a merged one
  };
  [[nodiscard]] Result take();

 private:
  struct Group {
    std::size_t record = 0;  // index in result_.records
    std::size_t bytes = 0;
    std::vector<SampleBatch> parts;  // decoded when there is a second one
  };
  // Returns false if the record begins a group of its own.
  [[nodiscard]] bool join(Group& group, const Record& record);
  void end(const Group& group);

  const std::size_t most_bytes_, most_samples_;
  std::map<Lane, Group> groups_;
  Result result_;
};

}  // namespace fieldcast::forward
