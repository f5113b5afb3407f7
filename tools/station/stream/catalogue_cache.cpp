#include "tools/station/stream/catalogue_cache.hpp"

#include <utility>

#include "tools/forward/outlet/nats/subject.hpp"
#include "tools/station/stream/message_decoder.hpp"

namespace fieldcast::web {

SharedCatalogue CatalogueCache::find(const std::string& site, const std::string& bus,
                                     const std::string& device, std::uint64_t identity, Instant now,
                                     const Read& read) {
  const std::string key = forward::catalogue_key_of(site, bus, device, identity);
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = known_.find(key); found != known_.end()) return found->second;
    if (const auto found = missing_.find(key); found != missing_.end() && now < found->second)
      return nullptr;
  }
  const auto entry = read(key);
  if (!entry && entry.error() == EntryFault::kUnavailable) return nullptr;
  auto decoded = entry ? decode_catalogue(site, *entry) : tl::make_unexpected(DecodeFault::kForm);
  const std::lock_guard lock(mutex_);
  if (!decoded) {
    if (missing_.size() >= kMaxMissing) missing_.clear();
    missing_[key] = now + kMissing;
    return nullptr;
  }
  if (channels_ >= kMaxChannels) {
    known_.clear();
    channels_ = 0;
  }
  return keep(key, *std::move(decoded));
}

SharedCatalogue CatalogueCache::keep(const std::string& key, forward::DeviceCatalogue catalogue) {
  missing_.erase(key);
  channels_ += catalogue.channels.size();
  return known_[key] = std::make_shared<const forward::DeviceCatalogue>(std::move(catalogue));
}

bool CatalogueCache::add(const std::string& key, const std::string& content) {
  auto decoded = decode_catalogue(forward::name_of_token(key.substr(0, key.find('.'))), content);
  const std::lock_guard lock(mutex_);
  if (channels_ >= kMaxChannels) return false;
  if (decoded && !known_.contains(key)) (void)keep(key, *std::move(decoded));
  return true;
}

}  // namespace fieldcast::web
