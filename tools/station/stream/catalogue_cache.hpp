// The catalogues of devices that samples of the stream refer to. Any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <tl/expected.hpp>
#include <unordered_map>

#include "core/base/time.hpp"
#include "tools/station/stream/stream_batch.hpp"

namespace fieldcast::web {

enum class EntryFault : std::uint8_t {
  kMissing,
  kUnavailable,  // the server did not respond: it may exist
};

class CatalogueCache {
 public:
  // When the catalogues have more channels than this, all are read again.
  static constexpr std::size_t kMaxChannels = 300'000;
  // A catalogue that the bucket does not have is requested again after this time.
  static constexpr Duration kMissing = std::chrono::seconds{2};
  static constexpr std::size_t kMaxMissing = 10'000;

  // Reads the entry of the bucket with that key. May block for seconds.
  using Read = std::function<tl::expected<std::string, EntryFault>(const std::string& key)>;
  // Returns null if it is missing or cannot be decoded.
  [[nodiscard]] SharedCatalogue find(const std::string& site, const std::string& bus,
                                     const std::string& device, std::uint64_t identity, Instant now,
                                     const Read& read);
  // Keeps an entry that was read with others. Ignores one that cannot be decoded. Returns false if
  // there is no space for further ones.
  bool add(const std::string& key, const std::string& content);

 private:
  // REQUIRES: mutex_ is held.
  SharedCatalogue keep(const std::string& key, forward::DeviceCatalogue catalogue);

  std::mutex mutex_;                                        // not held while an entry is read
  std::unordered_map<std::string, SharedCatalogue> known_;  // by key
  std::unordered_map<std::string, Instant> missing_;        // until when, by key
  std::size_t channels_ = 0;
};

}  // namespace fieldcast::web
