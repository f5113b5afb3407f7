#include "tools/cli/command/line/inspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <istream>
#include <ostream>

#include "bridge/base/file_descriptor.hpp"
#include "core/base/bytes.hpp"
#include "core/base/json.hpp"
#include "core/capture/trace_text.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/command/line/learn.hpp"
#include "tools/cli/inspect/frame_report.hpp"
#include "tools/cli/model/address_notation.hpp"
#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/view/check_view.hpp"
#include "tools/progress/progress_line.hpp"
#include "tools/sim/check/sim_check.hpp"

namespace fieldcast::cli {

namespace {

struct SimCheckOptions {
  std::string protocol;  // as for `inspect`
  bool json = false;
};

// Limits wrong input; a real frame is far shorter.
constexpr std::size_t kMaxHexCharacters = 65536;
constexpr std::size_t kMaxTraceCharacters = 64 << 20;

std::string text_of(const InspectOptions& options, std::istream& in) {
  std::string text;
  for (const auto& part : options.hex) text += part + (parse_trace_text(part) ? '\n' : ' ');
  if (options.hex.empty()) {
    for (char c; text.size() <= kMaxTraceCharacters && in.get(c);) text += c;
  }
  return text;
}

ExitCode inspect_hex(const NamedProtocol& protocol, const std::string& hex,
                     const InspectOptions& options, const Streams& to) {
  const auto frame = hex.size() <= kMaxHexCharacters ? from_hex(hex) : std::nullopt;
  if (!frame || frame->empty()) {
    to.err << "fieldcast inspect: "
           << (hex.size() > kMaxHexCharacters ? "more than 65536 characters are" : "that is")
           << " no frame; write its bytes in hexadecimal, for instance 01 03 00 64 00 02 85 D4 or "
              "01030064000285D4, or lines of the bridge's trace\n";
    return ExitCode::kUsage;
  }
  const auto fields = protocol.built_in != nullptr
                          ? protocol.built_in->explain(*frame)
                          : declared::explain(*protocol.declaration.value, *frame);
  const std::string_view name = protocol.name();
  if (options.json) {
    to.out << inspect_json(name, *frame, fields).text() << '\n';
  } else {
    print(to.out, inspect_lines(name, *frame, fields, to.wide_screen()));
  }
  return count_faults(fields) == 0 ? ExitCode::kOk : ExitCode::kFound;
}

FrameReport::Options report_options(const InspectOptions& options,
                                    const std::optional<BridgeSpec>& spec) {
  return {.json = options.json, .fields = options.fields, .spec = spec ? &*spec : nullptr};
}

}  // namespace

ExitCode inspect(const InspectOptions& given, const Streams& to) {
  if (given.learn) return learn_protocol(given, to);
  InspectOptions options = given;
  std::optional<BridgeSpec> spec;
  if (!options.config.empty()) {
    spec = load_configuration(options.config, to.err);
    if (!spec) return ExitCode::kUsage;
  }
  auto how = report_options(options, spec);
  const bool named = has_name_of_capture(options.protocol);
  std::ifstream file(options.protocol, std::ios::binary);
  if (named && !file) {
    to.err << fmt::format("fieldcast inspect: {}: {}\n", printable(options.protocol),
                          errno_text(errno));
    return ExitCode::kUsage;
  }
  if (named || (file && is_capture(file))) {
    FrameReport report(how, to.out, to.wide_screen());
    return show_capture(file, options.protocol, report, to.err);
  }
  // With a configuration, the first word may be the input.
  if (options.protocol.empty() || parse_trace_text(options.protocol)) {
    if (!spec) {
      to.err << "fieldcast inspect: which protocol? Name it, or the configuration with --config\n";
      return ExitCode::kUsage;
    }
    if (!options.protocol.empty()) options.hex.insert(options.hex.begin(), options.protocol);
  } else {
    how.protocol = named_protocol(options.protocol, "inspect", to.err);
    if (!how.protocol) return ExitCode::kUsage;
  }
  const std::string text = text_of(options, to.in);
  FrameReport report(how, to.out, to.wide_screen());
  if (show_trace(text, report)) return report.faulty() > 0 ? ExitCode::kFound : ExitCode::kOk;
  if (how.protocol) return inspect_hex(*how.protocol, text, options, to);
  to.err << "fieldcast inspect: that are no lines of the bridge's trace, which look like "
            "2026-11-22T14:24:21.126358Z line >> 01 03 00 64 00 02 85 D4; of a frame alone the "
            "protocol must be named\n";
  return ExitCode::kUsage;
}

namespace {

void describe_inspect(CommandLine& line, InspectOptions& options) {
  line.text("PROTOCOL", options.protocol,
            std::string(kProtocolHelp) + "; or the file of a capture (.pcapng)");
  line.texts("HEX", options.hex,
             "The frame's bytes, or lines of the bridge's trace; from standard input when there "
             "are none");
  line.text("--config", options.config, "Shows values by the channels of this configuration")
      .existing_file();
  line.flag("--fields", options.fields, "Every field of each frame of a capture or a trace");
  line.flag("--learn", options.learn,
            "Proposes the declaration of an unknown protocol from a capture or a trace");
  line.flag("--json", options.json, "One JSON object for each frame, or each learned field");
}

}  // namespace

CommandRow inspect_command() {
  return command_row("inspect", "Explain a frame, a trace or a capture; needs no bridge",
                     describe_inspect, inspect);
}

namespace {

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

// Tests a protocol's master against its simulated device in virtual time. Returns kFound if a check
// failed, kUsage for an unknown protocol or an invalid declaration.
ExitCode sim_check(const SimCheckOptions& options, const Streams& to) {
  const auto protocol = named_protocol(options.protocol, "sim-check", to.err);
  if (!protocol) return ExitCode::kUsage;
  const auto subjects = protocol->built_in != nullptr ? sim::subjects_of(protocol->built_in->name)
                                                      : sim::subjects_of(protocol->declaration);
  sim::CheckRows all;
  ProgressLine progress(to.err);
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
      if (options.json) to.out << check_json(protocol->name(), row).text() << '\n';
      all.push_back(std::move(row));
    }
    to.out.flush();
  }
  if (!options.json) print(to.out, check_lines(all, to.wide_screen()));
  std::uint64_t tried = 0, failed = 0;
  for (const auto& row : all) tried += row.tried, failed += row.failed();
  to.err << protocol->name() << ": " << tried << " tried, " << failed << " failed\n";
  return failed == 0 ? ExitCode::kOk : ExitCode::kFound;
}

void describe_sim_check(CommandLine& line, SimCheckOptions& options) {
  line.text("PROTOCOL", options.protocol, kProtocolHelp).required();
  line.flag("--json", options.json, "JSON lines");
}

}  // namespace

CommandRow sim_check_command() {
  return command_row("sim-check",
                     "Try a protocol's master against its simulated device, through the whole "
                     "matrix; needs no bridge",
                     describe_sim_check, ends_at_once(sim_check));
}

}  // namespace fieldcast::cli
