// Checks for every_database_test.cpp: rows that a database refuses, and values that only a hostile
// or broken program publishes. Each check stores valid rows around them, which must remain.
//
// The database exists and has the current version.
#pragma once

#include "bridge/store/sql/sql.hpp"

namespace fieldcast::test {

void puts_refused_events_aside(const StoreAddress& address);
void puts_refused_samples_aside(const StoreAddress& address);
void goes_on_after_an_alarm_without_a_number(const StoreAddress& address);
void goes_on_after_every_extreme(const StoreAddress& address);

}  // namespace fieldcast::test
