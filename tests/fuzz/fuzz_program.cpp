// Fuzzes the connection of an engineer's client, cut as the input says. Memory must stay bounded, a
// device is released exactly as often as it was leased, and no action follows the end. The same
// stream is also the response of a bridge to a client that requests the list of devices.
//
// Input: the size of a piece(1), then the stream.
#include <cstdlib>

#include "core/program/engineer.hpp"
#include "core/program/list_client.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace fieldcast::program {
namespace {

// A hostile bridge: the list stays bounded, and its texts can be printed.
void run_client(ByteView data, std::size_t piece) {
  ListClient client("anna", "secret");
  bool over = false;
  for (std::size_t at = 0; at < data.size(); at += piece) {
    const auto result = client.on_bytes(data.subspan(at, std::min(piece, data.size() - at)));
    fuzz::require(!over || !result);
    if (!result) continue;
    over = true;
    if (!*result) {
      fuzz::require(!result->error().text.empty());
      continue;
    }
    fuzz::require((*result)->devices.size() <= kMaxListed);
    for (const ListedDevice& device : (*result)->devices)
      fuzz::require(is_device_number(device.number) && is_name_in_line(device.bus) &&
                    is_name_in_line(device.device) &&
                    device.state <= ListedDevice::State::kNotOnline);
  }
}

void run_one(ByteView data) {
  if (data.empty()) return;
  const std::size_t piece = data[0] + 1u;
  data = data.subspan(1);
  run_client(data, piece);
  Instant now{std::chrono::seconds{1}};
  Engineer engineer(EngineerRules{}, now);
  int taken = 0, freed = 0, hung_up = 0;
  unsigned lists = 0;  // since the last pairing
  const auto tell = [&](const EngineerEvent& event) {
    EngineerActions actions;
    engineer.on_event(event, now, actions);
    if (hung_up > 0 && !actions.empty()) std::abort();
    bool asks = false, logs_in = false, lists_devices = false;
    for (const auto& action : actions) {
      taken += std::holds_alternative<TakeDevice>(action);
      freed += std::holds_alternative<FreeDevice>(action);
      hung_up += std::holds_alternative<HangUp>(action);
      asks = asks || std::holds_alternative<TakeDevice>(action);
      logs_in = logs_in || std::holds_alternative<CheckLogin>(action);
      lists_devices = lists_devices || std::holds_alternative<ListDevices>(action);
    }
    lists = asks ? 0 : lists + (lists_devices ? 1 : 0);
    if (lists > Engineer::kMaxLists) std::abort();
    return asks ? 1 : logs_in ? 2 : lists_devices ? 3 : 0;
  };
  const auto settle = [&](int pending) {
    for (int round = 0; pending != 0 && round < 100; ++round) {
      pending = pending == 1   ? tell(DeviceGiven{})
                : pending == 2 ? tell(LoginChecked{true, {}})
                               : tell(DevicesListed{std::vector<ListedDevice>(3)});
    }
  };
  while (!data.empty()) {
    const ByteView part = data.first(std::min(piece, data.size()));
    data = data.subspan(part.size());
    settle(tell(FromClient{part}));
    settle(tell(FromDevice{part}));
    now += std::chrono::milliseconds{700};
    settle(tell(TimerFired{}));
  }
  settle(tell(ClientGone{"end"}));
  if (taken != freed || hung_up != 1) std::abort();
}

}  // namespace
}  // namespace fieldcast::program

FIELDCAST_FUZZ_TARGET(fieldcast::program::run_one)
