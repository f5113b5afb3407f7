#include "tools/cli/command/history.hpp"

#include <fmt/format.h>

#include <ostream>

#include "bridge/store/tiers/tier_history.hpp"
#include "tools/cli/command/command.hpp"
#include "tools/cli/command/pattern_option.hpp"
#include "tools/cli/command/span_option.hpp"
#include "tools/cli/console.hpp"
#include "tools/cli/gzip_file.hpp"
#include "tools/cli/progress_line.hpp"
#include "tools/cli/view/bucket_view.hpp"
#include "tools/cli/view/progress_text.hpp"
#include "tools/cli/view/record_view.hpp"

namespace fieldcast::cli {

namespace {

// Prints what the options ask for; counts what was printed.
class Printer {
 public:
  // `progress` may be null: the lines themselves are on the terminal.
  Printer(const HistoryOptions& options, SqlConnection& connection, std::ostream& out,
          ProgressLine* progress)
      : options_(options), connection_(connection), out_(out), progress_(progress) {}

  // Each sample. How many channels of the pattern the store knows.
  std::size_t samples() {
    if (options_.csv) out_ << history_csv_head() << '\n';
    const auto print = [&](const StoredSample& sample) {
      return line(options_.json  ? to_line(record_json(sample))
                  : options_.csv ? history_csv(sample, options_.zone)
                                 : history_line(sample, options_.zone));
    };
    return SampleTable(connection_)
        .history(options_.pattern, options_.span.from, options_.span.to, print);
  }

  std::size_t buckets(Duration every) {
    if (!options_.json)
      out_ << (options_.csv ? bucket_csv_head() : bucket_head(options_.zone)) << '\n';
    TierHistory history(connection_, every);
    const auto channels = SampleTable(connection_).channels(options_.pattern);
    for (const StoredChannel& channel : channels) {
      const auto print = [&](const Bucket& bucket) {
        return line(options_.json  ? to_line(bucket_json(channel, bucket))
                    : options_.csv ? bucket_csv(channel, bucket, options_.zone)
                                   : bucket_line(channel, bucket, options_.zone));
      };
      if (!history.read(channel, options_.span.from, options_.span.to, print)) break;
    }
    return channels.size();
  }

  [[nodiscard]] std::size_t lines() const { return lines_; }

 private:
  static constexpr std::size_t kLook = 256;  // lines between two looks at the clock

  bool line(const std::string& text) {
    ++lines_;
    out_ << text << '\n';
    if (progress_ != nullptr && lines_ % kLook == 0) {
      progress_->show([this](Duration elapsed) {
        return progress_count_text("history", lines_, "lines", elapsed);
      });
    }
    return out_.good();
  }

  const HistoryOptions& options_;
  SqlConnection& connection_;
  std::ostream& out_;
  ProgressLine* progress_;
  std::size_t lines_ = 0;
};

// A line that says so when channels go back further in a coarser tier than in what is shown, to
// the time that is asked for; of the first one of them.
std::string what_is_coarser(const HistoryOptions& options, SqlConnection& connection,
                            Duration every) {
  TierHistory history(connection, every);
  for (const StoredChannel& channel : SampleTable(connection).channels(options.pattern)) {
    const auto reach = history.reach(channel);
    if (!reach || options.span.from >= reach->oldest) continue;
    if (reach->coarser_oldest >= options.span.to) continue;
    const Tier& tier = kTiers[reach->coarser_tier];
    return fmt::format("{}/{}/{}: {}; each {} is kept from {} on: --every {}", channel.bus,
                       channel.device, channel.channel,
                       reach->oldest == kEndOfTime
                           ? "nothing finer is kept"
                           : "this goes back to " + time_text(reach->oldest, options.zone),
                       tier.name, time_text(reach->coarser_oldest, options.zone), tier.every);
  }
  return {};
}

}  // namespace

ExitCode history(const HistoryOptions& options, std::ostream& out, std::ostream& err) {
  const auto address = resolve(options.source);
  if (!address) {
    err << address.error() << '\n';
    return ExitCode::kUsage;
  }
  const auto connection = open_store(*address, IfMissing::kFail);
  std::optional<Duration> every = options.every;
  if (options.points) {
    const Duration span{options.span.to.nanoseconds - options.span.from.nanoseconds};
    every = width_for(span, *options.points);
  }
  std::optional<GzipFile> file;
  if (!options.gzip.empty()) file.emplace(options.gzip);
  std::ostream to(file ? &*file : out.rdbuf());
  ProgressLine progress(err);
  const bool lines_are_seen = !file && output_is_terminal();
  Printer printer(options, *connection, to, lines_are_seen ? nullptr : &progress);
  const std::size_t channels = every ? printer.buckets(*every) : printer.samples();
  progress.clear();
  bool written = !to.flush().fail();
  if (const auto fault = file ? file->close() : std::nullopt) {
    err << printable(*fault) << '\n';
    written = false;
  }
  if (!written) return ExitCode::kTrouble;
  const std::string coarser = what_is_coarser(options, *connection, every.value_or(Duration{1}));
  if (!coarser.empty()) err << printable(coarser) << '\n';
  if (printer.lines() > 0) return ExitCode::kOk;
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
    line.duration("--every", options_.every, std::chrono::milliseconds{1},
                  "Least, largest and mean value of each stretch of that length: 1min, 1h");
    line.number("--points", options_.points, 2, kMostPoints,
                "The same in at most so many stretches for each channel")
        .excludes("--every");
    line.flag("--local", local_, "Times of this machine's time zone, not UTC");
    line.flag("--csv", options_.csv, "Comma-separated values with a head line");
    line.flag("--json", options_.json, "JSON lines").excludes("--csv");
    line.text("--gzip", options_.gzip,
              "Write into this new file, compressed, and not to the terminal");
    add_store(line, options_.source);
  }
  ExitCode run(const Streams& streams) override {
    if (local_) options_.zone = Zone::kLocal;
    return history(options_, streams.out, streams.err);
  }

 private:
  static constexpr std::uint32_t kMostPoints = 1'000'000;

  SpanOption span_;
  bool local_ = false;
};

}  // namespace

CommandEntry history_command();
CommandEntry history_command() {
  return {"history",
          "Show the stored samples of channels, or their minutes and hours; needs no bridge",
          make_command<HistoryCommand>};
}

}  // namespace fieldcast::cli
