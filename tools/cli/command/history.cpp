#include "tools/cli/command/history.hpp"

#include <fmt/format.h>

#include <ostream>

#include "bridge/store/sample_table.hpp"
#include "tools/cli/command/command.hpp"
#include "tools/cli/command/pattern_option.hpp"
#include "tools/cli/command/span_option.hpp"
#include "tools/cli/view/record_view.hpp"

namespace fieldcast::cli {

ExitCode history(const HistoryOptions& options, std::ostream& out, std::ostream& err) {
  const auto address = resolve(options.source);
  if (!address) {
    err << address.error() << '\n';
    return ExitCode::kUsage;
  }
  const auto connection = open_store(*address, IfMissing::kFail);
  std::size_t samples = 0;
  if (options.csv) out << history_csv_head() << '\n';
  const auto print = [&](const StoredSample& sample) {
    ++samples;
    out << (options.json  ? to_line(record_json(sample))
            : options.csv ? history_csv(sample)
                          : history_line(sample))
        << '\n';
    return out.good();
  };
  const std::size_t channels =
      SampleTable(*connection).history(options.pattern, options.span.from, options.span.to, print);
  out.flush();
  if (!out) return ExitCode::kTrouble;
  if (samples > 0) return ExitCode::kOk;
  err << (channels == 0
              ? "the store knows no channel " + options.pattern.text()
              : fmt::format("nothing was stored of {} in that time; --from and --to choose another",
                            options.pattern.text()))
      << '\n';
  return ExitCode::kNothing;
}

namespace {

class HistoryCommand final : public CommandWith<HistoryOptions> {
 public:
  void describe(CommandLine& line) override {
    line.value("CHANNEL", pattern_into(options_.pattern), kPatternHelp).required();
    span_.describe(line);
    line.when_given([this] { return span_.read(options_.span); });
    line.flag("--csv", options_.csv, "Comma-separated values with a head line");
    line.flag("--json", options_.json, "JSON lines").excludes("--csv");
    add_store(line, options_.source);
  }
  ExitCode run(const Streams& streams) override {
    return history(options_, streams.out, streams.err);
  }

 private:
  SpanOption span_;
};

}  // namespace

CommandEntry history_command();
CommandEntry history_command() {
  return {"history", "Show the stored samples of channels; needs no bridge",
          make_command<HistoryCommand>};
}

}  // namespace fieldcast::cli
