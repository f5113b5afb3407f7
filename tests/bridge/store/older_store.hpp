#pragma once

#include <string>

#include "bridge/store/sql/sql.hpp"

namespace fieldcast::test {

// Reverts the changes of the later versions. REQUIRES: 1 <= version.
inline void back_to_version(SqlConnection& connection, int version) {
  if (version < 14) connection.script("drop table retention_clock");
  if (version < 13) connection.script("drop table late_ranges");
  if (version < 12)
    connection.script(
        "drop table reports; drop table report_runs; alter table notifications drop column "
        "attachment_name; alter table notifications drop column attachment");
  if (version < 11)
    connection.script(
        "drop table notifications; drop table notify_windows; drop table notify_progress");
  if (version < 10) connection.script("drop table dashboards; drop table pictures");
  if (version < 9) connection.script("drop table bus_epochs");
  if (version < 8) connection.script("drop view quarantine_list; drop table quarantine");
  if (version < 7) connection.script("drop table tokens");
  if (version < 6) {
    connection.script(
        "drop view alarm_log; drop view alarm_list; drop view maintenance_list;"
        "drop table alarm_states; drop table device_maintenance; drop table alarm_events;");
  }
  if (version < 5) {
    connection.script(
        "drop view minute_history; drop view hour_history;"
        "drop table tiers; drop table open_buckets; drop table untiered;");
  }
  if (version < 4) {
    connection.script(
        "drop view sample_history; drop view last_samples; drop view device_states;"
        "drop view alarm_history; drop view active_alarms; drop view audit_history;");
  }
  if (version < 3) connection.script("drop table commands");
  if (version < 2) connection.script("alter table channels drop column type");
  connection.execute("update fieldcast_version set version = $1", SqlRow{std::int64_t{version}});
}

}  // namespace fieldcast::test
