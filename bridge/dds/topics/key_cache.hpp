// Instance handles by the bytes of their keys, so that a handle is worked out once for each
// instance and not for each sample (MD5 and what leads to it took a tenth of a reader's time).
//
// Bytes come from the network: at its limit the cache is emptied and begins anew. Any thread.
#pragma once

#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>

#include "bridge/dds/fastdds.hpp"

namespace fieldcast {

class KeyCache {
 public:
  using Handle = rtps::InstanceHandle_t;

  // At most so many keys are kept.
  explicit KeyCache(std::size_t limit) : limit_(limit) {}

  // The handle of these bytes; `work_out` is called where they are not known.
  template <class WorkOut>
  [[nodiscard]] Handle handle_of(std::string_view bytes, WorkOut&& work_out) {
    const std::lock_guard lock(mutex_);
    if (const auto known = handles_.find(bytes); known != handles_.end()) return known->second;
    if (handles_.size() >= limit_) handles_.clear();
    return handles_.emplace(bytes, work_out()).first->second;
  }
  [[nodiscard]] std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return handles_.size();
  }

 private:
  struct Hash : std::hash<std::string_view> {
    using is_transparent = void;
  };
  const std::size_t limit_;
  mutable std::mutex mutex_;
  std::unordered_map<std::string, Handle, Hash, std::equal_to<>> handles_;
};

}  // namespace fieldcast
