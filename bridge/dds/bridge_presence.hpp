// Announces the buses that this bridge serves and receives the announcements of other bridges in
// the domain. Calls come on DDS threads.
//
// With DDS Security, an announcement is accepted only from the member that has the name of the
// bridge: one bridge cannot speak under the name of another.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "bridge/dds/dds_link.hpp"
#include "bridge/dds/domain.hpp"
#include "bridge/dds/lost_instances.hpp"
#include "bridge/dds/request_terms.hpp"
#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

class BridgePresence : private dds::DataReaderListener {
 public:
  // `identities` outlives this object. `on_problem` gets a text for the log.
  BridgePresence(Domain& domain, const RequestWriters& identities, const std::string& label,
                 DdsLink::BridgeHandlers handlers,
                 std::function<void(std::string text)> on_problem);
  [[nodiscard]] std::string id() const;       // as the others know it
  void announce(const BridgeClaims& claims);  // one call at a time
  void close();  // the others see it go; nothing is handed on after it returns

 private:
  using Handle = dds::InstanceHandle_t;
  void on_data_available(dds::DataReader* reader) override;
  void on_subscription_matched(dds::DataReader* reader,
                               const dds::SubscriptionMatchedStatus& status) override;
  void on_liveliness_changed(dds::DataReader* reader,
                             const dds::LivelinessChangedStatus& status) override;
  [[nodiscard]] bool is_own(const Handle& writer) const;
  // Removes what a writer announced before. REQUIRES: mutex_ held.
  void refuse(const Handle& writer, const std::string& bridge, const std::string& subject);
  void matched(const Handle& writer);
  void unmatched(const Handle& writer);

  static constexpr std::size_t kMostLost = 256;  // bridges
  Domain& domain_;
  const RequestWriters& identities_;
  const DdsLink::BridgeHandlers handlers_;
  const std::function<void(std::string)> on_problem_;
  dds::DataWriter* writer_;
  idl::Bridge announced_;
  // The reader is called on any of the participant's threads; what it said is handed on in order.
  std::mutex mutex_;
  std::map<Handle, BridgeClaims> known_;  // by writer: what it said last
  LostInstances<BridgeClaims> lost_{kMostLost};
  dds::DataReader* reader_;  // last: from its making on it calls what uses the above
};

}  // namespace fieldcast
