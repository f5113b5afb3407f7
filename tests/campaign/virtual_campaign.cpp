// Days of every protocol in virtual time, one after the other: see bus_day.hpp.
//
//     virtual_campaign [--seeds FIRST..LAST] [--hours H] [--seconds S] [--protocol NAME]
//                      [--share I/N] [--transcripts FOLDER]
//
// A seed is a plant with one bus of each protocol. --seconds ends it after the day under way,
// --share takes each N-th seed, for one process on each core. Ctrl-C ends it at once with what was
// done so far. A violation writes transcript-SEED-PROTOCOL.txt and does not stop the others; the
// exit code is 1 then. The last line is one JSON object with the counts.
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>

#include "tests/campaign/bus_day.hpp"

using namespace fieldcast;

namespace {

std::atomic<bool> interrupted = false;

struct Arguments {
  std::uint64_t first = 1, last = 1000, share = 0, shares = 1;
  double hours = 24, seconds = 0;  // 0: no limit
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
        if (!arguments_.protocol.empty() && kind.name.find(arguments_.protocol) == kind.name.npos)
          continue;
        if (over()) break;
        day(kind, seed);
      }
      if (!over()) ++seeds_;
      progress();
    }
    print();
    return sum_.violations == 0 ? 0 : 1;
  }

 private:
  [[nodiscard]] Duration length() const { return from_seconds(arguments_.hours * 3600); }
  [[nodiscard]] double elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  }
  [[nodiscard]] bool over() const {
    return interrupted || (arguments_.seconds > 0 && elapsed() > arguments_.seconds);
  }

  void day(const test::StormKind& kind, std::uint64_t seed) {
    test::BusDay day(kind, seed, length());
    day.run([] { return interrupted.load(); });
    sum_.add(day.counts());
    hours_ += to_seconds(day.reached()) / 3600;
    ++days_;
    if (day.violation()) tell(kind, seed, *day.violation());
  }

  // The same day once more, with its text.
  void tell(const test::StormKind& kind, std::uint64_t seed, const std::string& violation) {
    std::string file =
        arguments_.transcripts + "/transcript-" + std::to_string(seed) + "-" + kind.name + ".txt";
    for (char& c : file) c = c == ' ' ? '-' : c;
    test::BusDay again(kind, seed, length());
    again.keep_transcript();
    again.run();
    std::ofstream out(file);
    for (const std::string& line : again.transcript()) out << line << '\n';
    std::printf("VIOLATION seed %llu %s: %s; transcript: %s\n",
                static_cast<unsigned long long>(seed), kind.name.c_str(), violation.c_str(),
                file.c_str());
    std::fflush(stdout);
  }

  void progress() const {
    std::fprintf(stderr, "%llu seeds, %.0f bus hours, %llu violations, %.0f s\n",
                 static_cast<unsigned long long>(seeds_), hours_,
                 static_cast<unsigned long long>(sum_.violations), elapsed());
  }

  void print() const {
    const std::pair<const char*, std::uint64_t> rows[] = {{"seeds", seeds_},
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
                                                          {"violations", sum_.violations}};
    std::printf("{\"bus_hours\": %.1f, \"seconds\": %.1f", hours_, elapsed());
    for (const auto& [name, count] : rows)
      std::printf(", \"%s\": %llu", name, static_cast<unsigned long long>(count));
    std::printf("}\n");
  }

  Arguments arguments_;
  std::chrono::steady_clock::time_point began_;
  std::uint64_t seeds_ = 0, days_ = 0;
  double hours_ = 0;
  test::DayCounts sum_;
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
