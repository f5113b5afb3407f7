// Hours of virtual time of a station's model and its clients, without sockets and DDS.
#pragma once

namespace fieldcast::bench {

// Prints the heap after each hour, and by how much it grew since the first one.
void run_hours(double hours);

}  // namespace fieldcast::bench
