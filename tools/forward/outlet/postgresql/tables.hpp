// The tables of an outlet, and the statements that write them. docs/forward.md describes every
// column. Pure.
#pragma once

#include <string>

namespace fieldcast::forward {

// `schema` is quoted in each text.

// Creates what is missing, in one transaction, safely also in parallel. Uses a hypertable if the
// database has the extension timescaledb.
[[nodiscard]] std::string create_tables(const std::string& schema);

// Parameters of the statements below, in this order; each array as a text literal.

// site, arrays of bus, device, channel, type, unit, at, description, low_low, low, high, high_high.
[[nodiscard]] std::string upsert_channels(const std::string& schema);
// The same; a channel that exists is not changed.
[[nodiscard]] std::string insert_channels(const std::string& schema);
// site, bus, device. Rows: channel, id.
[[nodiscard]] std::string select_channels(const std::string& schema);
// Arrays of channel id, epoch, sequence, acquired_at in ns, quality, device_code, value, text.
[[nodiscard]] std::string insert_samples(const std::string& schema);
// site, identity, bus, device, channel, limit, priority, stage, active, value, raised_at and
// cleared_at in ns, acknowledged_by, acknowledged_note.
[[nodiscard]] std::string insert_alarm(const std::string& schema);
// site, bridge, epoch, number, at in ns, who, what, target, bytes to and from the device, result.
[[nodiscard]] std::string insert_audit(const std::string& schema);

}  // namespace fieldcast::forward
