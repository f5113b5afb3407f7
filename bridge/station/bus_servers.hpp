// Determines from fieldcast/Bridge which bridges accept commands for a bus: the one that serves it,
// or, while none does, the members of its standby group, which keep a command until one of them is
// master. A bridge whose lease has expired accepts none.
//
// Callbacks run on DDS threads. takers() may be called on any thread.
#pragma once

#include <chrono>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "bridge/dds/receivers/lost_instances.hpp"
#include "bridge/dds/transport/domain.hpp"

namespace fieldcast {

class BusServers : private dds::DataReaderListener {
 public:
  using Participant = rtps::GuidPrefix_t;
  struct Taker {
    Participant participant;
    // First announcement. A bridge that shows no command endpoints some time later is forged.
    std::chrono::steady_clock::time_point since;
  };

  // `changed` is called whenever the result of takers() may have changed. Throws DdsError.
  BusServers(Domain& domain, std::function<void()> changed);
  ~BusServers() override;
  BusServers(const BusServers&) = delete;
  BusServers& operator=(const BusServers&) = delete;

  [[nodiscard]] std::vector<Taker> takers(const std::string& bus) const;

 private:
  using Handle = dds::InstanceHandle_t;
  struct Known {
    std::map<std::string, bool> buses;  // true: it serves the bus
    bool in_group = false;
    std::chrono::steady_clock::time_point since;
  };
  void on_data_available(dds::DataReader* reader) override;
  void on_subscription_matched(dds::DataReader* reader,
                               const dds::SubscriptionMatchedStatus& status) override;
  void on_liveliness_changed(dds::DataReader* reader,
                             const dds::LivelinessChangedStatus& status) override;

  static constexpr std::size_t kMostLost = 256;
  Domain& domain_;
  const std::function<void()> changed_;
  mutable std::mutex mutex_;       // never held while changed_ is called
  std::map<Handle, Known> known_;  // last announcement, by writer
  std::set<Handle> silent_;        // writers whose lease has expired
  LostInstances<Known> lost_{kMostLost};
  dds::DataReader* reader_;
};

}  // namespace fieldcast
