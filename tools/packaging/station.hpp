// The one header that a station includes: <fieldcast/station.hpp>. Threads and faults stand in the
// header below.
#pragma once

#include "bridge/station/sites.hpp"
#include "bridge/station/station.hpp"
