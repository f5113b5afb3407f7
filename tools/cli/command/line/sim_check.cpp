#include "tools/cli/command/line/sim_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ostream>

#include "tools/cli/command/base/command.hpp"
#include "tools/cli/model/named_protocol.hpp"
#include "tools/cli/terminal/end_at_once.hpp"
#include "tools/progress/progress_line.hpp"
#include "tools/sim/check/sim_check.hpp"

namespace fieldcast::cli {

Json check_json(std::string_view protocol, const sim::CheckRow& row) {
  Json line{{"protocol", protocol},  {"options", row.variant}, {"check", row.check},
            {"of", row.where},       {"tried", row.tried},     {"passed", row.passed},
            {"failed", row.failed()}};
  if (!row.note.empty()) line.add("note", row.note);
  Json failures = Json::array();
  for (const auto& failure : row.failures)
    failures.push_back({{"what", failure.what}, {"frame", failure.frame}});
  if (!row.failures.empty()) line.add("failures", failures);
  return line;
}

std::vector<std::string> check_lines(const sim::CheckRows& rows, const Screen& screen) {
  const bool options =
      std::ranges::any_of(rows, [](const auto& row) { return !row.variant.empty(); });
  std::vector<TextTable::Column> columns{{"CHECK"},
                                         {"OF"},
                                         {"TRIED", Align::kRight},
                                         {"PASSED", Align::kRight},
                                         {"FAILED", Align::kRight},
                                         {"NOTE"}};
  if (options) columns.insert(columns.begin(), {"OPTIONS"});
  TextTable table(columns);
  for (const auto& row : rows) {
    std::vector<Cell> cells{
        {row.check},
        {row.where},
        {std::to_string(row.tried)},
        {std::to_string(row.passed)},
        {std::to_string(row.failed()), row.failed() != 0 ? Tone::kBad : Tone::kPlain},
        {row.note, Tone::kFaint}};
    if (options) cells.insert(cells.begin(), {row.variant});
    table.add_row(std::move(cells));
  }
  std::vector<std::string> lines = table.render(screen);
  for (const auto& row : rows) {
    for (const auto& failure : row.failures) {
      lines.push_back(fmt::format("{}{}{}, {}: {}", painted("failed: ", Tone::kBad, screen.colour),
                                  row.variant.empty() ? "" : row.variant + ", ", row.check,
                                  row.where, failure.what));
      if (!failure.frame.empty()) lines.push_back("  frame: " + failure.frame);
    }
    if (row.failed() > row.failures.size())
      lines.push_back(fmt::format("  .. and {} more", row.failed() - row.failures.size()));
  }
  return lines;
}

ExitCode sim_check(const SimCheckOptions& options, std::ostream& out, std::ostream& err,
                   const Screen& screen) {
  const auto protocol = named_protocol(options.protocol, "sim-check", err);
  if (!protocol) return ExitCode::kUsage;
  const auto subjects = protocol->built_in != nullptr ? sim::subjects_of(protocol->built_in->name)
                                                      : sim::subjects_of(protocol->declaration);
  sim::CheckRows all;
  ProgressLine progress(err);
  for (std::size_t i = 0; i < subjects.size(); ++i) {
    const auto show = [&](double share) {
      progress.show([&](Duration elapsed) {
        return progress_text(
            fmt::format("checking {}", protocol->name()),
            (static_cast<double>(i) + share) / static_cast<double>(subjects.size()), elapsed);
      });
    };
    auto rows = sim::sim_check(subjects[i], show);
    progress.clear();
    for (auto& row : rows) {
      if (options.json) out << check_json(protocol->name(), row).text() << '\n';
      all.push_back(std::move(row));
    }
    out.flush();
  }
  if (!options.json) {
    for (const auto& line : check_lines(all, screen)) out << line << '\n';
  }
  std::uint64_t tried = 0, failed = 0;
  for (const auto& row : all) tried += row.tried, failed += row.failed();
  err << protocol->name() << ": " << tried << " tried, " << failed << " failed\n";
  return failed == 0 ? ExitCode::kOk : ExitCode::kFound;
}

namespace {

class SimCheckCommand final : public CommandWith<SimCheckOptions> {
 public:
  void describe(CommandLine& line) override {
    line.text("PROTOCOL", options_.protocol, kProtocolHelp).required();
    line.flag("--json", options_.json, "JSON lines");
  }
  ExitCode run(const Streams& streams) override {
    const EndAtOnce end;
    return sim_check(options_, streams.out, streams.err, streams.wide_screen());
  }
};

}  // namespace

CommandEntry sim_check_command();
CommandEntry sim_check_command() {
  return {"sim-check",
          "Try a protocol's master against its simulated device, through the whole matrix; needs "
          "no bridge",
          make_command<SimCheckCommand>};
}

}  // namespace fieldcast::cli
