// What the domain is now, from the live model: GET /api/catalogue for the page, and GET
// /api/channels, /api/buses, /api/devices, /api/sessions, /api/bridges for scripts. On the io
// thread.
#pragma once

#include "tools/station/live/live_model.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

inline constexpr std::uint32_t kMaxListed = 10'000;  // channels of one answer

// The model outlives the table.
void add_channel_routes(RouteTable& table, const LiveModel& model);

}  // namespace fieldcast::web
