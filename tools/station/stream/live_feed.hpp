// Passes the newest samples of the stream to the model. Used by one thread.
#pragma once

#include <string>
#include <unordered_map>

#include "tools/station/live/domain_inbox.hpp"
#include "tools/station/stream/stream_batch.hpp"

namespace fieldcast::web {

class LiveFeed {
 public:
  static constexpr std::size_t kMaxDevices = 100'000;  // further ones are left out
  // A good value of an older message is uncertain: it may have changed since.
  static constexpr Duration kOld = std::chrono::seconds{30};

  explicit LiveFeed(DomainInbox& inbox) : inbox_(inbox) {}

  // Announces the channels of the device if its catalogue has changed. Ignores late samples.
  // `now`: by the clock of this station.
  void pass(const StreamBatch& batch, UtcTime now);

 private:
  void announce(const SharedCatalogue& before, const SharedCatalogue& now);

  DomainInbox& inbox_;
  std::unordered_map<std::string, SharedCatalogue> devices_;  // present one, by "SITE:BUS/DEVICE"
};

}  // namespace fieldcast::web
