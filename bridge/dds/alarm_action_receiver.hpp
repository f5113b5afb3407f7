// Receives AlarmAction: converts it, refuses what came too late, and hands it on. Calls come on DDS
// threads.
#pragma once

#include <functional>
#include <string>

#include "bridge/dds/command_receiver.hpp"

namespace fieldcast {

class AlarmActionReceiver : private dds::DataReaderListener {
 public:
  struct Handlers {
    std::function<UtcMapping()> clock;
    // Actions for other buses belong to other bridges.
    std::function<bool(const std::string& bus)> is_ours;
    std::function<void(AlarmAction action)> accepted;
    // Malformed, older than this receiver, or later than its writer's LIFESPAN.
    std::function<void(const idl::AlarmAction& action, const MalformedCommand& why)> refused;
    // Called before accepted() or refused().
    std::function<void(const std::string& requester, const CommandLifespans::Guid& writer)>
        received;
    // For the log: an action was dropped.
    std::function<void(std::string text)> on_problem;
  };
  AlarmActionReceiver(Domain& domain, const CommandLifespans& lifespans, Handlers handlers,
                      HeldTo bus = {});
  void close();  // nothing is handed on after it returns

 private:
  void on_data_available(dds::DataReader* reader) override;
  void take(const idl::AlarmAction& action, const dds::SampleInfo& info);

  Domain& domain_;
  const CommandLifespans& lifespans_;
  const Handlers handlers_;
  const HeldTo bus_;
  const Instant listening_;  // since when
  dds::DataReader* reader_ = nullptr;
};

}  // namespace fieldcast
