#include "tools/cli/command/station/records.hpp"

#include <ostream>

#include "bridge/store/event_table.hpp"
#include "tools/cli/command/base/command_options.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/view/record_view.hpp"

namespace fieldcast::cli {
namespace {

// Return kOk if there are records, else kNothing. Throw StoreError.
ExitCode devices(const DevicesOptions& options, const Streams& to) {
  return in_store(options.source, to.err, IfMissing::kFail, [&](SqlConnection& store) {
    const auto found = EventTable(store).devices();
    if (options.json) {
      for (const DeviceRecord& device : found) to.out << record_json(device).text() << '\n';
    } else if (!found.empty()) {
      print(to.out, device_lines(found, utc_now(), to.wide_screen()));
    }
    return end_of_records(to, found.size(), "the store knows no device yet");
  });
}

ExitCode audit(const AuditOptions& options, const Streams& to) {
  return in_store(options.source, to.err, IfMissing::kFail, [&](SqlConnection& store) {
    std::size_t entries = 0;
    EventTable(store).audit(options.span.from, options.span.to, [&](const AuditEntry& entry) {
      ++entries;
      to.out << (options.json ? record_json(entry).text() : audit_line(entry)) << '\n';
      return to.out.good();
    });
    return end_of_records(to, entries,
                          "nothing was done in that time; --from and --to choose another");
  });
}

void describe_devices(CommandLine& line, DevicesOptions& options) {
  line.flag("--json", options.json, "JSON lines");
  add_store(line, options.source);
}

void describe_audit(CommandLine& line, AuditOptions& options) {
  add_span(line, options.span);
  line.flag("--json", options.json, "JSON lines");
  add_store(line, options.source);
}

}  // namespace

CommandRow devices_command() {
  return command_row("devices",
                     "Show the devices that the store knows, and their last state; needs no bridge",
                     describe_devices, devices);
}

CommandRow audit_command() {
  return command_row("audit", "Show who did what: commands, transmissions, logins; needs no bridge",
                     describe_audit, audit);
}

}  // namespace fieldcast::cli
