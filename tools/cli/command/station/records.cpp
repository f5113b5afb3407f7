#include "tools/cli/command/station/records.hpp"

#include <ostream>

#include "bridge/store/event_table.hpp"
#include "tools/cli/command/base/command.hpp"
#include "tools/cli/command/base/command_options.hpp"
#include "tools/cli/terminal/console.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/view/record_view.hpp"

namespace fieldcast::cli {
namespace {

ExitCode ended(std::ostream& out, std::ostream& err, std::size_t records, const char* nothing) {
  out.flush();
  if (!out) return ExitCode::kTrouble;
  if (records > 0) return ExitCode::kOk;
  err << nothing << '\n';
  return ExitCode::kNothing;
}

}  // namespace

ExitCode devices(const DevicesOptions& options, std::ostream& out, std::ostream& err) {
  const auto address = resolve(options.source);
  if (!address) {
    err << address.error() << '\n';
    return ExitCode::kUsage;
  }
  const auto connection = open_store(*address, IfMissing::kFail);
  const auto found = EventTable(*connection).devices();
  if (options.json) {
    for (const DeviceRecord& device : found) out << record_json(device).text() << '\n';
  } else if (!found.empty()) {
    for (const auto& line : device_lines(found, utc_now(), {0, 0, output_screen().colour}))
      out << line << '\n';
  }
  return ended(out, err, found.size(), "the store knows no device yet");
}

ExitCode audit(const AuditOptions& options, std::ostream& out, std::ostream& err) {
  const auto address = resolve(options.source);
  if (!address) {
    err << address.error() << '\n';
    return ExitCode::kUsage;
  }
  const auto connection = open_store(*address, IfMissing::kFail);
  std::size_t entries = 0;
  EventTable(*connection).audit(options.span.from, options.span.to, [&](const AuditEntry& entry) {
    ++entries;
    out << (options.json ? record_json(entry).text() : audit_line(entry)) << '\n';
    return out.good();
  });
  return ended(out, err, entries, "nothing was done in that time; --from and --to choose another");
}

namespace {

class DevicesCommand final : public CommandWith<DevicesOptions> {
 public:
  void describe(CommandLine& line) override {
    line.flag("--json", options_.json, "JSON lines");
    add_store(line, options_.source);
  }
  ExitCode run(const Streams& streams) override {
    return devices(options_, streams.out, streams.err);
  }
};

}  // namespace

CommandEntry devices_command();
CommandEntry devices_command() {
  return {"devices", "Show the devices that the store knows, and their last state; needs no bridge",
          make_command<DevicesCommand>};
}

namespace {

class AuditCommand final : public CommandWith<AuditOptions> {
 public:
  void describe(CommandLine& line) override {
    span_.describe(line);
    line.when_given([this] { return span_.read(options_.span); });
    line.flag("--json", options_.json, "JSON lines");
    add_store(line, options_.source);
  }
  ExitCode run(const Streams& streams) override {
    return audit(options_, streams.out, streams.err);
  }

 private:
  SpanOption span_;
};

}  // namespace

CommandEntry audit_command();
CommandEntry audit_command() {
  return {"audit", "Show who did what: commands, transmissions, logins; needs no bridge",
          make_command<AuditCommand>};
}

}  // namespace fieldcast::cli
