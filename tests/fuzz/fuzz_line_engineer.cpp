// Fuzzes the port of one device for programming software (RFC 2217 or raw bytes, with or without a
// login), cut as the input says. What the client gets is bounded, a device is released exactly as
// often as it was leased, and no action follows the end.
//
// Input: 1 raw + 2 login(1), size of a piece(1), then the stream.
#include "core/program/line_engineer.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace fieldcast::program {
namespace {

class Run {
 public:
  Run(bool telnet, bool login_needed) : engineer_(rules(telnet, login_needed), now_) {}

  void tell(const EngineerEvent& event) {
    EngineerActions actions;
    engineer_.on_event(event, now_, actions);
    fuzz::require(hung_up == 0 || actions.empty());
    EngineerEvent next = ClientDrains{};
    for (const auto& action : actions) {
      if (const auto* what = std::get_if<ToClient>(&action)) sent += what->bytes.size();
      taken += std::holds_alternative<TakeDevice>(action);
      freed += std::holds_alternative<FreeDevice>(action);
      hung_up += std::holds_alternative<HangUp>(action);
      if (std::holds_alternative<TakeDevice>(action)) next = DeviceGiven{};
      if (std::holds_alternative<CheckLogin>(action)) next = LoginChecked{true, {}};
    }
    for (const auto& action : actions) {
      if (const auto* what = std::get_if<ChangeLine>(&action))
        tell(LineChanged{what->change, ++changes_ % 3 != 0});
    }
    if (!std::holds_alternative<ClientDrains>(next)) tell(next);
  }
  void wait(Duration time) {
    now_ += time;
    tell(TimerFired{});
  }

  std::size_t sent = 0;
  int taken = 0, freed = 0, hung_up = 0;

 private:
  static EngineerRules rules(bool telnet, bool login_needed) {
    EngineerRules rules;
    rules.login_needed = login_needed;
    rules.port = LinePort{"P1", telnet, {}};
    return rules;
  }

  Instant now_{std::chrono::seconds{1}};
  LineEngineer engineer_;
  unsigned changes_ = 0;
};

void run_one(ByteView data) {
  if (data.size() < 2) return;
  Run run((data[0] & 1) == 0, (data[0] & 2) != 0);
  const std::size_t piece = data[1] + 1u;
  data = data.subspan(2);
  const std::size_t received = data.size();
  run.tell(TimerFired{});
  while (!data.empty()) {
    const ByteView part = data.first(std::min(piece, data.size()));
    data = data.subspan(part.size());
    run.tell(FromClient{part});
    run.tell(FromDevice{part});
    run.tell(LineState{part[0], part[0]});
    run.wait(std::chrono::milliseconds{700});
  }
  run.tell(ClientGone{"end"});
  fuzz::require(run.taken == run.freed && run.hung_up == 1);
  // Data of the device may be doubled; a notification has 9 bytes for each piece, at least a byte.
  fuzz::require(run.sent <= 200 + received * 16);
}

}  // namespace
}  // namespace fieldcast::program

FIELDCAST_FUZZ_TARGET(fieldcast::program::run_one)
