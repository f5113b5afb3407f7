// Publishes audit entries on DDS and passes them to the store, if there is one. Never blocks: of
// too many entries that wait, the oldest ones are not published.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/base/worker.hpp"
#include "bridge/store/records/records.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

class AuditPublisher final : public Audit {
 public:
  static constexpr std::size_t kMaxWaiting = 4096;

  // `store` may be null and must outlive this object. `publish` runs on a thread of this object.
  AuditPublisher(std::string bridge, Audit* store, std::function<void(const AuditReport&)> publish)
      : bridge_(std::move(bridge)),
        store_(store),
        worker_("audit", kMaxWaiting, [this, publish = std::move(publish)](auto& entries) {
          while (const auto entry = entries.take()) publish(report_of(*entry));
        }) {}

  void append(AuditEntry entry) override {
    if (entry.at.nanoseconds == 0) entry.at = read_clocks().utc;
    worker_.queue().put_newest(entry);
    if (store_ != nullptr) store_->append(std::move(entry));
  }

 private:
  AuditReport report_of(const AuditEntry& entry) {
    return {bridge_,
            epoch_,
            ++number_,
            entry.at,
            entry.who,
            entry.what,
            entry.target,
            entry.bytes_to_device,
            entry.bytes_from_device,
            entry.result};
  }

  const std::string bridge_;
  Audit* const store_;
  const std::uint64_t epoch_ = static_cast<std::uint64_t>(read_clocks().utc.nanoseconds);
  std::uint64_t number_ = 0;   // of the worker's thread
  Worker<AuditEntry> worker_;  // last: it uses the members above
};

}  // namespace fieldcast
