#include "tools/cli/command/doctor.hpp"

#include <optional>
#include <ostream>

#include "config/loader.hpp"
#include "tools/cli/command/command.hpp"
#include "tools/cli/doctor/findings.hpp"
#include "tools/cli/doctor/gather.hpp"
#include "tools/cli/view/doctor_view.hpp"

namespace fieldcast::cli {

ExitCode doctor(const DoctorOptions& options, std::ostream& out, std::ostream& err,
                const Screen& screen) {
  std::optional<BridgeSpec> spec;
  if (!options.config.empty()) {
    auto loaded = config::load_file(options.config);
    if (!loaded) {
      err << config::to_text(loaded.error()) << '\n';
      return ExitCode::kUsage;
    }
    spec = *std::move(loaded);
  }
  const auto findings = findings_of(gather_facts(options.root, spec ? &*spec : nullptr));
  if (options.json) {
    for (const Finding& finding : findings) out << finding_json(finding).text() << '\n';
  } else {
    for (const auto& line : doctor_lines(findings, screen)) out << line << '\n';
  }
  out.flush();
  return worst_of(findings) == Severity::kPrevents ? ExitCode::kFound : ExitCode::kOk;
}

namespace {

class DoctorCommand final : public CommandWith<DoctorOptions> {
 public:
  void describe(CommandLine& line) override {
    line.text("CONFIG", options_.config, "The configuration file; without it the machine alone")
        .existing_file();
    line.flag("--json", options_.json, "JSON lines");
    line.text("--root", options_.root,
              "Look at /proc, /sys, /run and the ports below this folder (/)");
  }
  ExitCode run(const Streams& streams) override {
    return doctor(options_, streams.out, streams.err, streams.wide_screen());
  }
};

}  // namespace

CommandEntry doctor_command();
CommandEntry doctor_command() {
  return {"doctor", "What of this machine is in Fieldcast's way, and the remedy; needs no bridge",
          make_command<DoctorCommand>};
}

}  // namespace fieldcast::cli
