#include "tools/cli/session.hpp"

namespace fieldcast::cli {

Session::Session(const DdsSpec& spec, Interrupt& interrupt)
    : interrupt_(interrupt), station_(spec, "fieldcast-cli") {
  interrupt_.on_raise([this] { inbox_.close(); });
}

Session::~Session() { interrupt_.on_raise({}); }

void Session::hear_channels() {
  station_.subscribe_channels([this](const StationChannel& channel) { inbox_.put(channel); },
                              [this](const auto& bus, const auto& device, const auto& channel) {
                                inbox_.put(ChannelGone{{bus, device, channel}});
                              });
}

void Session::hear_samples() {
  station_.subscribe_samples([this](const StationSample& sample) { inbox_.put(sample); },
                             [this](const auto& bus, const auto& device, const auto& channel) {
                               inbox_.put(ChannelGone{{bus, device, channel}});
                             });
}

void Session::hear_status() {
  station_.subscribe_bus_status([this](const StationBusStatus& status) { inbox_.put(status); });
  station_.subscribe_device_status(
      [this](const StationDeviceStatus& status) { inbox_.put(status); });
}

void Session::hear_alarms() {
  station_.subscribe_alarms([this](const StationAlarm& alarm) { inbox_.put(alarm); },
                            [this](const StationAlarm& last) { inbox_.put(AlarmGone{last}); });
}

void Session::hear_results() {
  station_.on_result([this](const StationResult& result) { inbox_.put(result); });
}

void Session::hear_program_sessions() {
  station_.subscribe_bus_status([this](const StationBusStatus& status) { inbox_.put(status); });
  station_.subscribe_program_sessions(
      [this](const ProgramSessionReport& session) { inbox_.put(session); });
}

}  // namespace fieldcast::cli
