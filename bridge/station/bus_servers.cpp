#include "bridge/station/bus_servers.hpp"

#include <utility>

#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

BusServers::BusServers(Domain& domain, std::function<void()> changed)
    : domain_(domain),
      changed_(std::move(changed)),
      reader_(domain.reader(kBridgeTopic, this,
                            dds::StatusMask::data_available()
                                << dds::StatusMask::subscription_matched()
                                << dds::StatusMask::liveliness_changed())) {}

BusServers::~BusServers() { domain_.remove(reader_); }

std::vector<BusServers::Taker> BusServers::takers(const std::string& bus) const {
  std::vector<Taker> serving, keeping;
  const std::lock_guard lock(mutex_);
  for (const auto& [writer, known] : known_) {
    const auto found = known.buses.find(bus);
    if (found == known.buses.end() || silent_.contains(writer)) continue;
    const Taker taker{rtps::iHandle2GUID(writer).guidPrefix, known.since};
    if (found->second) serving.push_back(taker);
    if (known.in_group) keeping.push_back(taker);
  }
  return serving.empty() ? keeping : serving;
}

void BusServers::on_data_available(dds::DataReader* reader) {
  {
    const std::lock_guard lock(mutex_);
    idl::Bridge received;
    dds::SampleInfo info;
    while (reader->take_next_sample(&received, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      const StationBridge bridge = station_bridge(received);
      const auto before = known_.find(info.publication_handle);
      Known said{.in_group = !bridge.standby_group.empty(),
                 .since = before == known_.end() ? std::chrono::steady_clock::now()
                                                 : before->second.since};
      for (const auto& bus : bridge.buses) said.buses[bus.bus] = bus.serving;
      lost_.forget(info.publication_handle, info.publication_handle);
      known_[info.publication_handle] = std::move(said);
    }
  }
  changed_();
}

// Restores the buses of a bridge that was lost because of the network, before its announcements.
void BusServers::on_subscription_matched(dds::DataReader*,
                                         const dds::SubscriptionMatchedStatus& status) {
  const Handle& writer = status.last_publication_handle;
  {
    const std::lock_guard lock(mutex_);
    silent_.erase(writer);
    if (status.current_count_change > 0) {
      for (auto& [instance, said] : lost_.take(writer))
        known_.try_emplace(instance, std::move(said));
    } else if (auto node = known_.extract(writer)) {
      lost_.keep(writer, writer, std::move(node.mapped()));
    }
  }
  changed_();
}

void BusServers::on_liveliness_changed(dds::DataReader*,
                                       const dds::LivelinessChangedStatus& status) {
  const Handle writer(status.last_publication_handle);
  {
    const std::lock_guard lock(mutex_);
    if (status.alive_count_change < 0) silent_.insert(writer);
    if (status.alive_count_change > 0) silent_.erase(writer);
  }
  changed_();
}

}  // namespace fieldcast
