#include "tools/cli/command/import.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <mutex>
#include <ostream>

#include "tools/cli/command/base/command.hpp"
#include "tools/cli/import/import_files.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::cli {
namespace {

namespace fs = std::filesystem;
using importing::Fate;
using importing::ImportOptions;
using importing::Outcome;
using importing::WrittenFile;

bool is_folder(const std::string& out) {
  std::error_code ignored;
  return out.ends_with('/') || fs::is_directory(out, ignored);
}

// Returns an error, or an empty text.
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

// The error is one line.
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
  ImportRun(const ImportCommandOptions& options, std::mutex& writing, std::ostream& out,
            std::ostream& err, const Screen& screen)
      : options_(options), writing_(writing), out_(out), err_(err), screen_(screen) {}

  ExitCode run() {
    const auto inputs = read_inputs(options_.files);
    if (!inputs) return usage_fault(err_, "import", inputs.error());
    ImportOptions import = import_options(options_);
    if (const std::string fault = set_port(options_.port, import); !fault.empty())
      return usage_fault(err_, "import", fault);
    const auto outcome = [&] {
      ProgressLine progress(err_);
      return importing::run_import(*inputs, import, [&](double done) {
        progress.show([&](Duration elapsed) { return progress_text("importing", done, elapsed); });
      });
    }();
    if (!outcome) return usage_fault(err_, "import", printable(outcome.error()));
    show(*outcome);
    if (outcome->files.empty()) {
      err_ << "fieldcast import: nothing can be moved; nothing is written\n";
      return ExitCode::kFound;
    }
    if (const ExitCode code = write(*outcome); code != ExitCode::kOk) return code;
    return outcome->count(Fate::kRefused) == 0 ? ExitCode::kOk : ExitCode::kFound;
  }

 private:
  void show(const Outcome& outcome) {
    if (options_.json) {
      for (const auto& row : outcome.rows) out_ << fate_json(row).text() << '\n';
    } else {
      for (const std::string& line : outcome.recognised) out_ << printable(line) << '\n';
      for (const std::string& line : import_lines(outcome, options_.all, screen_))
        out_ << line << '\n';
      out_ << import_summary(outcome) << '\n';
    }
    out_.flush();
    for (const std::string& note : outcome.notes) err_ << "note: " << printable(note) << '\n';
  }

  ExitCode write(const Outcome& outcome) {
    if (options_.out.empty()) {
      err_ << "nothing is written; --out FILE or --out FOLDER/ writes it\n";
      return ExitCode::kOk;
    }
    const auto files = placed(options_, outcome);
    if (!files) return usage_fault(err_, "import", files.error());
    {
      const std::lock_guard lock(writing_);
      std::error_code error;
      if (is_folder(options_.out)) fs::create_directories(options_.out, error);
      if (error)
        return usage_fault(err_, "import",
                           fmt::format("{}: {}", printable(options_.out), error.message()));
      if (const auto fault = write_new_files(*files, options_.force))
        return usage_fault(err_, "import", *fault);
    }
    for (const NewFile& file : *files) err_ << "written: " << printable(file.path) << '\n';
    if (options_.import.as_template) {
      err_ << "a device uses it by `template: "
           << printable(fs::path(files->front().path).stem().string())
           << "`; templates are looked for in the folder devices/ beside the configuration\n";
    } else {
      err_ << "it passed the check; `fieldcast plan " << printable(files->front().path)
           << "` shows whether the line is fast enough\n";
    }
    return ExitCode::kOk;
  }

  const ImportCommandOptions& options_;
  std::mutex& writing_;
  std::ostream& out_;
  std::ostream& err_;
  const Screen& screen_;
};

}  // namespace

ExitCode import_files(const ImportCommandOptions& options, std::mutex& writing, std::ostream& out,
                      std::ostream& err, const Screen& screen) {
  return ImportRun(options, writing, out, err, screen).run();
}

namespace {

std::string known_formats() {
  std::string names;
  for (const auto& format : importing::formats())
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  return names;
}

class ImportCommand final : public CommandWith<ImportCommandOptions> {
 public:
  void describe(CommandLine& line) override {
    ImportOptions& import = options_.import;
    line.texts("FILE", options_.files, "Lists of one or several programs").required();
    line.value(
        "--from",
        [&import](const std::string& text) -> std::optional<std::string> {
          if (importing::format_by_name(text) == nullptr) return "allowed: " + known_formats();
          import.from = text;
          return std::nullopt;
        },
        "Their format (found by the content): " + known_formats());
    line.text("--out", options_.out,
              "A configuration is written there; FOLDER/: with a channel list for each device");
    line.flag("--template", import.as_template, "Write device templates");
    line.flag("--force", options_.force, "Write over files that are there");
    line.text("--bridge", import.bridge, "Name of the bridge (bridge-1)");
    line.text("--bus", import.bus, "Name of the bus, if there is one");
    line.text("--device", import.device, "Name of the device, if there is one");
    line.text("--port", options_.port, "A serial port (/dev/ttyUSB0) or HOST:PORT");
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
          import.word_order =
              text == "big-endian" ? WordOrder::kBigEndian : WordOrder::kLittleEndian;
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
    line.flag("--all", options_.all, "Show every value that moved as it is");
    line.flag("--json", options_.json, "JSON lines, one for each value");
  }

  ExitCode run(const Streams& streams) override {
    EndAtOnce end;
    return import_files(options_, end.whole(), streams.out, streams.err, streams.wide_screen());
  }
};

}  // namespace

CommandEntry import_command();
CommandEntry import_command() {
  return {"import", "Make a configuration of other programs' lists; needs no bridge",
          make_command<ImportCommand>};
}

}  // namespace fieldcast::cli
