// Fills a store with 30 days of one-second samples and measures reading them as 1 000 points.
#pragma once

#include "bridge/store/sql/sql.hpp"

namespace fieldcast::bench {

// history/device/c0 has a sample each second from 2023-11-14 on; 99 others only its minutes and
// hours. Throws StoreError.
void fill_thirty_days(const StoreAddress& address);

// Prints the figures. Needs 0.4 GB in SQLite. Throws StoreError.
void read_thirty_days(const StoreAddress& address);

}  // namespace fieldcast::bench
