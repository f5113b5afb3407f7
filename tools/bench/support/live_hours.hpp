// Runs a station's model and its clients for hours of virtual time, without sockets and DDS.
#pragma once

namespace fieldcast::bench {

void run_hours(double hours);

}  // namespace fieldcast::bench
