// Instance handles by the bytes of their keys, so that a handle is worked out once for each
// instance and not for each sample.
//
// Keys come in the same order again and again, as buses are read: the key that was added after the
// last one is looked at first, in memory that lies side by side. A hash table for all of them costs
// as much time in cache misses as MD5 does in instructions.
//
// Bytes come from the network: at its limit the cache is emptied and begins anew, and long keys are
// not kept. Any thread.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "bridge/dds/fastdds.hpp"

namespace fieldcast {

class KeyCache {
 public:
  using Handle = rtps::InstanceHandle_t;
  static constexpr std::size_t kLongestKey = 108;  // bytes; longer ones are worked out each time

  // At most so many keys are kept.
  explicit KeyCache(std::size_t limit) : limit_(limit) {}

  // The handle of these bytes; `work_out` is called where they are not known.
  template <class WorkOut>
  [[nodiscard]] Handle handle_of(std::string_view bytes, WorkOut&& work_out) {
    const std::lock_guard lock(mutex_);
    if (next_ < entries_.size() && entries_[next_].key() == bytes) return entries_[next_++].handle;
    if (bytes.size() > kLongestKey) return work_out();
    const auto known = index_.find(bytes);
    if (known == index_.end()) return add(bytes, work_out());
    next_ = known->second;
    return entries_[next_++].handle;
  }
  [[nodiscard]] std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return entries_.size();
  }

 private:
  struct Entry {
    Handle handle;
    std::uint8_t length;  // of the key
    std::array<char, kLongestKey> bytes;
    [[nodiscard]] std::string_view key() const { return {bytes.data(), length}; }
  };
  struct Hash : std::hash<std::string_view> {
    using is_transparent = void;
  };

  // REQUIRES: mutex_ held, a key that is not long.
  const Handle& add(std::string_view bytes, const Handle& handle) {
    if (entries_.size() >= limit_) {
      entries_.clear();
      index_.clear();
    }
    index_.emplace(bytes, entries_.size());
    Entry& entry = entries_.emplace_back();
    entry.handle = handle;
    entry.length = static_cast<std::uint8_t>(bytes.size());
    std::copy(bytes.begin(), bytes.end(), entry.bytes.begin());
    next_ = entries_.size();
    return entry.handle;
  }

  const std::size_t limit_;
  mutable std::mutex mutex_;
  std::vector<Entry> entries_;  // in the order in which they came first
  std::unordered_map<std::string, std::size_t, Hash, std::equal_to<>> index_;  // into entries_
  std::size_t next_ = 0;  // the entry behind the last one that was found
};

}  // namespace fieldcast
