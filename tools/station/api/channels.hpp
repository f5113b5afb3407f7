// State of the domain from the live model: GET /api/catalogue for the page; /api/channels, buses,
// devices, sessions and bridges for scripts. Runs on the io thread.
#pragma once

#include "tools/station/http/route_table.hpp"
#include "tools/station/model/live_model.hpp"

namespace fieldcast::web {

inline constexpr std::uint32_t kMaxListed = 10'000;  // channels of one response

// The model must outlive the table.
void add_channel_routes(RouteTable& table, const LiveModel& model);

}  // namespace fieldcast::web
