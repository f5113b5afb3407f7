#include "tools/cli/command/station/watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <ostream>
#include <utility>

#include "bridge/dds/transport/network_check.hpp"
#include "core/base/json.hpp"
#include "tools/cli/command/base/command_options.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/command/station/watch_live.hpp"
#include "tools/cli/domain/domain_view.hpp"
#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/model/watch_model.hpp"
#include "tools/cli/terminal/console.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/terminal/terminal.hpp"
#include "tools/cli/view/station_view.hpp"

namespace fieldcast::cli {
namespace {

constexpr Duration kLook = std::chrono::milliseconds{200};
constexpr Duration kInterestWait = std::chrono::seconds{1};
constexpr Duration kLagAgain = std::chrono::seconds{1};  // shortest time between two lag events
constexpr Duration kOnceWait = std::chrono::seconds{10};
// A bus that restarts announces its channels again within this time: those are not reported.
constexpr Duration kGoneWait = std::chrono::seconds{1};

class Watch {
 public:
  Watch(const WatchOptions& options, const Connection& connection, Interrupt& interrupt,
        const Streams& to)
      : options_(options),
        connection_(connection),
        domain_(connection, interrupt),
        model_(options.pattern),
        to_(to) {}

  ExitCode run();

 private:
  void read(const DomainEvent& event, Instant now);
  void print_lines(Instant began, Instant end);
  void print_gone(Instant now);
  [[nodiscard]] bool screen_wanted();
  void remark_interest(Instant now, Instant began);
  void tell_lag(Instant now);
  [[nodiscard]] bool complete(Instant now) const;
  void print_all();
  void print_table(const Screen& screen);
  void print(const StationSample& sample);
  [[nodiscard]] std::string what_matches() const;
  [[nodiscard]] ExitCode verdict() const;

  const WatchOptions& options_;
  const Connection& connection_;
  DomainView domain_;
  WatchModel model_;
  const Streams& to_;
  std::optional<std::string> remark_;                 // about the interest; empty until known
  Instant last_news_{};                               // last growth of the catalogue
  std::optional<Listening> listening_;                // for --once
  std::deque<std::pair<ChannelPath, Instant>> gone_;  // not printed yet
  std::uint64_t missing_told_ = 0;                    // missing blocks in the last lag event
  std::optional<Instant> lag_told_;                   // time of the last lag event
};

ExitCode Watch::run() {
  const auto began = instant_now();
  const auto limit = options_.time   ? options_.time
                     : options_.once ? std::optional{kOnceWait}
                                     : std::nullopt;
  const auto end = limit ? began + *limit : kNever;
  last_news_ = began;
  listening_.emplace(connection_, began);
  if (const auto small = receive_buffer_remark(connection_.sites.front().dds);
      small && !options_.once)
    to_.err << "fieldcast watch: " << *small << '\n' << std::flush;
  domain_.subscribe_channels();
  domain_.subscribe_samples();
  if (options_.refresh)
    domain_.station().declare_interest(options_.pattern.text(), *options_.refresh);

  if (screen_wanted()) {
    watch_live(options_, connection_, domain_, model_, end);
    print_table(output_screen());
  } else {
    print_lines(began, end);
  }
  if (options_.once && !domain_.interrupted()) print_all();
  to_.out.flush();
  if (const std::string silent = listening_->silent_text();
      options_.once && listening_->anybody() && !silent.empty())
    to_.err << "fieldcast watch: " << silent << '\n';
  to_.err << "fieldcast watch: " << model_.summary();
  if (const auto lag = model_.lag_remark()) to_.err << "; " << *lag;
  if (domain_.inbox().dropped() != 0)
    to_.err << "; " << domain_.inbox().dropped() << " more were not shown: the output was too slow";
  to_.err << '\n';
  return verdict();
}

void Watch::print_lines(Instant began, Instant end) {
  bool hinted = false;
  for (auto now = began; now < end && !domain_.inbox().closed() && to_.out; now = instant_now()) {
    for (const auto& event : domain_.inbox().take_all(to_steady(std::min(end, now + kLook))))
      read(event, instant_now());
    now = instant_now();
    remark_interest(now, began);
    tell_lag(now);
    print_gone(now);
    if (options_.once && complete(now)) break;
    if (!model_.anything_announced() && now - began > kBridgeWait && !hinted) {
      hinted = true;
      if (options_.once) break;
      to_.err << "fieldcast watch: " << no_bridge_text(connection_, domain_.missing_servers())
              << "; still waiting\n"
              << std::flush;
    }
    to_.out.flush();
  }
}

void Watch::read(const DomainEvent& event, Instant now) {
  if (const auto* sample = std::get_if<StationSample>(&event)) {
    if (model_.on_sample(*sample, now) && !options_.once) print(*sample);
  } else if (const auto* channel = std::get_if<StationChannel>(&event)) {
    model_.on_channel(*channel);
    last_news_ = now;
    listening_->news(channel->bus, now);
  } else if (const auto* gone = std::get_if<ChannelGone>(&event)) {
    if (model_.on_gone(gone->path) && !options_.once) gone_.emplace_back(gone->path, now);
  }
}

void Watch::print_gone(Instant now) {
  for (; !gone_.empty() && now - gone_.front().second >= kGoneWait; gone_.pop_front()) {
    const ChannelPath& path = gone_.front().first;
    if (!model_.is_gone(path)) continue;
    to_.out << (options_.json ? gone_json(path).text() : gone_line(path, utc_now())) << '\n';
  }
}

// Bridges announce their channels again when an interest becomes effective.
void Watch::remark_interest(Instant now, Instant began) {
  if (!options_.refresh || remark_ || !model_.anything_announced() ||
      now - std::max(began, last_news_) < kInterestWait)
    return;
  remark_ = model_.interest_remark(*options_.refresh).value_or("");
  if (!remark_->empty()) to_.err << "fieldcast watch: " << *remark_ << '\n' << std::flush;
}

// Otherwise the table's footer and the last line report the lag.
void Watch::tell_lag(Instant now) {
  model_.on_counters(domain_.station().block_counters());
  const Station::BlockCounters& counters = model_.counters();
  if (!options_.json || options_.once || counters.missing == missing_told_ ||
      (lag_told_ && now - *lag_told_ < kLagAgain))
    return;
  missing_told_ = counters.missing;
  lag_told_ = now;
  to_.out << lag_json(counters).text() << '\n';
}

// Prints the reason if the terminal cannot show a screen.
bool Watch::screen_wanted() {
  if (options_.once || options_.json || options_.plain || !output_is_terminal()) return false;
  const std::string reason = no_screen_reason();
  if (!reason.empty())
    to_.err << "fieldcast watch: " << reason << ": lines instead\n" << std::flush;
  return reason.empty();
}

bool Watch::complete(Instant now) const {
  return model_.anything_announced() && model_.awaited(options_.refresh.has_value()) == 0 &&
         now > listening_->over_at();
}

void Watch::print_all() {
  if (!options_.json && output_is_terminal()) {
    auto screen = output_screen();
    screen.rows = 0;
    return print_table(screen);
  }
  for (const auto& [path, row] : model_.rows()) print(row.sample);
}

void Watch::print_table(const Screen& screen) {
  cli::print(to_.out, watch_lines(model_, instant_now(), utc_now(), screen));
}

void Watch::print(const StationSample& sample) {
  if (options_.json) {
    to_.out << sample_json(sample).text() << '\n';
  } else {
    to_.out << sample_line(sample,
                           model_.catalogue().find({sample.bus, sample.device, sample.channel}))
            << '\n';
  }
}

std::string Watch::what_matches() const {
  const std::string meant = model_.meant();
  return meant.empty() ? "fieldcast watch --once lists them"
                       : fmt::format("did you mean '{}'?", meant);
}

ExitCode Watch::verdict() const {
  if (!to_.out) return ExitCode::kTrouble;
  if (domain_.interrupted())
    return options_.once || options_.time ? ExitCode::kInterrupted : ExitCode::kOk;
  if (model_.sampled() != 0 || (options_.once && !model_.rows().empty())) return ExitCode::kOk;
  if (!model_.anything_announced()) {
    to_.err << "fieldcast watch: " << no_bridge_text(connection_, domain_.missing_servers())
            << '\n';
    return ExitCode::kNoBridge;
  }
  to_.err << "fieldcast watch: a bridge is there, but "
          << (model_.rows().empty()
                  ? fmt::format("none of its channels matches {}; {}", model_.pattern().text(),
                                what_matches())
                  : std::string("no sample came; fieldcast status says what the bus does"))
          << '\n';
  return ExitCode::kNothing;
}

// Returns kOk if samples arrived or Ctrl-C ended an endless watch; else kNothing or kNoBridge.
ExitCode watch(const WatchOptions& options, const Connection& connection, Interrupt& interrupt,
               const Streams& to) {
  return Watch(options, connection, interrupt, to).run();
}

void describe_watch(CommandLine& line, WatchOptions& options) {
  line.value("PATTERN", pattern_into(options.pattern), kPatternHelp);
  line.flag("--json", options.json, "JSON lines");
  line.flag("--plain", options.plain, "Lines, where a terminal would get the screen");
  line.flag("--once", options.once, "Each matching channel once, then end");
  line.duration("--for", options.time, CommandLine::kShortest,
                "End after this time (20, 500ms, 2min); with --once the longest wait (10s)");
  line.duration("--refresh", options.refresh, CommandLine::kShortest,
                "Keep the channels as fresh as this while watching");
  add_connection(line, options.connection);
}

}  // namespace

CommandRow watch_command() {
  return command_row("watch", "Show samples: a screen, lines, or JSON lines", describe_watch,
                     [](const WatchOptions& given, const Streams& to) {
                       WatchOptions options = given;
                       options.unicode = use_terminal_locale();  // before DDS starts its threads
                       return in_domain(watch)(options, to);
                     });
}

}  // namespace fieldcast::cli
