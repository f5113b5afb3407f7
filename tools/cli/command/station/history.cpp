#include "tools/cli/command/station/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ostream>

#include "bridge/store/tiers/tier_table.hpp"
#include "tools/cli/command/base/command_options.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/terminal/console.hpp"
#include "tools/cli/terminal/gzip_file.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/view/record_view.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::cli {

namespace {

// Share of the requested time that was printed, channel by channel.
class PrintedShare {
 public:
  PrintedShare(UtcTime to, std::size_t channels)
      : to_(std::min(to, utc_now()).nanoseconds), channels_(std::max<std::size_t>(channels, 1)) {}

  // `of`: a StoredChannel or a StoredSample.
  template <class Named>
  void reached(const Named& of, UtcTime at) {
    if (index_ == 0 || of.channel != channel_ || of.device != device_ || of.bus != bus_) {
      bus_ = of.bus;
      device_ = of.device;
      channel_ = of.channel;
      first_ = at.nanoseconds;
      ++index_;
    }
    at_ = at.nanoseconds;
  }
  // Between 0 and 1.
  [[nodiscard]] double value() const {
    if (index_ == 0) return 0;
    const double span = static_cast<double>(std::max<std::int64_t>(to_ - first_, 1));
    const double part = std::clamp(static_cast<double>(at_ - first_) / span, 0.0, 1.0);
    return (static_cast<double>(index_ - 1) + part) / static_cast<double>(channels_);
  }

 private:
  const std::int64_t to_;
  const std::size_t channels_;
  std::size_t index_ = 0;               // number of started channels
  std::string bus_, device_, channel_;  // the last started channel
  std::int64_t first_ = 0, at_ = 0;
};

Zone zone_of(const HistoryOptions& options) { return options.local ? Zone::kLocal : Zone::kUtc; }

class Printer {
 public:
  // `progress` is null if the lines or their reader use the terminal. `interrupt` may be null.
  Printer(const HistoryOptions& options, SqlConnection& connection, std::ostream& out,
          ProgressLine* progress, const Interrupt* interrupt)
      : options_(options),
        connection_(connection),
        out_(out),
        progress_(progress),
        interrupt_(interrupt),
        share_(options.span.to, SampleTable(connection).channels(options.pattern).size()) {}

  // Returns the number of matching channels in the store.
  std::size_t samples() {
    if (options_.csv) out_ << history_csv_head() << '\n';
    const auto print = [&](const StoredSample& sample) {
      share_.reached(sample, sample.published_at);
      return line(options_.json  ? record_json(sample).text()
                  : options_.csv ? history_csv(sample, zone_)
                                 : history_line(sample, zone_));
    };
    return SampleTable(connection_)
        .history(options_.pattern, options_.span.from, options_.span.to, print);
  }

  std::size_t buckets(Duration every) {
    if (!options_.json) out_ << (options_.csv ? bucket_csv_head() : bucket_head(zone_)) << '\n';
    TierHistory history(connection_, every);
    const auto channels = SampleTable(connection_).channels(options_.pattern);
    for (const StoredChannel& channel : channels) {
      const auto print = [&](const Bucket& bucket) {
        share_.reached(channel, bucket.start);
        return line(options_.json  ? bucket_json(channel, bucket).text()
                    : options_.csv ? bucket_csv(channel, bucket, zone_)
                                   : bucket_line(channel, bucket, zone_));
      };
      if (!history.read(channel, options_.span.from, options_.span.to, print)) break;
    }
    return channels.size();
  }

  [[nodiscard]] std::size_t lines() const { return lines_; }

 private:
  static constexpr std::size_t kLook = 256;  // lines between two checks of the clock

  bool line(const std::string& text) {
    ++lines_;
    out_ << text << '\n';
    if (progress_ != nullptr && lines_ % kLook == 0) {
      progress_->show([this](Duration elapsed) {
        ProgressText told = progress_text("history", share_.value(), elapsed);
        told.how_far += fmt::format(", {} lines", lines_);
        return told;
      });
    }
    return out_.good() && !interrupted();
  }
  [[nodiscard]] bool interrupted() const { return interrupt_ != nullptr && interrupt_->raised(); }

  const HistoryOptions& options_;
  SqlConnection& connection_;
  std::ostream& out_;
  ProgressLine* progress_;
  const Interrupt* interrupt_;
  const Zone zone_ = zone_of(options_);
  PrintedShare share_;
  std::size_t lines_ = 0;
};

// Hint if a coarser tier has older data of the requested time; names the first such channel.
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
                           : "this goes back to " + time_text(reach->oldest, zone_of(options)),
                       tier.name, time_text(reach->coarser_oldest, zone_of(options)), tier.every);
  }
  return {};
}

}  // namespace

ExitCode history(const HistoryOptions& options, const Streams& to, const Interrupt* interrupt) {
  return in_store(options.source, to.err, IfMissing::kFail, [&](SqlConnection& store) {
    std::optional<Duration> every = options.every;
    if (options.points) {
      const Duration span{options.span.to.nanoseconds - options.span.from.nanoseconds};
      every = width_for(span, *options.points);
    }
    std::optional<GzipFile> file;
    if (!options.gzip.empty()) file.emplace(options.gzip);
    std::ostream out(file ? &*file : to.out.rdbuf());
    ProgressLine progress(to.err);
    const bool silent = !file && (output_is_terminal() || output_is_pipe());
    Printer printer(options, store, out, silent ? nullptr : &progress, interrupt);
    const std::size_t channels = every ? printer.buckets(*every) : printer.samples();
    progress.clear();
    bool written = !out.flush().fail();
    if (interrupt != nullptr && interrupt->raised()) return ExitCode::kInterrupted;
    if (const auto fault = file ? file->close() : std::nullopt) {
      to.err << printable(*fault) << '\n';
      written = false;
    }
    if (!written) return ExitCode::kTrouble;
    const std::string coarser = what_is_coarser(options, store, every.value_or(Duration{1}));
    if (!coarser.empty()) to.err << printable(coarser) << '\n';
    if (printer.lines() > 0) return ExitCode::kOk;
    to.err << (channels == 0
                   ? "the store knows no channel " + options.pattern.text()
                   : fmt::format(
                         "nothing was stored of {} in that time; --from and --to choose another",
                         options.pattern.text()))
           << '\n';
    return ExitCode::kNothing;
  });
}

namespace {

constexpr std::uint32_t kMostPoints = 1'000'000;
// Does not wait longer for the database or a blocked output.
constexpr std::chrono::milliseconds kLastLine{100};

void describe_history(CommandLine& line, HistoryOptions& options) {
  line.value("CHANNEL", pattern_into(options.pattern), kPatternHelp).required();
  add_span(line, options.span);
  line.duration("--every", options.every, std::chrono::milliseconds{1},
                "Least, largest and mean value of each stretch of that length: 1min, 1h");
  line.number("--points", options.points, 2, kMostPoints,
              "The same in at most so many stretches for each channel")
      .excludes("--every");
  line.flag("--local", options.local, "Times of this machine's time zone, not UTC");
  line.flag("--csv", options.csv, "Comma-separated values with a head line");
  line.flag("--json", options.json, "JSON lines").excludes("--csv");
  line.text("--gzip", options.gzip,
            "Write into this new file, compressed, and not to the terminal");
  add_store(line, options.source);
}

}  // namespace

CommandRow history_command() {
  return command_row("history",
                     "Show the stored samples of channels, or their minutes and hours; needs no "
                     "bridge",
                     describe_history, [](const HistoryOptions& options, const Streams& to) {
                       const EndAtOnce end(kLastLine);
                       return history(options, to, &end.interrupt());
                     });
}

}  // namespace fieldcast::cli
