#include "tools/program-port/port_report.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iostream>

#include "bridge/base/clock.hpp"
#include "core/base/json.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast::port {
namespace {

std::string remark_on(std::uint64_t lost) {
  return fmt::format("({} lines are missing here)\n", lost);
}

// A separate writer, so that the port works while nobody reads standard output.
LineWriter& output() {
  static auto& lines = *new LineWriter(STDOUT_FILENO, remark_on);
  return lines;
}

// "2026-11-21T03:04:05.678Z".
std::string time_text(UtcTime time) {
  const std::int64_t ms = time.nanoseconds / 1'000'000;
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(std::time_t{ms / 1000}), ms % 1000);
}

constexpr Duration kLastWords = std::chrono::milliseconds{300};

std::string size_text(std::uint64_t bytes) {
  return fmt::format("{:.1f} kB", static_cast<double>(bytes) / 1000);
}

std::string rate_text(double bytes_per_second) {
  char text[64];
  std::snprintf(text, sizeof text, "%.1f kB/s", bytes_per_second / 1000);
  return text;
}

}  // namespace

PortReport::PortReport(bool json, std::string device, std::string port, int log)
    : json_(json),
      redrawn_(!json && is_terminal(STDOUT_FILENO) && is_terminal(STDERR_FILENO)),
      device_(std::move(device)),
      port_(std::move(port)),
      progress_(std::cerr) {
  if (log >= 0) log_.emplace(log, remark_on);
}

void PortReport::note(const std::string& text) {
  if (log_) log_->put(time_text(read_clocks().utc) + "  " + printable(text) + '\n');
}

// The text is untrusted. Another thread writes the line, which first clears the progress line.
void PortReport::print(const std::string& line) {
  output().put((redrawn_ ? "\r\x1b[K" : "") + printable(line) + '\n');
  note(line);
}

PortReport::~PortReport() {
  (void)output().flush(kLastWords);
  if (log_) (void)log_->flush(kLastWords);
}

void PortReport::state(const std::string& state, const std::string& text) {
  if (json_)
    return print(
        Json{{"device", device_}, {"link", port_}, {"state", state}, {"text", text}}.text());
  print(fmt::format("{}: {}", device_, text));
}

void PortReport::dropped(const std::string& text) {
  if (json_) return print(Json{{"device", device_}, {"dropped", text}}.text());
  print(fmt::format("{}: {}", device_, text));
}

void PortReport::line(std::uint32_t baud, unsigned stop_bits) {
  if (json_)
    return print(Json{{"device", device_}, {"baud", baud}, {"stop_bits", stop_bits}}.text());
  print(fmt::format("{}: the program sets {} baud, {} stop bits", device_, baud, stop_bits));
}

void PortReport::paired(Instant now) {
  since_ = at_ = shown_at_ = now;
  sent_ = received_ = shown_sent_ = shown_received_ = 0;
}

void PortReport::traffic(std::uint64_t sent, std::uint64_t received, Instant now, bool last) {
  if (!last && (redrawn_ || (sent == sent_ && received == received_))) return void(at_ = now);
  const Instant from = last ? since_ : at_;
  const double seconds = std::max(to_seconds(now - from), 1e-3);
  const double out = static_cast<double>(last ? sent : sent - sent_) / seconds;
  const double in = static_cast<double>(last ? received : received - received_) / seconds;
  at_ = now;
  sent_ = sent;
  received_ = received;
  if (json_) {
    return print(Json{
        {"device", device_},
        {"bytes_to_device", sent},
        {"bytes_from_device", received},
        {"rate_to_device", out},
        {"rate_from_device", in},
        {"seconds",
         seconds}}.text());
  }
  print(fmt::format("{}: {} bytes sent ({}), {} received ({}){}", device_, sent, rate_text(out),
                    received, rate_text(in), last ? fmt::format(", in {:f} s", seconds) : ""));
}

void PortReport::show_traffic(std::uint64_t sent, std::uint64_t received, std::uint64_t waiting,
                              Instant now) {
  if (!redrawn_ || sent + received == 0) return;
  progress_.show([&](Duration) {
    const double seconds = std::max(to_seconds(now - shown_at_), 1e-3);
    const double out = static_cast<double>(sent - shown_sent_) / seconds;
    const double in = static_cast<double>(received - shown_received_) / seconds;
    shown_at_ = now;
    shown_sent_ = sent;
    shown_received_ = received;
    std::string text = fmt::format("{} sent ({}), {} received ({})", size_text(sent),
                                   rate_text(out), size_text(received), rate_text(in));
    if (waiting > 0) text += fmt::format(", {} to go", size_text(waiting));
    return ProgressText{device_, text};
  });
}

void PortReport::show_last_bytes(double share) {
  if (!redrawn_) return;
  progress_.show([&](Duration) {
    return ProgressText{
        device_, fmt::format("the last bytes: {:.0f} %; Ctrl-C drops the rest", share * 100)};
  });
}

}  // namespace fieldcast::port
