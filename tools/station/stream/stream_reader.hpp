// Reads the sites of the stream: values, alarms and the state of each site into the inbox, samples
// into the store. Each of three threads has a connection of its own, so that a long backlog of the
// record does not delay present values. Commands have a fourth one.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>

#include "bridge/store/store.hpp"
#include "tools/forward/outlet/nats/jetstream_spec.hpp"
#include "tools/station/live/domain_inbox.hpp"
#include "tools/station/record/recorder.hpp"
#include "tools/station/stream/site_commands.hpp"

namespace fieldcast::web {

class StreamReader {
 public:
  // `station`: its name, which names its position in the stream. `taken`: names of its DDS sites,
  // which a site of the stream may not have. `store` and `recorder` are null if nothing is
  // recorded; `store_address` is that of `store`. All must outlive this object. `on_alarm` is
  // called on a thread of this object and must not block.
  StreamReader(const forward::JetStreamSpec& spec, const std::string& station,
               std::set<std::string> taken, DomainInbox& inbox, Store* store,
               StoreAddress store_address, Recorder* recorder,
               std::function<void(const StationAlarmStatus&)> on_alarm = {});
  // Allows commands to the sites; their route exists as long as this object.
  [[nodiscard]] CommandRoute& allow_commands(SiteCommands::OnOutcome on_outcome);
  // Waits for the threads, a few seconds if a server does not respond.
  ~StreamReader();
  StreamReader(const StreamReader&) = delete;
  StreamReader& operator=(const StreamReader&) = delete;

  struct Counters {
    std::uint64_t messages = 0;  // with present samples
    std::uint64_t refused = 0;   // messages that could not be decoded
    std::uint64_t recorded = 0;  // samples passed to the store
    std::uint64_t repeated = 0;  // samples that were received before
  };
  [[nodiscard]] Counters counters() const;  // any thread

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::web
