#include "bridge/bridge_store.hpp"

#include <utility>

namespace fieldcast {

void BridgeStore::open(const StoreSpec& spec, AlarmTable& alarms) {
  alarms.expect_store();
  auto opened = std::make_unique<Store>(
      spec, [&alarms](Store& known, const KeptAlarms& kept) { alarms.loaded(known, kept); });
  {
    const std::lock_guard lock(mutex_);
    store_ = std::move(opened);
  }
  const StoreAddress address(spec.address);
  logins_ = std::make_unique<Authenticator>(address, *store_);
  identities_ = std::make_unique<CommandIdTable>(address);
}

void BridgeStore::close(AlarmTable& alarms) {
  identities_.reset();
  alarms.close(store_.get());
  std::unique_ptr<Store> last;  // destroyed without the lock
  const std::lock_guard lock(mutex_);
  last.swap(store_);
}

void BridgeStore::append(AuditEntry entry) {
  const std::lock_guard lock(mutex_);
  if (store_) store_->append(std::move(entry));
}

std::optional<StoreCounters> BridgeStore::counters() const {
  const std::lock_guard lock(mutex_);
  return store_ ? std::optional(store_->counters()) : std::nullopt;
}

void BridgeStore::save(Duration limit) {
  const std::lock_guard lock(mutex_);
  if (store_) (void)store_->flush(limit);
}

}  // namespace fieldcast
