// Announces the buses that this bridge serves and receives the announcements of other bridges, on
// DDS threads. With DDS Security, an announcement is accepted only from the member that has the
// name of the bridge, so a bridge cannot announce under the name of another.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "bridge/dds/endpoints/dds_link.hpp"
#include "bridge/dds/receivers/request_receiver.hpp"
#include "bridge/dds/receivers/taker.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/transport/domain.hpp"

namespace fieldcast {

class BridgeAnnouncement : private dds::DataReaderListener {
 public:
  // `identities` must outlive this object. `on_problem` receives a text for the log.
  BridgeAnnouncement(Domain& domain, const RequestWriters& identities, const std::string& label,
                     DdsLink::BridgeHandlers handlers,
                     std::function<void(std::string text)> on_problem);
  [[nodiscard]] std::string id() const;       // the identity that other bridges see
  void announce(const BridgeClaims& claims);  // one call at a time
  // Waits at most `limit` until bridges and stations have received the last announcement.
  void wait_for_readers(Duration limit) { writer_->wait_for_acknowledgments(to_dds(limit)); }
  void close();  // withdraws the announcement; no handler is called after it returns

 private:
  using Handle = dds::InstanceHandle_t;
  void on_data_available(dds::DataReader* reader) override;
  void on_subscription_matched(dds::DataReader* reader,
                               const dds::SubscriptionMatchedStatus& status) override;
  void on_liveliness_changed(dds::DataReader* reader,
                             const dds::LivelinessChangedStatus& status) override;
  [[nodiscard]] bool is_own(const Handle& writer) const;
  // Removes the earlier announcement of a writer. REQUIRES: mutex_ held.
  void refuse(const Handle& writer, const std::string& bridge, const std::string& subject);
  void matched(const Handle& writer);
  void unmatched(const Handle& writer);

  static constexpr std::size_t kMostLost = 256;
  Domain& domain_;
  const RequestWriters& identities_;
  const DdsLink::BridgeHandlers handlers_;
  const std::function<void(std::string)> on_problem_;
  dds::DataWriter* writer_;
  idl::Bridge announced_;
  // Keeps the order of announcements, as any thread of the participant may call the reader.
  std::mutex mutex_;
  std::map<Handle, BridgeClaims> known_;  // last announcement, by writer
  LostInstances<BridgeClaims> lost_{kMostLost};
  // last member: its callbacks use the members above as soon as it exists
  dds::DataReader* reader_;
};

}  // namespace fieldcast
