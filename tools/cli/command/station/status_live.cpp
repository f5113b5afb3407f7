#include "tools/cli/command/station/status_live.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/cli/screen/status_screen.hpp"
#include "tools/cli/terminal/clock.hpp"
#include "tools/cli/terminal/terminal.hpp"

namespace fieldcast::cli {
namespace {

constexpr Duration kDrawStatusAgain = std::chrono::milliseconds{200};

std::string notice_of(const Connection& connection, DomainView& domain, Duration waited) {
  return waited <= kBridgeWait
             ? fmt::format("waiting for a bridge in {} ..", domain_text(connection))
             : no_bridge_text(connection, domain.missing_servers());
}

}  // namespace

void status_live(const Connection& connection, DomainView& domain, StatusModel& model,
                 StandbyWatch& members, Instant end) {
  StatusScreen screen(model);
  Terminal terminal;
  const auto began = instant_now();
  auto next_draw = began;
  for (auto now = began; now < end && !domain.inbox().closed(); now = instant_now()) {
    bool pressed = false;
    while (const auto key = terminal.key(pressed ? now : std::min(end, next_draw))) {
      pressed = true;
      now = instant_now();
      if (!screen.on_key(*key, {now, utc_now()})) return;
    }
    for (const auto& event : domain.inbox().take_present()) update(model, event);
    model.members = members.model();
    now = instant_now();
    if (!pressed && now < next_draw) continue;
    screen.set_notice(notice_of(connection, domain, now - began));
    terminal.draw(screen.frame({now, utc_now()}, terminal.size()));
    next_draw = now + kDrawStatusAgain;
  }
}

}  // namespace fieldcast::cli
