#include "tools/cli/direct/line_capture.hpp"

#include <unistd.h>

#include <cerrno>
#include <ostream>
#include <utility>

#include "tools/cli/terminal/clock.hpp"
#include "tools/cli/text/text_table.hpp"

namespace fieldcast::cli {

tl::expected<std::unique_ptr<LineCapture>, std::string> LineCapture::make(
    const std::string& path, const BusSpec& bus, const std::string& command) {
  auto file = CaptureFile::make(path);
  if (!file)
    return tl::unexpected(
        "--capture: " + file.error().text +
        (file.error().error == EEXIST ? "; a capture never overwrites a file" : ""));
  return std::unique_ptr<LineCapture>(new LineCapture(*std::move(file), bus, command));
}

LineCapture::LineCapture(CaptureFile file, const BusSpec& bus, const std::string& command)
    : file_(std::move(file)), capture_(bus, command, tap_) {
  counts_.begun = utc_now();
  append(capture_.head());
  capture_.add(*this);
}

LineCapture::~LineCapture() {
  (void)end();
  if (counts_.frames == 0) ::unlink(file_.path().c_str());
}

void LineCapture::write() { capture_.drain(utc_now()); }

std::optional<std::string> LineCapture::end() {
  if (!std::exchange(ended_, true)) {
    capture_.finish(utc_now());
    capture_.remove(*this);
    counts_.ended = utc_now();
    append(capture_tail(counts_));
  }
  return fault_.empty() ? std::nullopt : std::optional("--capture: " + fault_);
}

void LineCapture::packet(ByteView block, UtcTime) {
  append(block);
  if (fault_.empty()) ++counts_.frames;
}

// Stops after the first failure, because later frames would leave a gap.
void LineCapture::append(ByteView blocks) {
  if (!fault_.empty()) return;
  if (const auto written = file_.append(blocks); !written)
    fault_ = written.error().text + "; what was captured before is whole";
}

ExitCode on_line(const std::string& path, const BusSpec& bus, const std::string& command,
                 std::ostream& err, const std::function<ExitCode(LineCapture* capture)>& work) {
  if (path.empty()) return work(nullptr);
  const std::string name = "fieldcast " + command;
  const auto capture = LineCapture::make(path, bus, name);
  if (!capture) {
    err << name << ": " << printable(capture.error()) << '\n';
    return ExitCode::kTrouble;
  }
  const ExitCode code = work(capture->get());
  const auto fault = (*capture)->end();
  if (!fault) return code;
  err << name << ": " << printable(*fault) << '\n';
  return code == ExitCode::kOk ? ExitCode::kTrouble : code;
}

}  // namespace fieldcast::cli
