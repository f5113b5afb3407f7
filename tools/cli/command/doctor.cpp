#include "tools/cli/command/doctor.hpp"

#include <optional>
#include <ostream>

#include "config/loader/loader.hpp"
#include "tools/cli/command/base/command.hpp"
#include "tools/cli/doctor/clocks.hpp"
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
  MachineFacts facts = gather_facts(options.root, spec ? &*spec : nullptr);
  if (options.listens)
    gather_clocks({.config = options.config, .security = options.security}, facts);
  const auto findings = findings_of(facts);
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
    line.text("--security", options_.security,
              "Join the domain of CONFIG as the member whose folder this is, to compare clocks");
  }
  ExitCode run(const Streams& streams) override {
    options_.listens = !options_.config.empty() && options_.root == "/";
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
