// Fuzzes the connection of an engineer's client, cut as the input says. Memory must stay bounded, a
// device is released exactly as often as it was leased, and no action follows the end.
//
// Input: the size of a piece(1), then the stream.
#include <cstdlib>

#include "core/program/engineer.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace fieldcast::program {
namespace {

void run_one(ByteView data) {
  if (data.empty()) return;
  const std::size_t piece = data[0] + 1u;
  data = data.subspan(1);
  Instant now{std::chrono::seconds{1}};
  Engineer engineer(EngineerRules{}, now);
  int taken = 0, freed = 0, hung_up = 0;
  const auto tell = [&](const EngineerEvent& event) {
    EngineerActions actions;
    engineer.on_event(event, now, actions);
    if (hung_up > 0 && !actions.empty()) std::abort();
    bool asks = false, logs_in = false;
    for (const auto& action : actions) {
      taken += std::holds_alternative<TakeDevice>(action);
      freed += std::holds_alternative<FreeDevice>(action);
      hung_up += std::holds_alternative<HangUp>(action);
      asks = asks || std::holds_alternative<TakeDevice>(action);
      logs_in = logs_in || std::holds_alternative<CheckLogin>(action);
    }
    return asks ? 1 : logs_in ? 2 : 0;
  };
  const auto settle = [&](int pending) {
    for (int round = 0; pending != 0 && round < 100; ++round) {
      pending = pending == 1 ? tell(DeviceGiven{}) : tell(LoginChecked{true, {}});
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
