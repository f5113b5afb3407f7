#include <fmt/format.h>

#include <filesystem>
#include <mutex>
#include <ostream>
#include <string>
#include <vector>

#include "tools/cli/command/base/command.hpp"
#include "tools/cli/import/import_files.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/import/importer.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::cli {
namespace {

namespace fs = std::filesystem;
using importing::Fate;
using importing::ImportOptions;
using importing::Outcome;
using importing::WrittenFile;

struct ImportCommandOptions {
  std::vector<std::string> files;
  std::string out;   // a file, or a directory: existing, or with '/' at its end
  std::string port;  // /dev/ttyUSB0 or HOST:PORT
  bool force = false;
  bool all = false;
  bool json = false;
  ImportOptions import;
};

bool is_folder(const std::string& out) {
  std::error_code ignored;
  return out.ends_with('/') || fs::is_directory(out, ignored);
}

std::string set_port(const std::string& port, ImportOptions& options) {
  if (port.empty()) return {};
  if (port.find('/') != std::string::npos) {
    options.port.serial = port;
  } else if (port.find(':') != std::string::npos) {
    options.port.tcp = port;
  } else {
    return fmt::format("'{}' is no port; allowed: a path such as /dev/ttyUSB0, or HOST:PORT",
                       printable(port));
  }
  return {};
}

// The configuration is validated under the names of its files.
ImportOptions import_options(const ImportCommandOptions& options) {
  ImportOptions import = options.import;
  import.lists = !import.as_template && is_folder(options.out);
  if (!options.out.empty() && !is_folder(options.out))
    import.file = fs::path(options.out).filename().string();
  return import;
}

tl::expected<std::vector<NewFile>, std::string> placed(const ImportCommandOptions& options,
                                                       const Outcome& outcome) {
  std::vector<NewFile> files;
  if (!is_folder(options.out)) {
    if (outcome.files.size() != 1)
      return tl::unexpected(
          fmt::format("{} templates; --out needs a folder for them (NAME/)", outcome.files.size()));
    files.push_back({options.out, outcome.files.front().text});
    return files;
  }
  for (const WrittenFile& file : outcome.files)
    files.push_back({(fs::path(options.out) / fs::path(file.name).filename()).string(), file.text});
  return files;
}

class ImportRun {
 public:
  // `writing` is locked while files are written; lock it before the process exits.
  ImportRun(const ImportCommandOptions& options, std::mutex& writing, const Streams& to)
      : options_(options), writing_(writing), to_(to) {}

  ExitCode run() {
    const auto inputs = read_inputs(options_.files);
    if (!inputs) return usage_fault(to_.err, "import", inputs.error());
    ImportOptions import = import_options(options_);
    if (const std::string fault = set_port(options_.port, import); !fault.empty())
      return usage_fault(to_.err, "import", fault);
    const auto outcome = [&] {
      ProgressLine progress(to_.err);
      return importing::run_import(*inputs, import, [&](double done) {
        progress.show([&](Duration elapsed) { return progress_text("importing", done, elapsed); });
      });
    }();
    if (!outcome) return usage_fault(to_.err, "import", printable(outcome.error()));
    show(*outcome);
    if (outcome->files.empty()) {
      to_.err << "fieldcast import: nothing can be moved; nothing is written\n";
      return ExitCode::kFound;
    }
    if (const ExitCode code = write(*outcome); code != ExitCode::kOk) return code;
    return outcome->count(Fate::kRefused) == 0 ? ExitCode::kOk : ExitCode::kFound;
  }

 private:
  void show(const Outcome& outcome) {
    if (options_.json) {
      for (const auto& row : outcome.rows) to_.out << fate_json(row).text() << '\n';
    } else {
      for (const std::string& line : outcome.recognised) to_.out << printable(line) << '\n';
      print(to_.out, import_lines(outcome, options_.all, to_.wide_screen()));
      to_.out << import_summary(outcome) << '\n';
    }
    to_.out.flush();
    for (const std::string& note : outcome.notes) to_.err << "note: " << printable(note) << '\n';
  }

  ExitCode write(const Outcome& outcome) {
    if (options_.out.empty()) {
      to_.err << "nothing is written; --out FILE or --out FOLDER/ writes it\n";
      return ExitCode::kOk;
    }
    const auto files = placed(options_, outcome);
    if (!files) return usage_fault(to_.err, "import", files.error());
    {
      const std::lock_guard lock(writing_);
      std::error_code error;
      if (is_folder(options_.out)) fs::create_directories(options_.out, error);
      if (error)
        return usage_fault(to_.err, "import",
                           fmt::format("{}: {}", printable(options_.out), error.message()));
      if (const auto fault = write_new_files(*files, options_.force))
        return usage_fault(to_.err, "import", *fault);
    }
    for (const NewFile& file : *files) to_.err << "written: " << printable(file.path) << '\n';
    if (options_.import.as_template) {
      to_.err << "a device uses it by `template: "
              << printable(fs::path(files->front().path).stem().string())
              << "`; templates are looked for in the folder devices/ beside the configuration\n";
    } else {
      to_.err << "it passed the check; `fieldcast plan " << printable(files->front().path)
              << "` shows whether the line is fast enough\n";
    }
    return ExitCode::kOk;
  }

  const ImportCommandOptions& options_;
  std::mutex& writing_;
  const Streams& to_;
};

std::string known_formats() {
  std::string names;
  for (const auto& format : importing::formats())
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  return names;
}

void describe_import(CommandLine& line, ImportCommandOptions& options) {
  ImportOptions& import = options.import;
  line.texts("FILE", options.files, "Lists of one or several programs").required();
  line.value(
      "--from",
      [&import](const std::string& text) -> std::optional<std::string> {
        if (importing::format_by_name(text) == nullptr) return "allowed: " + known_formats();
        import.from = text;
        return std::nullopt;
      },
      "Their format (found by the content): " + known_formats());
  line.text("--out", options.out,
            "A configuration is written there; FOLDER/: with a channel list for each device");
  line.flag("--template", import.as_template, "Write device templates");
  line.flag("--force", options.force, "Write over files that are there");
  line.text("--bridge", import.bridge, "Name of the bridge (bridge-1)");
  line.text("--bus", import.bus, "Name of the bus, if there is one");
  line.text("--device", import.device, "Name of the device, if there is one");
  line.text("--port", options.port, "A serial port (/dev/ttyUSB0) or HOST:PORT");
  line.number("--baud", import.port.line.baud, 50, 4'000'000, "Of the line");
  line.text("--format", import.port.line.format, "Of the line: 8N1, 8E1, ..");
  line.text("--protocol", import.protocol, "As configurations name it: modbus-rtu, ..");
  line.number("--address", import.address, 0, 65535,
              "On the bus, of the first device whose list says none (1)");
  line.duration("--refresh", import.refresh, std::chrono::milliseconds{1},
                "Of all channels (as the list says)");
  line.value(
      "--word-order",
      [&import](const std::string& text) -> std::optional<std::string> {
        if (text != "big-endian" && text != "little-endian")
          return "allowed: big-endian, little-endian";
        import.word_order = text == "big-endian" ? WordOrder::kBigEndian : WordOrder::kLittleEndian;
        return std::nullopt;
      },
      "Of wide values, where the list does not say: big-endian, little-endian");
  line.value(
      "--base",
      [&import](const std::string& text) -> std::optional<std::string> {
        if (text != "auto" && text != "0" && text != "1") return "allowed: auto, 0, 1";
        import.base = text == "auto" ? std::nullopt : std::optional(text == "1" ? 1u : 0u);
        return std::nullopt;
      },
      "The number of the first register in the list: 0, 1 or auto (guessed, with the reason)");
  line.flag("--all", options.all, "Show every value that moved as it is");
  line.flag("--json", options.json, "JSON lines, one for each value");
}

}  // namespace

CommandRow import_command() {
  return command_row("import", "Make a configuration of other programs' lists; needs no bridge",
                     describe_import, [](const ImportCommandOptions& options, const Streams& to) {
                       EndAtOnce end;
                       return ImportRun(options, end.whole(), to).run();
                     });
}

}  // namespace fieldcast::cli
