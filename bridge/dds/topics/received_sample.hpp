// Caches instance handles by the bytes of their keys. Keys arrive in the same order again and
// again, because buses are read cyclically: the entry after the last one found is compared first. A
// hash table alone costs as much time in cache misses as MD5 does. The bytes are from the network:
// at its limit the cache is cleared, and long keys are not stored. Any thread.
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
#include "bridge/dds/topics/topic_type.hpp"
#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/dds/topics/topics.hpp"

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

// Sample in the form in which a station reads it: parsed from its bytes, without the generated
// code, which copies strings three times. Its handles are those of the generated type, as of other
// vendors. A reader of Fast DDS 2.9.1 reads each message twice (DataReaderHistory), the first time
// for its key: then only the bytes of the key are parsed.
struct ReceivedSample {
  StationSample sample;
  // True if its value and quality are of kinds that the IDL names.
  bool is_known = false;
  // True if the library made it to find the keys of messages: then only the handle is filled.
  bool for_key = false;
  rtps::InstanceHandle_t handle;
};

class ReceivedSampleType : public TopicType<idl::SamplePubSubType> {
  using Base = TopicType<idl::SamplePubSubType>;

 public:
  using Message = ReceivedSample;

  explicit ReceivedSampleType(std::size_t keys = kMaxChannels) : cache_(keys) {}

  void* new_message() override { return new ReceivedSample{.for_key = true}; }
  void delete_message(void* message) override { delete static_cast<ReceivedSample*>(message); }

  // Returns false for other bytes. A message that ends early gets empty names: it replaces no
  // value.
  bool from_bytes(Payload& payload, void* data) override;
  // REQUIRES: `data` is a message of new_message() that was read last on this thread.
  bool key_of(const void* data, Handle& key, bool) override {
    key = static_cast<const ReceivedSample*>(data)->handle;
    return true;
  }

  [[nodiscard]] std::size_t known_keys() const { return cache_.size(); }

 private:
  // Throws the exceptions of CdrReader.
  [[nodiscard]] Handle handle_of(const Payload& payload);
  // Key hash of the generated type.
  [[nodiscard]] Handle hash_of(std::string_view bus, std::string_view device,
                               std::string_view channel);

  KeyCache cache_;
};

}  // namespace fieldcast
