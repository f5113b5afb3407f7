#include "tools/cli/command/line/learn.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <istream>
#include <ostream>
#include <sstream>

#include "bridge/base/file_descriptor.hpp"
#include "config/loader/loader.hpp"
#include "core/base/json.hpp"
#include "core/base/message_text.hpp"
#include "tools/cli/inspect/frame_report.hpp"
#include "tools/cli/inspect/learn/exchange_pairing.hpp"
#include "tools/cli/inspect/learn/proposal.hpp"
#include "tools/cli/model/sample_text.hpp"

namespace fieldcast::cli {
namespace {

constexpr std::size_t kMaxTrace = 64 << 20;  // characters

// The frames of the first bus of the input.
class LearnedInput {
 public:
  void take(const SeenFrame& frame) {
    if (frame.comment.ends_with(kEchoComment)) return;
    if (!bus_) bus_ = frame.bus;
    if (frame.bus != *bus_ || !frame.direction) {
      ++others_;
      return;
    }
    pairing_.take(*frame.direction, frame.bytes);
  }
  [[nodiscard]] std::string summary() const {
    std::string text = fmt::format("{} of {}, {} without a response",
                                   counted(pairing_.frames(), "frame", "frames"),
                                   bus_ ? printable(*bus_) : "no bus", pairing_.without_response());
    if (others_ > 0) text += fmt::format("; {} of other buses or without a direction", others_);
    if (pairing_.echoes()) text += "; each response begins with its request, an echo";
    if (pairing_.left_out() > 0) text += fmt::format("; {} left out", pairing_.left_out());
    return text;
  }
  [[nodiscard]] std::size_t frames() const { return pairing_.frames() + others_; }
  [[nodiscard]] std::vector<learn::Exchange> exchanges() { return pairing_.finish(); }

 private:
  std::optional<std::string> bus_;
  learn::ExchangePairing pairing_;
  std::size_t others_ = 0;
};

std::string text_of(std::istream& in) {
  std::string text;
  for (char c; text.size() < kMaxTrace && in.get(c);) text += c;
  return text;
}

// Empty if the input was read.
std::optional<ExitCode> read_input(const InspectOptions& options, const Streams& to,
                                   LearnedInput& input) {
  std::ifstream file(options.protocol, std::ios::binary);
  if (!options.protocol.empty() && !file) {
    to.err << fmt::format("fieldcast inspect: {}: {}\n", printable(options.protocol),
                          errno_text(errno));
    return ExitCode::kUsage;
  }
  const auto take = [&](const SeenFrame& frame) { input.take(frame); };
  if (!options.protocol.empty() && is_capture(file)) {
    const CaptureEnd end = read_capture(file, take);
    if (end.fault) explain_fault(end, options.protocol, input.frames(), to.err);
    return end.is_no_capture() ? std::optional(ExitCode::kUsage) : std::nullopt;
  }
  const std::string text = text_of(options.protocol.empty() ? to.in : file);
  if (read_trace(text, take, [](const auto&...) {})) return std::nullopt;
  to.err << "fieldcast inspect: expected a capture (.pcapng), or lines of the bridge's trace such "
            "as 2026-11-22T14:24:21.126358Z line >> 01 03 00 64 00 02 85 D4\n";
  return ExitCode::kUsage;
}

void print_json(const learn::Proposal& proposal, std::ostream& out) {
  for (const auto& operation : proposal.operations) {
    for (const auto* fields : {&operation.request, &operation.response}) {
      for (const auto& field : *fields)
        out << Json{{"operation", operation.name},
                    {"frame", fields == &operation.request ? "request" : "response"},
                    {"at", field.at},
                    {"width", field.width},
                    {"content", learn::content_of(field, proposal.text)},
                    {"frames", field.evidence.holds},
                    {"of", field.evidence.of},
                    {"note", field.note}}
                   .text()
            << '\n';
    }
  }
}

}  // namespace

ExitCode learn_protocol(const InspectOptions& options, const Streams& to) {
  LearnedInput input;
  if (const auto fault = read_input(options, to, input)) return *fault;
  const auto exchanges = input.exchanges();
  const learn::Proposal proposal = learn::learn(exchanges);
  const std::string text = learn::declaration_text(proposal);
  to.err << fmt::format("fieldcast inspect: {}\n", input.summary());
  for (const std::string& note : proposal.notes)
    to.err << fmt::format("fieldcast inspect: {}\n", note);
  if (options.json)
    print_json(proposal, to.out);
  else
    to.out << text;
  if (!proposal.is_declarable()) {
    to.err << "fieldcast inspect: no operation can be declared\n";
    return ExitCode::kFound;
  }
  const auto loaded = config::load_declaration_text(text, "proposal");
  if (loaded) {
    const auto explained = learn::explained_by(*loaded->value, exchanges);
    to.err << fmt::format("fieldcast inspect: the proposal explains {} of {} in {}\n",
                          explained.holds, counted(explained.of, "frame", "frames"),
                          counted(exchanges.size(), "different exchange", "different exchanges"));
    return ExitCode::kOk;
  }
  to.err << config::to_text(std::span(loaded.error()));
  return ExitCode::kFound;
}

}  // namespace fieldcast::cli
