#include "tools/station/stream/stream_reader.hpp"

#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "tools/station/stream/stream_shared.hpp"

namespace fieldcast::web {

struct StreamReader::State {
  StreamShared shared;
  std::vector<std::thread> threads;
  std::optional<SiteCommands> commands;
};

StreamReader::StreamReader(const forward::JetStreamSpec& spec, const std::string& station,
                           std::set<std::string> taken, DomainInbox& inbox, Store* store,
                           StoreAddress store_address, Recorder* recorder,
                           std::function<void(const StationAlarmStatus&)> on_alarm)
    : state_(std::make_unique<State>()) {
  StreamShared& shared = state_->shared;
  shared.spec = spec;
  shared.station = station;
  shared.store = std::move(store_address);
  shared.sites.reserve(std::move(taken));
  const bool records = store != nullptr && recorder != nullptr;
  state_->threads.emplace_back([&shared, &inbox, recorder, on_alarm = std::move(on_alarm)] {
    run_state(shared, inbox, recorder, on_alarm);
  });
  state_->threads.emplace_back([&shared, &inbox, records] { run_live(shared, inbox, !records); });
  if (records) state_->threads.emplace_back([&shared, store] { run_record(shared, *store); });
}

StreamReader::~StreamReader() {
  constexpr std::int64_t kCloseMs = 5'000;
  state_->shared.end();
  for (std::thread& thread : state_->threads) thread.join();
  if (state_->commands) state_->commands->close();
  nats_CloseAndWait(kCloseMs);
}

CommandRoute& StreamReader::allow_commands(SiteCommands::OnOutcome on_outcome) {
  StreamShared& shared = state_->shared;
  shared.commands = true;
  return state_->commands.emplace(shared.spec, shared.station, std::move(on_outcome));
}

StreamReader::Counters StreamReader::counters() const {
  const StreamShared& shared = state_->shared;
  return {shared.messages, shared.refused, shared.recorded, shared.repeated};
}

}  // namespace fieldcast::web
