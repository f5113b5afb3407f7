// Fills a store with 30 days of one-second samples and measures reading them as 1 000 points.
#pragma once

#include <string>

#include "bridge/store/sql.hpp"

namespace fieldcast::bench {

// One channel, history/device/c0, has a sample in each second from 2023-11-14 on; 99 others have
// its minutes and hours. Throws StoreError.
void fill_thirty_days(const StoreAddress& address);

// Fills the store at `address` and prints the figures. One channel has every sample, the others
// only minutes and hours: 0.4 GB in SQLite. One thread. Throws StoreError.
void read_thirty_days(const StoreAddress& address);

}  // namespace fieldcast::bench
