#include "tools/cli/doctor/clocks.hpp"

#include <map>

#include "bridge/base/bounded_queue.hpp"
#include "bridge/dds/library/dds_error.hpp"
#include "bridge/station/sites.hpp"
#include "tools/cli/terminal/clock.hpp"
#include "tools/cli/terminal/interrupt.hpp"

namespace fieldcast::cli {

void gather_clocks(const ConnectionOptions& options, MachineFacts& facts) {
  Interrupt interrupt;  // before DDS starts its threads
  const auto connection = resolve(options);
  if (!connection) {
    facts.clocks_unknown = connection.error();
    return;
  }
  BoundedQueue<ClockFacts> inbox{1024};
  std::map<std::string, ClockFacts> clocks;
  interrupt.on_raise([&inbox] { inbox.close(); });
  try {
    Sites sites(connection->sites, "fieldcast-cli");
    sites.subscribe_bus_status([&inbox](const StationBusStatus& status) {
      if (status.clock_ahead) inbox.put_newest({status.bridge, *status.clock_ahead, utc_now()});
    });
    const Instant end = instant_now() + kListenForClocks;
    while (instant_now() < end && !inbox.closed()) {
      for (const ClockFacts& heard : inbox.take_all(to_steady(end))) clocks[heard.bridge] = heard;
    }
  } catch (const DdsError& error) { facts.clocks_unknown = error.what(); }
  interrupt.on_raise({});
  for (const auto& [bridge, clock] : clocks) facts.clocks.push_back(clock);
}

}  // namespace fieldcast::cli
