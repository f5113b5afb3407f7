// Keys about a channel's values, and checks for contradictions between them.
#pragma once

#include "config/document/map_reader.hpp"
#include "core/model/channel_spec.hpp"

namespace fieldcast::config {

void read_limits(MapReader& channel, ChannelSpec& spec);
void read_write(MapReader& channel, ChannelSpec& spec);

// REQUIRES: limits and type were read; for check_write_span() a numeric type.
void check_deadband(MapReader& channel, const ChannelSpec& spec);
void check_write_span(MapReader& channel, const ChannelSpec& spec);

}  // namespace fieldcast::config
