// What a channel says of its values: limits with their alarms, what may be written, the deadband;
// and whether that contradicts itself.
#pragma once

#include "config/map_reader.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

void read_limits(MapReader& channel, ChannelSpec& spec);
void read_write(MapReader& channel, ChannelSpec& spec);

// REQUIRES: limits and type are read; for check_write_span a type of numbers.
void check_deadband(MapReader& channel, const ChannelSpec& spec);
void check_write_span(MapReader& channel, const ChannelSpec& spec);

}  // namespace fieldcast::config
