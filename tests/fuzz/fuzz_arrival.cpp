// Fuzzes programming connections: any bytes as a module's registration (text or words of its PLC)
// and as data of a bridge to `fieldcast port`. A number must consist of valid letters, a fault of
// one line. A registration must end in time, and a client exactly once.
//
// Input: kind and size of a piece(1), then the stream.
#include <cstdlib>

#include "core/program/port_client.hpp"
#include "core/program/registration.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace fieldcast::program {
namespace {

using fuzz::require;

RegistrationRule rule_of(unsigned kind) {
  RegistrationRule rule;
  if (kind % 4 == 1) rule.prefix = "ID=";
  if (kind % 4 == 2) rule.ask = RegistrationRule::Ask::kWords;
  return rule;
}

void register_module(unsigned kind, std::size_t piece, ByteView data) {
  Challenge challenge;
  if (kind % 4 == 3)
    challenge = {"once", [](std::string_view, std::string_view answer) { return answer == "yes"; }};
  Registration registration(rule_of(kind), challenge);
  Instant now{std::chrono::seconds{1}};
  auto outcome = registration.start(now);
  const Instant latest = now + RegistrationRule{}.timeout + std::chrono::seconds{1};
  const auto over = [&] { return outcome.number.has_value() || outcome.fault.has_value(); };
  while (!over()) {
    require(outcome.wake != kNever && now < latest);
    if (data.empty()) {
      now = std::max(now, outcome.wake);
      outcome = registration.on_timer(now);
      continue;
    }
    const ByteView part = data.first(std::min(piece, data.size()));
    data = data.subspan(part.size());
    outcome = registration.on_bytes(part, now);
  }
  require(outcome.number.has_value() != outcome.fault.has_value());
  if (outcome.number) require(!outcome.number->empty());
  for (const auto& text : {outcome.number, outcome.fault}) {
    for (const char c : text.value_or("")) require(static_cast<unsigned char>(c) >= 0x20);
  }
}

void talk_to_client(unsigned kind, std::size_t piece, ByteView data) {
  PortClientRules rules{.number = "17"};
  rules.by_length = kind % 2 == 0;
  if (kind % 4 > 1) rules.user = "anna";
  PortClient client(rules);
  Instant now{std::chrono::seconds{1}};
  int ended = 0;
  const auto tell = [&](const PortClient::Event& event) {
    PortClient::Actions actions;
    client.on_event(event, now, actions);
    require(ended == 0 || actions.empty());
    for (const auto& action : actions) {
      const auto* finish = std::get_if<PortClient::Finish>(&action);
      if (finish == nullptr) continue;
      ++ended;
      for (const char c : finish->end.text) require(static_cast<unsigned char>(c) >= 0x20);
    }
  };
  tell(PortClient::Connected{});
  while (!data.empty()) {
    const ByteView part = data.first(std::min(piece, data.size()));
    data = data.subspan(part.size());
    tell(PortClient::FromBridge{part});
    if (part.size() % 3 == 0) tell(PortClient::FromProgram{part});
    now += std::chrono::milliseconds{700};
    tell(PortClient::TimerFired{});
  }
  tell(PortClient::BridgeGone{"end"});
  require(ended == 1 && client.over());
}

void run_arrival(ByteView data) {
  if (data.empty()) return;
  const unsigned kind = data[0] % 8;
  const std::size_t piece = data[0] / 8 + 1u;
  kind < 4 ? register_module(kind, piece, data.subspan(1))
           : talk_to_client(kind, piece, data.subspan(1));
}

}  // namespace
}  // namespace fieldcast::program

FIELDCAST_FUZZ_TARGET(fieldcast::program::run_arrival)
