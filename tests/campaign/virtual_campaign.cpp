// Runs days of every protocol in virtual time (bus_day.hpp, group_day.hpp), one after the other.
//
//     virtual_campaign [--seeds FIRST..LAST] [--hours H] [--group-hours H] [--seconds S]
//                      [--protocol NAME] [--share I/N] [--transcripts FOLDER]
//
// For each seed it runs a plant with one bus of each protocol for --hours (24). Then it runs a
// standby group at one bus of each serial protocol for --group-hours (1). 0 leaves one out.
// --seconds ends it after the current day. --share uses each N-th seed, for one process on each
// core. Ctrl-C ends it immediately with the counts so far. A violation writes
// transcript-SEED-PROTOCOL.txt and does not stop the other days; the exit code is then 1. The last
// line is one JSON object with the counts.
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>

#include "tests/campaign/bus_day.hpp"
#include "tests/campaign/group_day.hpp"

using namespace fieldcast;

namespace {

std::atomic<bool> interrupted = false;

struct Arguments {
  std::uint64_t first = 1, last = 1000, share = 0, shares = 1;
  double hours = 24, group_hours = 1, seconds = 0;  // 0: no limit
  std::string protocol, transcripts = ".";
};

Arguments parse(int count, char** words) {
  Arguments arguments;
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string name = words[i], value = words[i + 1];
    const auto middle = [&](const std::string& mark) {
      const auto at = value.find(mark);
      if (at == value.npos) throw std::runtime_error(name + " needs A" + mark + "B");
      return std::pair{std::stoull(value.substr(0, at)),
                       std::stoull(value.substr(at + mark.size()))};
    };
    if (name == "--seeds")
      std::tie(arguments.first, arguments.last) = middle("..");
    else if (name == "--share")
      std::tie(arguments.share, arguments.shares) = middle("/");
    else if (name == "--hours")
      arguments.hours = std::stod(value);
    else if (name == "--group-hours")
      arguments.group_hours = std::stod(value);
    else if (name == "--seconds")
      arguments.seconds = std::stod(value);
    else if (name == "--protocol")
      arguments.protocol = value;
    else if (name == "--transcripts")
      arguments.transcripts = value;
    else
      throw std::runtime_error("unknown option " + name);
  }
  if (count % 2 == 0) throw std::runtime_error("an option without its value");
  return arguments;
}

class Campaign {
 public:
  explicit Campaign(const Arguments& arguments)
      : arguments_(arguments), began_(std::chrono::steady_clock::now()) {}

  int run() {
    for (std::uint64_t seed = arguments_.first; seed <= arguments_.last && !over(); ++seed) {
      if (seed % arguments_.shares != arguments_.share) continue;
      for (const test::StormKind& kind : test::storm_kinds()) {
        if (over() || !is_wanted(kind) || arguments_.hours <= 0) continue;
        hours_ += day<test::BusDay>(kind, seed, arguments_.hours, "", sum_);
        ++days_;
      }
      for (const test::StormKind& kind : test::group_kinds()) {
        if (over() || !is_wanted(kind) || arguments_.group_hours <= 0) continue;
        group_hours_ +=
            day<test::GroupDay>(kind, seed, arguments_.group_hours, "group-", group_sum_);
      }
      if (!over()) ++seeds_;
      progress();
    }
    print();
    return violations() == 0 ? 0 : 1;
  }

 private:
  [[nodiscard]] bool is_wanted(const test::StormKind& kind) const {
    return kind.name.find(arguments_.protocol) != kind.name.npos;
  }
  [[nodiscard]] std::uint64_t violations() const { return sum_.violations + group_sum_.violations; }
  [[nodiscard]] double elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  }
  [[nodiscard]] bool over() const {
    return interrupted || (arguments_.seconds > 0 && elapsed() > arguments_.seconds);
  }

  template <class Day, class Counts>
  double day(const test::StormKind& kind, std::uint64_t seed, double hours,
             const std::string& prefix, Counts& sum) {
    const Duration length = from_seconds(hours * 3600);
    Day day(kind, seed, length);
    day.run([] { return interrupted.load(); });
    sum.add(day.counts());
    if (day.violation()) {
      // Repeats the day with a transcript.
      Day again(kind, seed, length);
      again.keep_transcript();
      again.run();
      tell(prefix + std::to_string(seed) + "-" + kind.name, *day.violation(), again.transcript());
    }
    return to_seconds(day.reached()) / 3600;
  }

  void tell(const std::string& name, const std::string& violation,
            const std::deque<std::string>& transcript) {
    std::string file = arguments_.transcripts + "/transcript-" + name + ".txt";
    for (char& c : file) c = c == ' ' ? '-' : c;
    std::ofstream out(file);
    for (const std::string& text : transcript) out << text << '\n';
    std::printf("VIOLATION seed %s: %s; transcript: %s\n", name.c_str(), violation.c_str(),
                file.c_str());
    std::fflush(stdout);
  }

  void progress() const {
    std::fprintf(stderr, "%llu seeds, %.0f bus hours, %.0f group hours, %llu violations, %.0f s\n",
                 static_cast<unsigned long long>(seeds_), hours_, group_hours_,
                 static_cast<unsigned long long>(violations()), elapsed());
  }

  void print() const {
    const std::pair<const char*, std::uint64_t> rows[] = {
        {"seeds", seeds_},
        {"days", days_},
        {"requests", sum_.requests},
        {"samples", sum_.samples},
        {"good", sum_.good},
        {"late", sum_.late},
        {"doubled", sum_.doubled},
        {"commands", sum_.commands},
        {"results", sum_.results},
        {"done", sum_.done},
        {"unplugged", sum_.unplugged},
        {"reloads", sum_.reloads},
        {"takeovers", sum_.takeovers},
        {"leases", sum_.leases},
        {"interests", sum_.interests},
        {"device_restarts", sum_.device_restarts},
        {"group_frames", group_sum_.frames},
        {"group_turns", group_sum_.turns},
        {"group_garbled", group_sum_.garbled},
        {"group_samples", group_sum_.samples},
        {"group_good", group_sum_.good},
        {"group_commands", group_sum_.commands},
        {"group_results", group_sum_.results},
        {"group_second_results", group_sum_.second_results},
        {"group_executed", group_sum_.executed},
        {"group_kills", group_sum_.kills},
        {"group_stops", group_sum_.stops},
        {"group_hand_overs", group_sum_.hand_overs},
        {"group_cuts", group_sum_.cuts},
        {"group_takeovers", group_sum_.takeovers},
        {"violations", violations()}};
    std::printf("{\"bus_hours\": %.1f, \"group_hours\": %.1f, \"seconds\": %.1f", hours_,
                group_hours_, elapsed());
    for (const auto& [name, count] : rows)
      std::printf(", \"%s\": %llu", name, static_cast<unsigned long long>(count));
    std::printf("}\n");
  }

  Arguments arguments_;
  std::chrono::steady_clock::time_point began_;
  std::uint64_t seeds_ = 0, days_ = 0;
  double hours_ = 0, group_hours_ = 0;
  test::DayCounts sum_;
  test::GroupCounts group_sum_;
};

}  // namespace

int main(int count, char** words) {
  std::signal(SIGINT, [](int) { interrupted = true; });
  std::signal(SIGTERM, [](int) { interrupted = true; });
  try {
    return Campaign(parse(count, words)).run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "virtual_campaign: %s\n", error.what());
    return 2;
  }
}
