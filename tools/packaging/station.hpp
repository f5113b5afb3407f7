// The only header that a station includes: <fieldcast/station.hpp>. See the headers below for
// threads and faults.
#pragma once

#include "bridge/station/sites.hpp"
#include "bridge/station/station.hpp"
