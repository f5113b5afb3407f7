// Caches instance handles by the bytes of their keys, so that a handle is computed once for each
// instance and not for each sample.
//
// Keys arrive in the same order again and again, because buses are read cyclically. So the entry
// after the last one found is compared first, in contiguous memory. A hash table alone costs as
// much time in cache misses as MD5 does in instructions.
//
// The bytes are from the network: at its limit the cache is cleared, and long keys are not stored.
// Any thread.
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

#include "bridge/dds/library/fastdds.hpp"

namespace fieldcast {

class KeyCache {
 public:
  using Handle = rtps::InstanceHandle_t;
  // bytes; handles of longer keys are computed each time
  static constexpr std::size_t kLongestKey = 108;

  // `limit` is the maximum number of keys.
  explicit KeyCache(std::size_t limit) : limit_(limit) {}

  // Returns the handle of these bytes; calls `work_out` if it is not cached.
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
    std::uint8_t length;
    std::array<char, kLongestKey> bytes;
    [[nodiscard]] std::string_view key() const { return {bytes.data(), length}; }
  };
  struct Hash : std::hash<std::string_view> {
    using is_transparent = void;
  };

  // REQUIRES: mutex_ held, a key that is not too long.
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
  std::vector<Entry> entries_;  // in the order of their first arrival
  std::unordered_map<std::string, std::size_t, Hash, std::equal_to<>> index_;
  std::size_t next_ = 0;  // entry after the last one found
};

}  // namespace fieldcast
